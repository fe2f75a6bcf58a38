"""Robots from `pinocchio.Model` objects: the same torques as from the URDF, and as Pinocchio's own rnea."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.errors import LoadWarning, UrdfError
from rttrr_pin.validation.states import Sampler
from support.recursion import recursion
from support.robots import BUNDLED
from support.serial_chains import EXAMPLES, random_chain
from support.tolerances import EXACT, ROUNDING, norm_error
from support.trees import random_tree

JOINTS: dict[str, Callable[[], Any]] = {
    "RX": pin.JointModelRX,
    "RUBY": pin.JointModelRUBY,
    "PZ": pin.JointModelPZ,
    "revolute": lambda: pin.JointModelRevoluteUnaligned(np.array([0.36, 0.48, 0.8])),
    "prismatic": lambda: pin.JointModelPrismaticUnaligned(np.array([0.36, 0.48, 0.8])),
    "planar": pin.JointModelPlanar,
    "free": pin.JointModelFreeFlyer,
    "translation": pin.JointModelTranslation,
    "zyx": pin.JointModelSphericalZYX,
    "universal": lambda: pin.JointModelUniversal(np.array([0.6, 0.8, 0.0]), np.array([0.0, 0.0, 1.0])),
    "composite": lambda: composite(pin.JointModelRY(), pin.JointModelPX(), pin.JointModelRUBZ()),
    "nested": lambda: composite(pin.JointModelTranslation(), composite(pin.JointModelRZ(), pin.JointModelPY())),
}


def composite(*joints: Any) -> Any:
    whole = pin.JointModelComposite()
    for joint in joints:
        whole.addJoint(joint, pin.SE3.Random())
    return whole


def tree_of(joints: list[Any], seed: int = 0) -> Any:
    """Joints with bodies, each on one of the three before it."""
    pin.seed(seed)
    rng = np.random.default_rng(seed)
    model = pin.Model()
    model.name = "made"
    for k, joint in enumerate(joints):
        parent = int(rng.integers(max(0, k - 2), k + 1))
        number = model.addJoint(parent, joint, pin.SE3.Random(), f"joint {k}")
        model.appendBodyToJoint(number, pin.Inertia.Random(), pin.SE3.Random())
    model.armature = rng.uniform(0, 1, 1) * np.ones(model.nv)
    return model


def state_of(model: Any, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    pin.seed(seed)
    rng = np.random.default_rng(seed)
    q = pin.randomConfiguration(model, -np.ones(model.nq), np.ones(model.nq))
    return q, rng.normal(size=model.nv), rng.normal(size=model.nv)


def ours(joints: Iterable[Any], q: np.ndarray) -> list[float]:
    """Pinocchio's coordinates, with the angle where it has cosine and sine."""
    out: list[float] = []
    for joint in joints:
        own, kind = q[joint.idx_q : joint.idx_q + joint.nq], joint.shortname()
        if kind == "JointModelComposite":
            out += ours((joint.extract() if hasattr(joint, "extract") else joint).joints, q)
        elif "RUB" in kind or "Unbounded" in kind or "Planar" in kind:
            out += [*own[:-2], np.arctan2(own[-1], own[-2])]
        else:
            out += [*own]
    return out


def differs_from_rnea(robot: Robot, model: Any, states: int = 3) -> float:
    data, worst = model.createData(), 0.0
    for seed in range(states):
        q, v, a = state_of(model, seed)
        tau = recursion(robot, ours(list(model.joints)[1:], q), v, a).tau
        worst = max(worst, norm_error(tau, pin.rnea(model, data, q, v, a)))
    return worst


def of_text(text: str, floating: bool = False) -> Any:
    return pin.buildModelFromXML(text, *((pin.JointModelFreeFlyer(),) if floating else ()))


def same_torques(one: Robot, other: Robot) -> float:
    batch = Sampler(one.model, "mixed", 5).draw(0, 10)
    q, v, a = batch.q, batch.v, batch.a
    return norm_error(recursion(other, q, v, a).tau, recursion(one, q, v, a).tau)


def agrees_with_pinocchio(robot: Robot) -> bool:
    return rttrr_pin.validate(robot, "recursion", n_states=10).passed


@pytest.mark.parametrize("source", [*BUNDLED, *EXAMPLES])
@pytest.mark.parametrize("floating", [False, True], ids=["fixed", "floating"])
def test_the_same_robot_as_from_the_urdf(source: str, floating: bool) -> None:
    robot = rttrr_pin.load(EXAMPLES.get(source, source), base="floating" if floating else "fixed")
    loaded = rttrr_pin.load(of_text(robot.model.urdf, floating))
    assert (loaded.joint_names, loaded.link_names) == (robot.joint_names, robot.link_names)
    assert same_torques(robot, loaded) <= ROUNDING


@pytest.mark.parametrize("seed", range(6))
def test_the_same_random_tree_as_from_the_urdf(seed: int) -> None:
    text = random_tree(seed, 9, mimics=False)
    robot, loaded = rttrr_pin.load(text), rttrr_pin.load(of_text(text))
    assert (loaded.joint_names, loaded.link_names) == (robot.joint_names, robot.link_names)
    assert same_torques(robot, loaded) <= ROUNDING
    assert agrees_with_pinocchio(loaded)


@pytest.mark.parametrize("kind", JOINTS)
def test_every_joint_that_has_a_counterpart_is_read(kind: str) -> None:
    model = tree_of([pin.JointModelRX(), JOINTS[kind](), pin.JointModelPY(), JOINTS[kind]()])
    robot = rttrr_pin.load(model)
    assert robot.model.nv == model.nv
    assert differs_from_rnea(robot, model) <= ROUNDING
    assert agrees_with_pinocchio(robot)


def test_joints_keep_the_objects_order() -> None:
    """Pinocchio reads branches of a URDF alphabetically; an object has any order."""
    model = pin.Model()
    for name, parent in (("z", 0), ("y", 0), ("x", 1), ("a", 2)):
        number = model.addJoint(parent, pin.JointModelRY(), pin.SE3.Random(), name)
        model.appendBodyToJoint(number, pin.Inertia.Random(), pin.SE3.Identity())
    robot = rttrr_pin.load(model)
    assert robot.joint_names == ("z", "y", "x", "a")
    assert differs_from_rnea(robot, model) <= ROUNDING
    assert agrees_with_pinocchio(robot)


def test_a_sample_humanoid_gives_the_torques_of_rnea() -> None:
    model = pin.buildSampleModelHumanoid()
    robot = rttrr_pin.load(model)
    assert differs_from_rnea(robot, model) <= ROUNDING
    assert rttrr_pin.load(model, base="floating").model.nv == model.nv  # it floats already


def test_a_joint_that_follows_another_is_read() -> None:
    text = random_tree(4, 8, ("revolute", "prismatic", "fixed"))
    robot = rttrr_pin.load(text)
    assert any(joint.mimic for joint in robot.model.joints)
    loaded = rttrr_pin.load(pin.buildModelFromXML(text, mimic=True))
    assert loaded.joint_names == robot.joint_names
    assert same_torques(robot, loaded) <= ROUNDING
    assert any("keeps no damping" in note.text for note in loaded.model.notes)


def test_armature_is_part_of_tau_and_friction_on_request() -> None:
    model = of_text(random_tree(3, 6, ("revolute", "prismatic"), mimics=False))
    model.armature = np.arange(1.0, 7.0)
    plain, whole = rttrr_pin.load(model), rttrr_pin.load(model, friction=True)
    assert differs_from_rnea(plain, model) <= ROUNDING
    q, v, a = state_of(model, 0)
    rubbed = model.damping * v + model.friction * np.sign(v)
    assert norm_error(recursion(whole, q, v, a).tau, recursion(plain, q, v, a).tau + rubbed) <= ROUNDING
    assert any("friction=True" in note.text for note in plain.model.notes)
    assert not any("friction=True" in note.text for note in whole.model.notes)
    assert agrees_with_pinocchio(whole)
    assert any("armature" in note for note in rttrr_pin.validate(whole, "recursion", n_states=5).to_dict()["notes"])


def test_gravity_is_the_objects_unless_another_is_named() -> None:
    model = tree_of([pin.JointModelRX(), pin.JointModelRY()])
    model.gravity.linear = np.array([1.0, 2.0, -3.0])
    assert rttrr_pin.load(model).model.gravity.tolist() == [1.0, 2.0, -3.0]
    assert rttrr_pin.load(model, gravity=(0, 0, 0)).model.gravity.tolist() == [0.0, 0.0, 0.0]


def test_the_objects_doubles_are_the_exact_parameters() -> None:
    model = of_text(random_tree(3, 6, ("revolute", "prismatic"), mimics=False))
    robot = rttrr_pin.load(model)
    q, v, a = state_of(model, 0)
    tau = recursion(robot, q, v, a).tau
    assert norm_error(robot.enclose(q, v, a, parameters="read").tau.lower, tau) <= ROUNDING
    with pytest.raises(rttrr_pin.InputError, match="from an object, which has doubles"):
        robot.enclose(q, v, a, parameters="text")
    for j, link in enumerate(robot.model.links, 1):
        assert norm_error(link.inertia, model.inertias[j].inertia) == EXACT
        assert norm_error(link.com, model.inertias[j].lever) == EXACT


def test_fixed_links_are_frames_and_their_inertia_is_in_the_sum() -> None:
    text = random_chain(2, ("revolute", "fixed", "revolute", "fixed"))
    robot, loaded = rttrr_pin.load(text), rttrr_pin.load(of_text(text))
    assert loaded.link_names == robot.link_names
    assert [link.mass > 0 for link in loaded.model.links] == [True, False, True, False]
    (note,) = loaded.model.notes
    assert note.text.startswith("the inertia at joint_2, joint_4 is part of the link that holds it")
    assert same_torques(robot, loaded) <= ROUNDING


def test_an_empty_model_is_a_root_alone() -> None:
    robot = rttrr_pin.load(pin.Model())
    assert (robot.model.nv, robot.link_names, robot.model.root.name) == (0, (), "universe")


def test_names_that_no_urdf_holds_are_replaced_and_told() -> None:
    model = pin.Model()
    model.name = "\u00e4 b"
    for k, name in enumerate(("two words", "two words", "", "a\nb", "\u00fc<&\"'")):
        number = model.addJoint(k, pin.JointModelRX(), pin.SE3.Random(), name)
        model.appendBodyToJoint(number, pin.Inertia.Random(), pin.SE3.Identity())
    robot = rttrr_pin.load(model)
    assert robot.joint_names == ("two words", "two words_2", "joint_3", "a_b", "\u00fc<&\"'")
    assert robot.name == "\u00e4 b"
    assert any("'a\\nb' is 'a_b'" in note.text for note in robot.model.notes)
    assert differs_from_rnea(robot, model) <= ROUNDING
    assert agrees_with_pinocchio(robot)


@pytest.mark.parametrize("kind", ["Spherical", "HX", "HelicalUnaligned", "Ellipsoid"])
def test_a_joint_without_a_counterpart_is_refused_by_name(kind: str) -> None:
    made = {
        "HX": lambda: pin.JointModelHX(0.1),
        "HelicalUnaligned": lambda: pin.JointModelHelicalUnaligned(pin.ZAxis, 0.1),
    }
    model = tree_of([pin.JointModelRX(), made.get(kind, getattr(pin, f"JointModel{kind}"))()])
    with pytest.raises(
        UrdfError, match=f"pinocchio.Model 'made'>: joint \"joint 1\": is {kind}, which is none of our joint"
    ):
        rttrr_pin.load(model)


def test_numbers_that_no_robot_has_are_refused() -> None:
    model = tree_of([pin.JointModelRX()])
    model.inertias[1].mass = np.nan
    with pytest.raises(UrdfError, match="mass of link 'joint 0' is nan"):
        rttrr_pin.load(model)
    model = tree_of([pin.JointModelRX()])
    model.jointPlacements[1].rotation = np.diag([1.0, 1.0, 2.0])
    with pytest.raises(UrdfError, match="is no rotation"):
        rttrr_pin.load(model)
    model = tree_of([pin.JointModelFreeFlyer()])
    model.armature = np.arange(6.0)
    with pytest.raises(UrdfError, match="armature .* one number for all its rates"):
        rttrr_pin.load(model)
    for value in (-1.0, np.nan, np.inf):
        model = tree_of([pin.JointModelRX()])
        model.armature = np.array([value])
        with pytest.raises(UrdfError, match=f"armature is {value}: expected"):
            rttrr_pin.load(model)
    model = tree_of([pin.JointModelRX()])
    model.lowerPositionLimit, model.upperPositionLimit = np.ones(1), -np.ones(1)
    with pytest.raises(UrdfError, match="above the upper one"):
        rttrr_pin.load(model)


def test_a_placement_that_is_nearly_a_rotation_is_told() -> None:
    model = tree_of([pin.JointModelRX()])
    model.jointPlacements[1].rotation = model.jointPlacements[1].rotation * (1 + 1e-11)
    assert any("nearest rotation" in note.text for note in rttrr_pin.load(model).model.notes)


def test_one_limit_alone_is_kept() -> None:
    model = tree_of([pin.JointModelPX(), pin.JointModelRX(), pin.JointModelRX()])
    model.lowerPositionLimit = np.array([0.5, -np.inf, -1.0])
    model.upperPositionLimit = np.array([np.inf, -2.0, 1.0])
    robot = rttrr_pin.load(model)
    assert [(joint.limits.lower, joint.limits.upper) for joint in robot.model.joints] == [
        (0.5, np.inf),
        (-np.inf, -2.0),
        (-1.0, 1.0),
    ]
    assert agrees_with_pinocchio(robot)


def test_what_takes_no_part_is_told() -> None:
    model = tree_of([pin.JointModelRX()])
    model.rotorInertia = np.ones(1)
    assert any("what counts is armature" in note.text for note in rttrr_pin.load(model).model.notes)
    model.gravity.angular = np.ones(3)
    with pytest.warns(LoadWarning, match="angular part of gravity"):
        rttrr_pin.load(model)


def test_nothing_is_warned_of_where_nothing_is_left_out(recwarn: pytest.WarningsRecorder) -> None:
    rttrr_pin.load(of_text(rttrr_pin.load("rttrr").model.urdf))
    assert not [each for each in recwarn if issubclass(each.category, LoadWarning)]
