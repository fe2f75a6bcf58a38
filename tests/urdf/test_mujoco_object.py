"""Robots from `mujoco.MjModel` objects and MJCF files: the torques of the URDF, and of MuJoCo's own mj_inverse."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pinocchio as pin
import pytest

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.errors import LoadWarning, UrdfError
from rttrr_pin.validation.states import Sampler
from support.recursion import recursion
from support.robots import BUNDLED
from support.serial_chains import EXAMPLES
from support.tolerances import ROUNDING, norm_error
from support.trees import random_tree

BODY = '<inertial pos="0.1 -0.2 0.3" quat="0.9 0.1 -0.3 0.2" mass="1.5" diaginertia="0.3 0.4 0.5"/>'

AWKWARD = f"""
<mujoco model="awkward">
  <compiler angle="radian"/>
  <option gravity="1 2 -3"><flag contact="disable" limit="disable"/></option>
  <worldbody>
    <body name="stand" pos="1 0 0" quat="1 2 3 4">{BODY}
      <body name="arm" pos="0.1 0.2 0.3" quat="0.3 -0.2 0.1 0.9">
        <joint name="shoulder" axis="1 2 3" pos="0.1 0.2 0.3" ref="0.4" armature="0.7"/>
        <joint type="slide" axis="0 1 1" ref="-0.2"/>
        <joint name="elbow" axis="1 -1 0" pos="0 0.1 -0.3" damping="0.6" range="-1 1" limited="true"/>
        {BODY}
        <body pos="0 0 0.4">{BODY}
          <body name="tip" pos="0 0.1 0"><joint name="wrist" axis="0 0 1" ref="1"/>{BODY}</body>
        </body>
      </body>
    </body>
    <body name="free" pos="3 2 1" quat="0.1 0.2 0.3 0.4"><freejoint name="loose"/>{BODY}
      <body pos="0.2 0 0"><joint axis="0 1 0"/>{BODY}</body>
    </body>
  </worldbody>
</mujoco>
"""


def compiled(text: str) -> Any:
    return mujoco.MjModel.from_xml_string(text)


def inverse(model: Any, qpos: np.ndarray, qvel: np.ndarray, qacc: np.ndarray) -> np.ndarray:
    data = mujoco.MjData(model)
    data.qpos, data.qvel, data.qacc = qpos, qvel, qacc
    mujoco.mj_inverse(model, data)
    return data.qfrc_inverse.copy()


def matrix(quaternion: np.ndarray) -> np.ndarray:
    out = np.empty(9)
    mujoco.mju_quat2Mat(out, quaternion)
    return out.reshape(3, 3)


def differs_from_inverse(robot: Robot, model: Any, states: int = 3) -> float:
    """Free joints: MuJoCo's linear rates and forces are along world axes, ours along the link's."""
    worst = 0.0
    for seed in range(states):
        rng = np.random.default_rng(seed)
        q, v, a = rng.normal(size=model.nq), rng.normal(size=model.nv), rng.normal(size=model.nv)
        qpos, qvel, qacc, turns = q.copy(), v.copy(), a.copy(), []
        for j in np.flatnonzero(model.jnt_type == 0):
            at, dof = model.jnt_qposadr[j], model.jnt_dofadr[j]
            q[at + 3 : at + 7] /= np.linalg.norm(q[at + 3 : at + 7])
            qpos[at + 3 : at + 7] = np.roll(q[at + 3 : at + 7], 1)
            R, w = matrix(qpos[at + 3 : at + 7]), v[dof + 3 : dof + 6]
            linear = slice(dof, dof + 3)
            qvel[linear], qacc[linear] = R @ v[linear], R @ (a[linear] + np.cross(w, v[linear]))
            turns.append((linear, R))
        theirs = inverse(model, qpos, qvel, qacc)
        for linear, R in turns:
            theirs[linear] = R.T @ theirs[linear]
        worst = max(worst, norm_error(recursion(robot, q, v, a).tau, theirs))
    return worst


def same_torques(one: Robot, other: Robot) -> float:
    """By names: MuJoCo keeps the order of the file, and Pinocchio's is alphabetical."""
    batch = Sampler(one.model, "mixed", 5).draw(0, 10)
    q = [one.model.q_names.index(name) for name in other.model.q_names]
    v = [one.model.v_names.index(name) for name in other.model.v_names]
    tau = recursion(other, batch.q[:, q], batch.v[:, v], batch.a[:, v]).tau
    return norm_error(tau, recursion(one, batch.q, batch.v, batch.a).tau[:, v])


def agrees(robot: Robot) -> bool:
    return rttrr_pin.validate(robot, "recursion", ["pinocchio", "mujoco"], n_states=10).passed


@pytest.mark.parametrize("source", [*BUNDLED, *(name for name in EXAMPLES if name != "no-joint")])
def test_the_same_robot_as_from_the_urdf(source: str) -> None:
    robot = rttrr_pin.load(EXAMPLES.get(source, source))
    loaded = rttrr_pin.load(compiled(robot.model.urdf))
    assert loaded.joint_names == robot.joint_names
    assert same_torques(robot, loaded) <= ROUNDING


@pytest.mark.parametrize("seed", range(8))
def test_the_same_random_tree_as_from_the_urdf_with_joints_that_follow(seed: int) -> None:
    text = random_tree(seed, 9, ("revolute", "continuous", "prismatic", "fixed"))
    robot = rttrr_pin.load(text, friction=True)
    loaded = rttrr_pin.load(compiled(text), friction=True)
    assert sorted(loaded.joint_names) == sorted(robot.joint_names)
    assert same_torques(robot, loaded) <= ROUNDING
    assert agrees(loaded)


@pytest.mark.filterwarnings("ignore::rttrr_pin.errors.LoadWarning")
def test_what_mjcf_alone_can_say_gives_the_torques_of_mj_inverse() -> None:
    """Several joints of a body, beside its origin, with references; free bodies; armature and damping."""
    model = compiled(AWKWARD)
    robot = rttrr_pin.load(model, friction=True)
    assert robot.model.gravity.tolist() == [1.0, 2.0, -3.0]
    assert robot.joint_names == ("shoulder", "joint_1", "elbow", "wrist", "loose", "joint_5")
    assert {"stand", "arm", "tip", "free", "body_3"} <= set(robot.link_names)
    assert differs_from_inverse(robot, model) <= ROUNDING
    assert agrees(robot)


def test_an_mjcf_file_is_what_mujoco_compiles_of_it(tmp_path: Path) -> None:
    robot = rttrr_pin.load("rttrr")
    model = compiled(robot.model.urdf)
    path = tmp_path / "saved.xml"
    mujoco.mj_saveLastXML(str(path), model)  # six digits of each number
    saved = rttrr_pin.load(path)
    assert saved.joint_names == robot.joint_names
    assert same_torques(rttrr_pin.load(mujoco.MjModel.from_xml_path(str(path))), saved) == 0.0
    assert same_torques(robot, saved) <= 1e-5
    again = mujoco.MjModel.from_xml_path(str(path))
    again.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT) | int(mujoco.mjtDisableBit.mjDSBL_LIMIT)
    assert differs_from_inverse(saved, again) <= ROUNDING
    assert agrees(saved)


@pytest.mark.parametrize("floats", [False, True], ids=["fixed", "floating"])
def test_urdf_pinocchio_mujoco_and_mjcf_give_the_same_torques(floats: bool, tmp_path: Path) -> None:
    """An arm whose numbers have few digits, so that MuJoCo's file has them all."""
    part = '<inertial><origin xyz="0 0 0.25"/><mass value="2"/><inertia ixx="0.5" ixy="0" ixz="0" iyy="0.375" iyz="0" izz="0.25"/></inertial>'
    joints = "".join(
        f'<link name="l{i}">{part}</link><joint name="j{i}" type="{kind}"><parent link="{f"l{i - 1}" if i else "base"}"/><child link="l{i}"/>'
        f'<origin xyz="0 0.125 0.5"/><axis xyz="{axis}"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
        for i, (kind, axis) in enumerate([("revolute", "0 0 1"), ("prismatic", "0 1 0"), ("revolute", "1 0 0")])
    )
    text = f'<robot name="few"><link name="base">{part if floats else ""}</link>{joints}</robot>'
    base = "floating" if floats else "fixed"
    robot = rttrr_pin.load(text, base=base)
    path = tmp_path / "few.xml"
    if floats:
        spec = mujoco.MjSpec.from_string(text)
        spec.compiler.fusestatic = False
        spec.bodies[1].add_freejoint(name="root_joint")
        model = spec.compile()
        path.write_text(spec.to_xml())
    else:
        model = compiled(text)
        mujoco.mj_saveLastXML(str(path), model)
    root = (pin.JointModelFreeFlyer(),) if floats else ()
    for source in (pin.buildModelFromXML(text, *root), model, path):
        other = rttrr_pin.load(source)
        assert other.joint_names == robot.joint_names
        assert same_torques(robot, other) <= ROUNDING


def test_armature_is_part_of_tau_and_friction_on_request() -> None:
    text = '<mujoco><worldbody><body><joint armature="2" damping="3" frictionloss="5" axis="0 1 0"/>' + BODY
    model = compiled(text + "</body></worldbody></mujoco>")
    with pytest.warns(
        LoadWarning,
        match="no part of tau unless asked for .friction=True, --friction.: damping of joint_0; friction of",
    ):
        plain = rttrr_pin.load(model)
    whole = rttrr_pin.load(model, friction=True)
    assert [vars_of(robot) for robot in (plain, whole)] == [(2.0, 0.0, 0.0), (2.0, 3.0, 5.0)]
    assert not any(note.left_out for note in whole.model.notes)
    model.dof_frictionloss[:] = 0.0
    assert differs_from_inverse(rttrr_pin.load(model, friction=True), model) <= ROUNDING
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_DAMPER)
    assert vars_of(rttrr_pin.load(model, friction=True)) == (2.0, 0.0, 0.0)


def vars_of(robot: Robot) -> tuple[float, ...]:
    effects = robot.model.joints[0].effects
    return effects.armature, effects.damping, effects.friction


TWO = f"""<mujoco><option {{option}}/><worldbody>
  <body name="one"><joint name="a" axis="0 1 0" {{joint}}/>{BODY}
    <body name="two" pos="0 0 1" {{body}}><joint name="b" axis="1 0 0"/>{BODY}<site name="s"/></body></body>
  </worldbody>{{more}}</mujoco>"""


@pytest.mark.parametrize(
    ("what", "message"),
    [
        ({"joint": 'stiffness="3"'}, "springs"),
        ({"body": 'gravcomp="1"'}, "compensation of gravity"),
        ({"option": 'density="1.2" viscosity="0.1"'}, "fluid"),
        ({"more": '<tendon><fixed name="t" stiffness="3"><joint joint="a" coef="1"/></fixed></tendon>'}, "tendons"),
        ({"more": '<equality><connect name="c" body1="one" body2="two" anchor="0 0 0"/></equality>'}, "left out: c"),
        ({"more": '<equality><joint joint1="a" polycoef="0.5"/></equality>'}, "left out: number 0"),
        ({"more": '<equality><joint joint1="a" joint2="b" polycoef="0 1 1"/></equality>'}, "left out: number 0"),
    ],
    ids=["spring", "gravcomp", "fluid", "tendon", "connect", "lock", "curved"],
)
def test_what_a_tree_has_not_is_left_out_and_told(what: dict[str, str], message: str) -> None:
    model = compiled(TWO.format(**dict.fromkeys(("option", "joint", "body", "more"), "") | what))
    with pytest.warns(LoadWarning, match=message):
        robot = rttrr_pin.load(model)
    result = rttrr_pin.validate(robot, "recursion", n_states=5)
    assert result.passed
    assert any(message in note for note in result.to_dict()["notes"])


def test_actuators_are_told_without_a_warning() -> None:
    more = '<actuator><motor joint="a" gear="50"/></actuator>'
    robot = rttrr_pin.load(compiled(TWO.format(option="", joint="", body="", more=more)))
    assert any("actuators (1): tau is what the joints need" in note.text for note in robot.model.notes)


def test_linear_equalities_are_joints_that_follow_others() -> None:
    """Through references, and in chains."""
    bodies = "".join(
        f'<body pos="0 0 {k}"><joint name="{name}" axis="0 1 0" ref="{ref}"/>{BODY}</body>'
        for k, (name, ref) in enumerate([("a", 0.25), ("b", -0.5), ("c", 0.0)])
    )
    ties = '<joint joint1="c" joint2="b" polycoef="1 2"/><joint joint1="b" joint2="a" polycoef="0.5 -3"/>'
    model = compiled(
        f'<mujoco><compiler angle="radian"/><worldbody>{bodies}</worldbody><equality>{ties}</equality></mujoco>'
    )
    robot = rttrr_pin.load(model)
    assert robot.joint_names == ("a",)
    b, c = (robot.model.joints[k].mimic for k in (1, 2))
    assert b is not None
    assert c is not None
    # b + 0.5 = 0.5 - 3 (a - 0.25), and c = 1 + 2 (b + 0.5)
    assert (b.multiplier, b.offset, c.multiplier, c.offset) == (-3.0, 0.75, -6.0, 3.5)
    assert agrees(robot)


def test_joints_that_follow_one_another_in_a_circle_are_left_out() -> None:
    ties = '<joint joint1="a" joint2="b"/><joint joint1="b" joint2="a"/>'
    with pytest.warns(LoadWarning, match="left out: number 1"):
        assert rttrr_pin.load(
            compiled(TWO.format(option="", joint="", body="", more=f"<equality>{ties}</equality>"))
        ).joint_names == ("b",)


def test_a_ball_joint_is_refused_by_name() -> None:
    model = compiled(f'<mujoco><worldbody><body><joint name="hip" type="ball"/>{BODY}</body></worldbody></mujoco>')
    with pytest.raises(UrdfError, match='joint "hip": is a ball joint'):
        rttrr_pin.load(model)


def test_the_world_does_not_float() -> None:
    standing = compiled(TWO.format(option="", joint="", body="", more=""))
    with pytest.raises(rttrr_pin.InputError, match="no mass that could float: add a <freejoint/>"):
        rttrr_pin.load(standing, base="floating")
    free = compiled(f"<mujoco><worldbody><body><freejoint/>{BODY}</body></worldbody></mujoco>")
    assert rttrr_pin.load(free, base="floating").model.nv == 6


def test_gravity_is_the_models_unless_another_is_named() -> None:
    model = compiled(TWO.format(option='gravity="1 2 3"', joint="", body="", more=""))
    assert rttrr_pin.load(model).model.gravity.tolist() == [1.0, 2.0, 3.0]
    assert rttrr_pin.load(model, gravity=(0, 0, -9.81)).model.gravity.tolist() == [0.0, 0.0, -9.81]
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
    assert rttrr_pin.load(model).model.gravity.tolist() == [0.0, 0.0, 0.0]


def test_an_empty_model_is_a_world_alone() -> None:
    robot = rttrr_pin.load(compiled("<mujoco/>"))
    assert (robot.model.nv, robot.link_names, robot.model.root.name) == (0, (), "world")


def test_names_of_any_kind() -> None:
    names = ("two words", "\u00fc &amp; &lt;", "")
    bodies = "".join(f'<body name="{name}"><joint name="{name}" axis="0 1 0"/>{BODY}</body>' for name in names)
    robot = rttrr_pin.load(compiled(f'<mujoco model="\u00e4"><worldbody>{bodies}</worldbody></mujoco>'))
    assert robot.name == "\u00e4"
    assert robot.joint_names == ("two words", "\u00fc & <", "joint_2")
    assert agrees(robot)


def test_what_mujoco_refuses_is_refused_with_its_words(tmp_path: Path) -> None:
    path = tmp_path / "bad.xml"
    path.write_text("<mujoco><worldbody><bod/></worldbody></mujoco>")
    with pytest.raises(UrdfError, match="bad.xml: MuJoCo refuses the file: .*unrecognized"):
        rttrr_pin.load(path)


def test_without_mujoco_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "arm.xml"
    path.write_text("<?xml version='1.0'?><!-- <robot> -->\n<mujoco/>")
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(UrdfError, match=r"is MJCF, which MuJoCo reads: pip install 'rttrr-pin\[mujoco\]'"):
        rttrr_pin.load(path)


def test_a_urdf_may_be_called_xml(tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(rttrr_pin.load("rttrr").model.urdf)
    assert rttrr_pin.load(path).name == "rttrr"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<mujoco/>", "<mujoco>, expected <robot>: this is MJCF, which load, validate"),
        ('<sdf version="1.9"/>', "<sdf>, expected <robot>: this is SDF, .*convert it to URDF"),
    ],
)
def test_other_formats_are_refused_with_the_way_on(text: str, message: str) -> None:
    with pytest.raises(UrdfError, match=message):
        rttrr_pin.load(text)
