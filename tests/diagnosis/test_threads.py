"""Each cause of the public threads on torques that differ, planted by hand: `diagnose` names it, alone."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import rttrr_pin
from rttrr_pin import JointEffects, RandomPayload, Robot
from rttrr_pin.diagnosis import diagnose
from support import planted
from support.planted import FOLDER, Array, Loaded, edited, rnea, text

STATES = 60

TURNED_PARTLY = "outwards: turn the first term alone of R.T @ (w_dot_p.cross(p) + w_p.cross(w_p.cross(p)) + v_dot_p)"

ARM, TURNED, FINGERS, DH, TREE, TWO_LINKS = (
    text(name) for name in ("arm_with_gripper", "turned_inertial", "fingers", "modified_dh", "two_arms", "two_links")
)

GRIPPER = ARM[ARM.index('<link name="gripper">') : ARM.index('<joint name="pan"')]

EFFECTS = {
    "pan": JointEffects(0.3, 0.2, 0.1),
    "lift": JointEffects(0.25, 0.4, 0.3),
    "elbow": JointEffects(0.1, 0.3, 0.2),
}


@dataclass(frozen=True)
class Thread:
    """A thread, or several about one cause: the robot that is meant, the program, and what is to be named."""

    where: str
    cause: str
    program: Callable[[], Any]
    robot: Callable[[], Robot] = lambda: rttrr_pin.load(ARM)
    at: str | None = None
    payload: RandomPayload | None = None

    def __str__(self) -> str:
        return f"{self.where}: {self.cause}"


def floating() -> Robot:
    return rttrr_pin.load(TREE, base="floating")


def driven() -> Robot:
    return rttrr_pin.load(ARM).with_joint_effects(EFFECTS)


def applied(before: Callable[..., tuple[Array, Array, Array]], program: planted.Program) -> planted.Program:
    """The program behind a change of its inputs."""
    return lambda q, v, a: program(*before(q, v, a))


def as_wxyz(q: Array, v: Array, a: Array) -> tuple[Array, Array, Array]:
    """A quaternion (x, y, z, w) taken for (w, x, y, z)."""
    w, x, y, z = q[3:7]
    return np.concatenate([q[:3], [x, y, z, w], q[7:]]), v, a


def joint_numbers_from_zero(program: planted.Program) -> planted.Program:
    """Tau of joint k read at k, where the base has the first six numbers."""

    def shifted(q: Array, v: Array, a: Array) -> Array:
        tau = program(q, v, a)
        return np.concatenate([tau[:6], tau[: len(tau) - 6]])

    return shifted


def without_root() -> str:
    """The torso without mass; Pinocchio drops a root link that is empty."""
    return edited("two_arms", '<mass value="6.5" />', '<mass value="0" />').replace(
        '<inertia ixx="0.11" ixy="0.004" ixz="-0.006" iyy="0.1" iyz="0.003" izz="0.05" />',
        '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0" />',
    )


def twice(link: str) -> pin.Model:
    """The body of a link added once more."""
    own = planted.model(ARM)
    joint = own.frames[own.getFrameId(link)].parentJoint
    own.inertias[joint] = own.inertias[joint] + own.inertias[joint]
    return own


def tensor_times_thousand(link: str) -> pin.Model:
    """A tensor about the centre of mass that is a thousand times as large."""
    own = planted.model(ARM)
    joint = own.frames[own.getFrameId(link)].parentJoint
    body = own.inertias[joint]
    own.inertias[joint] = pin.Inertia(body.mass, body.lever, 1e3 * body.inertia)
    return own


def in_order_of_file(q: Array, v: Array, a: Array) -> Array:
    """Two arms whose joints are counted as the file has them: right before left; Pinocchio has left before right."""
    order = [2, 3, 0, 1]
    return np.array(rnea(TREE)(q[order], v[order], a[order])[order])


THREADS = (
    Thread("openai/mujoco-py#796", "armature ignored at every joint", lambda: rnea(ARM), lambda: rttrr_pin.load(ARM)
           .with_joint_effects({name: JointEffects(own.armature) for name, own in EFFECTS.items()})),
    Thread("roahmlab/RAPTOR#29", "armature of another size", lambda: lambda q, v, a: rnea(ARM)(q, v, a)
           + [0.0, 0.0, 0.15 * a[2]], at="elbow"),
    Thread("stack-of-tasks/pinocchio#2725", "gravity of another sign",
           lambda: planted.with_gravity(ARM, (0.0, 0.0, 9.81))),
    Thread("stack-of-tasks/pinocchio#2725", "sign of tau", lambda: lambda q, v, a: -rnea(ARM)(q, v, a)),
    Thread("stack-of-tasks/pinocchio#2725", "gravity missing", lambda: planted.with_gravity(ARM, (0.0, 0.0, 0.0))),
    Thread("intrinsic-dev/aic#434", "link counted twice", lambda: rnea(twice("upper_arm")), at="upper_arm"),
    Thread("intrinsic-dev/aic#434", "payload twice", lambda: Loaded(
        ARM, lambda M, f, n, c: pin.Force(-2.0 * f, -2.0 * n)), payload=RandomPayload(link="forearm")),
    Thread("google-deepmind/mujoco#3559, newton-physics/newton#537", "inertial rpy ignored",
           lambda: rnea(edited("turned_inertial", 'rpy="0.5 -0.8 0.3"', 'rpy="0 0 0"')),
           lambda: rttrr_pin.load(TURNED), at="forearm"),
    Thread("reBot-Isaacsim#6", "origin rpy ignored", lambda: rnea(
        edited("arm_with_gripper", 'rpy="0.3 0 0"', 'rpy="0 0 0"')), at="elbow"),
    Thread("google-deepmind/mujoco#2982", "tensor of a fixed link not turned",
           lambda: planted.merged_without_turning(ARM, "gripper_mount"), lambda: rttrr_pin.load(ARM),
           at="gripper"),
    Thread("petercorke/robotics-toolbox-python#636", "fixed link ignored",
           lambda: rnea(ARM.replace(GRIPPER, '<link name="gripper" />')), at="gripper"),
    Thread("gbionics/mujoco-urdf-loader#9, Rhoban/onshape-to-robot#147", "root link ignored",
           lambda: rnea(without_root(), floating=True), floating, at="torso"),
    Thread("isaac-sim/IsaacLab#4999", "index of joints without the base",
           lambda: joint_numbers_from_zero(rnea(TREE, floating=True)), floating),
    Thread("order of joints", "order of the file", lambda: in_order_of_file, lambda: rttrr_pin.load(TREE)),
    Thread("stack-of-tasks/pinocchio#2060", "quaternion taken as w, x, y, z",
           lambda: applied(as_wxyz, rnea(TREE, floating=True)), floating),
    Thread("stack-of-tasks/pinocchio#1916", "payload in base axes", lambda: Loaded(
        ARM, lambda M, f, n, c: pin.Force(-M.rotation.T @ f, -M.rotation.T @ n)), payload=RandomPayload(link="forearm")),
    Thread("stack-of-tasks/pinocchio#1916", "payload at the COM", lambda: Loaded(
        TURNED, lambda M, f, n, c: pin.Force(-f, -n - np.cross(c, f))), lambda: rttrr_pin.load(TURNED),
        payload=RandomPayload(link="forearm")),
    Thread("stack-of-tasks/pinocchio#1916", "sign of the payload", lambda: Loaded(
        ARM, lambda M, f, n, c: pin.Force(f, n)), payload=RandomPayload(link="forearm")),
    Thread("units", "degrees taken", lambda: lambda q, v, a: rnea(ARM)(*np.deg2rad([q, v, a]))),
    Thread("units", "mass of another size at every link", lambda: planted.masses_in_grams(TURNED),
           lambda: rttrr_pin.load(TURNED)),
    Thread("units", "tensor of another size", lambda: rnea(tensor_times_thousand("upper_arm")), at="upper_arm"),
    Thread("JeanElsner/panda_mujoco#6", "COM of opposite y", lambda: rnea(
        edited("arm_with_gripper", "0.13 -0.006 0.01", "0.13 0.006 0.01")), at="forearm"),
    Thread("JeanElsner/panda_mujoco#6", "products of inertia negated", lambda: rnea(
        edited("arm_with_gripper", 'ixy="-0.0004" ixz="0.0002" iyy="0.0098" iyz="0.0001"',
               'ixy="0.0004" ixz="-0.0002" iyy="0.0098" iyz="-0.0001"')), at="forearm"),
    Thread("friction", "viscous friction of another size at every joint",
           lambda: lambda q, v, a: rnea(ARM)(q, v, a) + 0.7 * v),
    Thread("friction", "friction ignored at every joint", lambda: lambda q, v, a: rnea(ARM)(q, v, a)
           + [EFFECTS[name].armature for name in ("pan", "lift", "elbow")] * a, driven),
    Thread("mimic", "mimic ignored", lambda: lambda q, v, a: rnea(FINGERS)(
        *(np.append(x, 0.0) for x in (q, v, a)))[:3], lambda: rttrr_pin.load(FINGERS), at="right"),
    Thread("mimic", "force of mimic ignored", lambda: lambda q, v, a: rnea(FINGERS)(
        *(np.append(x, x[2]) for x in (q, v, a)))[:3], lambda: rttrr_pin.load(FINGERS), at="right"),
    Thread("petercorke/robotics-toolbox-python#266", TURNED_PARTLY,
           lambda: planted.newton_euler("modified_dh", partly_turned=True), lambda: rttrr_pin.load(DH)),
    Thread("petercorke/robotics-toolbox-python#326, #404", "force at the next joint at every link",
           lambda: planted.newton_euler("modified_dh", lever_of_next=True), lambda: rttrr_pin.load(DH)),
    Thread("a closed form", "velocity terms of a joint negated", lambda: planted.two_links(velocity_sign=-1.0),
           lambda: rttrr_pin.load(TWO_LINKS), at="shoulder"),
    Thread("a closed form", "Coriolis terms of a joint halved", lambda: planted.two_links(two=1.0),
           lambda: rttrr_pin.load(TWO_LINKS), at="shoulder"),
    Thread("a closed form", "gravity of a joint negated", lambda: planted.two_links(gravity_sign_at_elbow=-1.0),
           lambda: rttrr_pin.load(TWO_LINKS), at="elbow"),
)  # fmt: skip


def test_the_closed_form_without_a_slip_agrees() -> None:
    assert diagnose(rttrr_pin.load(TWO_LINKS), planted.two_links(), n_states=STATES).passed


PAGE = (Path(__file__).parents[2] / "docs" / "diagnose.md").read_text().replace("\\", "")


@pytest.mark.one_in(16)
@pytest.mark.parametrize("thread", THREADS, ids=str)
def test_the_cause_of_a_thread_is_named_alone_and_stands_on_the_page(thread: Thread) -> None:
    result = diagnose(thread.robot(), thread.program(), n_states=STATES, payload=thread.payload)
    assert result.verdict == "explained", result.summary()
    [cause] = result.causes
    assert cause.hypothesis == thread.cause
    assert thread.at in (None, cause.link, cause.joint)
    assert f"| {cause.sentence} |" in PAGE


REAL = {
    "pinocchio_without_mimic": ("fingers", {("mimic ignored", "right")}),
    "toolbox_1.4.0": ("arm_with_gripper", {("fixed link ignored", "gripper")}),
    "toolbox_1.3.1": ("arm_with_gripper", {("fixed link ignored", "gripper"), ("inertia ignored at every link", None)}),
    "mujoco_3.13.0": ("turned_inertial", {("inertial rpy ignored", "forearm")}),
    "toolbox_modified_dh_1.3.1": (
        "modified_dh",
        {(TURNED_PARTLY, None), ("force at the next joint at every link", None)},
    ),
}
"""By table of results of a real program, the robot and what is to be named; README.md beside them says whence they come."""


@pytest.mark.one_in(3)
@pytest.mark.parametrize("table", REAL)
def test_what_real_programs_did_is_named(table: str) -> None:
    """Or named as what no torque tells from it."""
    robot, causes = REAL[table]
    result = diagnose(rttrr_pin.load(FOLDER / f"{robot}.urdf"), FOLDER / f"{table}.csv")
    assert result.verdict == "explained", result.summary()
    named = [
        {(cause.hypothesis, cause.link or cause.joint) for cause in some} for some in (result.causes, *result.others)
    ]
    assert causes in named and len(result.causes) == len(causes)


def test_the_table_of_pinocchio_is_what_its_example_writes(tmp_path: Path) -> None:
    """Of the program that is installed here."""
    robot, table, written = FOLDER / "fingers.urdf", FOLDER / "pinocchio_without_mimic.csv", tmp_path / "results.csv"
    program = Path(__file__).parents[2] / "examples" / "torques_differ" / "pinocchio_mimic.py"
    states = tmp_path / "states.csv"
    states.write_text("".join(",".join(row.split(",")[:10]) + "\n" for row in table.read_text().splitlines()))
    subprocess.run([sys.executable, program, robot, states, written], check=True)
    wanted, got = (np.genfromtxt(path, delimiter=",", skip_header=1)[:, -3:] for path in (table, written))
    assert np.allclose(got, wanted, rtol=1e-12, atol=1e-13)
