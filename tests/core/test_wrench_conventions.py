"""Each row of the table against the program itself: it agrees within rounding, and no other axes, point, sign or order does."""

from __future__ import annotations

import io
import warnings
from collections.abc import Callable
from dataclasses import replace
from itertools import product
from typing import Any

import mujoco
import numpy as np
import pytest
import yourdfpy

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.core.conventions import CONVENTIONS, Convention, convention
from rttrr_pin.core.joint_wrenches import joint_wrenches
from rttrr_pin.core.placements import in_base
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.implementations import Batch, default_allowance
from rttrr_pin.implementations.allowance import sizes
from rttrr_pin.validation import Sampler
from support import wrench_programs
from support.recursion import recursion
from support.serial_chains import random_chain
from support.tolerances import CONSUMER, DIAGONALISED, EXACT, ROUNDING, SINGLE, norm_error
from support.trees import random_tree

STATES = 5
TREE = ("revolute", "continuous", "prismatic", "fixed")

EVERY = tuple(product(("link", "base"), ("origin", "com", "tree"), ("child", "parent"), ("force", "moment")))
"""All that a row can say: axes, point, on whom, what comes first."""


def drawn(robot: Robot, states: int = STATES) -> Batch:
    return Sampler(robot.model, "uniform", 3).draw(0, states)


def agreeing(robot: Robot, batch: Batch, told: wrench_programs.Told, extra: float = 0.0) -> list[tuple[str, ...]]:
    """Which of all conventions agree with what a program said, within rounding, and within so much of all terms."""
    a, numbers = told
    batch = replace(batch, a=a)
    result = batch.recursion[0]
    allowed, terms = default_allowance(batch), sizes(batch)
    f, n = (allowed[key] + extra * terms[key] for key in "fn")
    reach = np.linalg.norm(in_base(robot.model, batch.q)[1], axis=-1)
    n = n + 2 * reach.max() * f  # the moment goes to another point
    places = [robot.link_names.index(name) for name in numbers]
    assert places
    seen = np.stack([*numbers.values()], axis=1)
    found = []
    for axes, point, acts_on, first in EVERY:
        row = Convention("", "", "", axes, point, acts_on, first, "", "", (), "")  # type: ignore[arg-type]
        ours = joint_wrenches(row, robot.model, batch.q, result.f, result.n).vector[:, places]
        halves = np.linalg.norm((seen - ours).reshape(*seen.shape[:-1], 2, 3), axis=-1)
        bounds = np.stack([f, n] if first == "force" else [n, f], axis=-1)[:, places]
        if (halves <= bounds).all():
            found.append((axes, point, acts_on, first))
    return found


def only(name: str) -> list[tuple[str, ...]]:
    row = convention(name)
    return [(row.axes, row.point, row.acts_on, row.first)]


def tree(seed: int, base: Any = "fixed") -> Robot:
    return rttrr_pin.load(random_tree(seed, 8, TREE, mimics=False), base=base)


ROBOTS: dict[str, Callable[[], Robot]] = {
    "rttrr": lambda: rttrr_pin.load("rttrr"),
    "branches": lambda: tree(0),
    "fixed to the base": lambda: tree(39),
    "floating": lambda: tree(0, "floating"),
}
"""The trees have fixed joints between those that move; of the second one, also the first joint is fixed."""


@pytest.mark.parametrize("name", ROBOTS)
def test_pinocchio(name: str) -> None:
    robot = ROBOTS[name]()
    batch = drawn(robot)
    assert agreeing(robot, batch, wrench_programs.pinocchio(robot, batch)) == only("pinocchio")


@pytest.mark.parametrize("name", ["rttrr", "branches", "fixed to the base"])
def test_mujoco_of_a_file(name: str) -> None:
    """It merges fixed links; its bodies hang on the world by the first that move."""
    robot = ROBOTS[name]()
    batch = drawn(robot)
    told = wrench_programs.mujoco(robot, batch)
    fixed = {link.name for joint, link in zip(robot.model.joints, robot.model.links, strict=True) if not joint.nv}
    assert fixed and not fixed & {*told[1]}
    assert agreeing(robot, batch, told, DIAGONALISED) == only("mujoco")


BODY = '<inertial pos="{} 0.1 -0.2" quat="1 0.3 -0.2 0.5" mass="{}" diaginertia="0.2 0.3 0.4"/>'

OBJECT = f"""<mujoco>
<worldbody>
  <body name="base" pos="0 0 1"><freejoint name="root"/>{BODY.format(0.1, 3)}
    <body name="arm" pos="0.3 0 0.1" quat="1 2 0 1"><joint name="j1" axis="1 1 0"/>{BODY.format(-0.2, 2)}
      <body name="plate" pos="0 0.4 0" quat="0 1 1 0">{BODY.format(0.2, 0.7)}
        <body name="tip" pos="0.1 0 0.2"><joint name="j2" type="slide" axis="0 1 1"/>{BODY.format(0.3, 0.4)}</body>
      </body>
    </body>
    <body name="leg" pos="-0.3 0 0"><joint name="j3" axis="0 0 1"/>{BODY.format(0.2, 1)}</body>
  </body>
  <body name="stand" pos="2 0 0">{BODY.format(-0.3, 5)}
    <body name="lever" pos="0 0.5 0"><joint name="j4" axis="0 1 0"/>{BODY.format(0.4, 1.5)}</body>
  </body>
</worldbody>
</mujoco>"""


def test_mujoco_of_its_own_model() -> None:
    """A floating tree and a fixed one: bodies without a joint are kept, and the point is the centre of mass of each tree."""
    compiled = mujoco.MjModel.from_xml_string(OBJECT)
    robot = rttrr_pin.load(compiled)
    batch = drawn(robot)
    told = wrench_programs.mujoco(robot, batch, compiled)
    assert {"plate", "stand"} <= {*told[1]}
    assert agreeing(robot, batch, told) == only("mujoco")


def test_an_object_that_is_no_mujoco_model_is_as_its_text() -> None:
    text = random_tree(39, 8, TREE, mimics=False)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        robot = rttrr_pin.load(yourdfpy.URDF.load(io.StringIO(text), load_meshes=False, build_scene_graph=False))
    batch = drawn(robot)
    assert agreeing(robot, batch, wrench_programs.mujoco(robot, batch), DIAGONALISED) == only("mujoco")


def test_sensors_of_a_site_of_mujoco() -> None:
    """At the joint and in the link's axes they are f and n."""
    robot = rttrr_pin.load("rttrr")
    spec = mujoco.MjSpec.from_string(robot.model.urdf)
    spec.body("link_4").add_site(name="site")
    for kind in (mujoco.mjtSensor.mjSENS_FORCE, mujoco.mjtSensor.mjSENS_TORQUE):
        spec.add_sensor(type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, objname="site")
    compiled = spec.compile()
    compiled.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    data = mujoco.MjData(compiled)
    batch = drawn(robot, 1)
    data.qpos, data.qvel = batch.q[0], batch.v[0]
    mujoco.mj_forward(compiled, data)
    batch = replace(batch, a=data.qacc[None].copy())
    wanted = np.r_[batch.recursion[0].at("link_4")["f"][0], batch.recursion[0].at("link_4")["n"][0]]
    assert norm_error(data.sensordata, wanted) <= CONSUMER


@pytest.mark.drake
@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.filterwarnings("ignore")
def test_drake(name: str) -> None:
    """Its joints' own friction is no part of what crosses them, and fixed joints are welds."""
    robot = ROBOTS[name]()
    batch = drawn(robot)
    told = wrench_programs.drake(robot, batch)
    assert {*told[1]} == {*robot.link_names}
    assert agreeing(robot, batch, told) == only("drake")


@pytest.mark.simulators
def test_physx() -> None:
    """Of free joints, in float32, whose frames are shifted and turned on the child's side: the program's numbers are in these."""
    robot = rttrr_pin.load(random_chain(5, ("revolute", "prismatic", "revolute", "fixed", "continuous")))
    batch = drawn(robot)
    told = wrench_programs.physx(robot, batch)
    assert {*told[1]} == {*robot.link_names}
    assert agreeing(robot, batch, told, SINGLE) == only("isaaclab")


@pytest.mark.simulators
def test_newton() -> None:
    """In float32; of `SolverFeatherstone`, which leaves the accelerations of the joints out."""
    robot = tree(39)
    batch = drawn(robot)
    assert agreeing(robot, batch, wrench_programs.newton(robot, batch), SINGLE) == only("newton")


@pytest.mark.simulators
@pytest.mark.parametrize("name", ["branches", "fixed to the base"])
def test_the_engine_of_gazebo(name: str) -> None:
    """What it passes on is on the child, moment first; the sensor of gz-sensors puts the force first, and takes minus that."""
    robot = ROBOTS[name]()
    if any(not link.mass for link in robot.model.links):  # DART gives them 1 kg
        robot = rttrr_pin.load(random_tree(30, 8, TREE, mimics=False))
    batch = drawn(robot)
    gazebo = convention("gazebo")
    engine = (gazebo.axes, gazebo.point, "child", "moment")
    assert gazebo.acts_on == "parent" and gazebo.first == "force"
    assert agreeing(robot, batch, wrench_programs.dart(robot, batch)) == [engine]


@pytest.mark.parametrize("batch_shape", [(), (3,), (2, 3), (0,)])
@pytest.mark.parametrize("name", [row.name for row in CONVENTIONS])
def test_a_state_has_the_same_numbers_alone_as_a_part_and_in_a_batch(name: str, batch_shape: tuple[int, ...]) -> None:
    robot = tree(4)
    batch = drawn(robot, 6)
    whole = robot.inverse_dynamics(batch.q, batch.v, batch.a).in_convention(name)
    n = int(np.prod(batch_shape, dtype=int))
    q, v, a = (x[:n].reshape(*batch_shape, x.shape[-1]) for x in (batch.q, batch.v, batch.a))
    result = robot.inverse_dynamics(q, v, a)
    part = result.in_convention(name)
    assert np.array_equal(part.vector, whole.vector[:n].reshape(*batch_shape, *whole.vector.shape[1:]))
    assert np.array_equal(part.at(robot.link_names[2]), part.vector[..., 2, :])
    if n > 1:
        assert np.array_equal(result[-1].in_convention(name).vector, part.vector[-1])


@pytest.mark.parametrize("row", CONVENTIONS, ids=lambda row: row.name)
def test_the_inverse_gives_f_and_n_back(row: Convention) -> None:
    robot = tree(4)
    batch = drawn(robot)
    result = batch.recursion[0]
    R, r = in_base(robot.model, batch.q)
    told = row.of_link(result.f, result.n, R, r)
    for got, wanted in zip(row.to_link(*told, R, r), (result.f, result.n), strict=True):
        assert np.abs(got - wanted).max() <= ROUNDING * np.abs(told).max()


def test_coordinates_are_those_of_the_call() -> None:
    """Whatever becomes of the array or the dict that was passed; those that broadcast are taken so."""
    robot = rttrr_pin.load("rttrr")
    batch = drawn(robot, 3)
    q, v, a = batch.q[0].copy(), batch.v, batch.a
    right = robot.inverse_dynamics(np.tile(q, (3, 1)), v, a).in_convention("mujoco").vector
    named = {name: np.array(x) for name, x in zip(robot.joint_names, q, strict=True)}
    results = [robot.inverse_dynamics(x, v, a) for x in (q, named, q.tolist())]
    q += 1.0
    named["joint_1"] += 1.0
    for result in results:
        assert np.array_equal(result.in_convention("mujoco").vector, right)
        assert np.array_equal(result[1].in_convention("mujoco").vector, right[1])


def test_what_cannot_be_answered_is_said() -> None:
    robot = rttrr_pin.load("rttrr")
    q, v, a = (x[0] for x in (drawn(robot).q, drawn(robot).v, drawn(robot).a))
    result = robot.inverse_dynamics(q, v, a)
    with pytest.raises(UnknownNameError, match="mujoco"):
        result.in_convention("mujoko")
    with pytest.raises(UnknownNameError, match="link_5"):
        result.in_convention("mujoco").at("link_9")
    with pytest.raises(InputError, match=r"Robot\.inverse_dynamics"):
        recursion(robot, q, v, a).in_convention("drake")


def test_a_tree_without_mass_has_its_point_where_its_first_body_has_its_own() -> None:
    robot = rttrr_pin.load(
        '<robot name="frame"><link name="a"/><link name="b"/><joint name="j" type="fixed">'
        '<parent link="a"/><child link="b"/></joint></robot>'
    )
    empty = np.zeros(0)
    assert (robot.inverse_dynamics(empty, empty, empty).in_convention("mujoco").vector == EXACT).all()
