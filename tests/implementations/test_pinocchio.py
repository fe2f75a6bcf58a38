"""The oracle computes from Pinocchio's own numbers, and on the model that the file describes."""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import rttrr_pin
from rttrr_pin import RandomPayload, Robot
from rttrr_pin.core.joint import Joint, Limits, Mimic
from rttrr_pin.core.joints import PLANAR, REVOLUTE
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import ImplementationError, InputError, ModelMismatchError, UnknownNameError
from rttrr_pin.implementations import Batch, make_implementation
from rttrr_pin.validation import Sampler
from rttrr_pin.validation.compare import Comparison
from support.implementations import evaluated
from support.serial_chains import numbers, random_chain
from support.tampered import TAMPERED, with_joint, with_link
from support.tolerances import ROUNDING, norm_error
from support.trees import random_tree


@pytest.mark.parametrize("case", TAMPERED)
def test_a_model_that_differs_from_the_file_is_an_error_that_names_the_link(rttrr: Robot, case: str) -> None:
    """Shown by altering one number of ours while Pinocchio reads the file as it is."""
    tamper, named = TAMPERED[case]
    with pytest.raises(ModelMismatchError, match=named) as caught:
        make_implementation("pinocchio", tamper(rttrr.model))
    assert len(caught.value.differences) == 1


def test_the_untampered_model_is_accepted(robot: Robot) -> None:
    assert make_implementation("pinocchio", robot.model).version == pin.__version__


def test_a_model_made_from_numbers_has_no_oracle() -> None:
    model = Model("numbers", Link("base"), (Link("arm", 1.0),), (Joint("j", REVOLUTE, limits=Limits()),))
    with pytest.raises(ImplementationError, match="made from numbers"):
        make_implementation("pinocchio", model)


def test_what_pinocchio_refuses_is_an_oracle_error() -> None:
    """A revolute joint without limits: URDF wants them, dynamics do not need them."""
    text = (
        '<robot name="x"><link name="a"/><link name="b"/><joint name="j" type="revolute"><parent link="a"/>'
        '<child link="b"/><axis xyz="0 0 1"/></joint></robot>'
    )
    with pytest.raises(ImplementationError, match="Pinocchio refuses"):
        make_implementation("pinocchio", rttrr_pin.load(text).model)


def test_unknown_oracle_lists_the_known_ones(rttrr: Robot) -> None:
    with pytest.raises(UnknownNameError, match="pinocchio"):
        make_implementation("pinochio", rttrr.model)


def test_each_quantity_is_what_pinocchio_leaves_in_data(rttrr: Robot) -> None:
    """Read here once more, one state at a time, in the words of Pinocchio's manual."""
    states = Sampler(rttrr.model, seed=5).draw(0, 20)
    oracle = make_implementation("pinocchio", rttrr.model)
    got = oracle.evaluate(states).values
    model = pin.buildModelFromXML(rttrr.model.urdf)
    data = model.createData()
    for k in range(20):
        assert norm_error(got["tau"][k], pin.rnea(model, data, states.q[k], states.v[k], states.a[k])) == 0.0
        for i in range(5):
            j = i + 1
            np.testing.assert_array_equal(got["f"][k, i], data.f[j].linear)
            np.testing.assert_array_equal(got["n"][k, i], data.f[j].angular)
            inertia = model.inertias[j]
            to_com = pin.SE3(np.eye(3), inertia.lever)
            v, a = to_com.actInv(data.v[j]), to_com.actInv(data.a_gf[j])
            central = pin.Inertia(inertia.mass, np.zeros(3), inertia.inertia)
            net = central * a + v.cross(central * v)
            assert norm_error(got["F"][k, i], net.linear) <= ROUNDING
            assert norm_error(got["N"][k, i], net.angular) <= ROUNDING


@pytest.mark.parametrize("payload", [None, "tool"])
def test_a_state_gives_the_same_bits_in_any_batch(payload: str | None) -> None:
    """On a tree with branches, fixed links and a floating base."""
    robot = rttrr_pin.load(random_tree(5, 14), base="floating")
    load = RandomPayload(robot.link_names[-1]) if payload else None
    sampler = Sampler(robot.model, seed=1, payload=load)
    oracle = make_implementation("pinocchio", robot.model)
    together = sampler.draw(0, 33)
    whole = oracle.evaluate(together)
    for k in (0, 16, 32):
        alone = oracle.evaluate(sampler.draw(k, 1))
        for part, of_whole in ((alone.values, whole.values), (alone.allowance, whole.allowance)):
            assert part is not None and of_whole is not None
            for key, x in part.items():
                np.testing.assert_array_equal(x[0], of_whole[key][k])


def test_fixed_links_cost_in_proportion_to_their_number() -> None:
    """Counted in calls, of Python and of C, which no load of the machine changes."""

    def calls(links: int) -> int:
        robot = rttrr_pin.load(random_chain(3, ("revolute", *["fixed"] * links)))
        batch = Sampler(robot.model).draw(0, 2)
        count = 0

        def enter(frame: object, event: str, argument: object) -> None:
            nonlocal count
            count += event in ("call", "c_call")

        sys.setprofile(enter)
        try:
            make_implementation("pinocchio", robot.model).evaluate(batch)
        finally:
            sys.setprofile(None)
        return count

    few, some, many = map(calls, (20, 60, 140))
    assert (many - some) / 80 <= 1.05 * (some - few) / 40


def test_turned_fixed_links_in_a_long_row_are_no_mismatch() -> None:
    """Each turn rounds once more: the placement of the last is a product of all."""
    robot = rttrr_pin.load(random_chain(3, ("revolute", *["fixed"] * 250, "revolute")))
    make_implementation("pinocchio", robot.model)


LONG = 40


def row(kinds: tuple[str, ...], masses: tuple[int, ...], axis: str, xyz: str, rpys: tuple[str, ...]) -> str:
    """Joints one behind the other, each link a point mass in its origin."""
    links = "".join(
        f'<link name="l{i}"><inertial><mass value="{mass}"/>'
        '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>'
        for i, mass in enumerate((0, *masses))
    )
    joints = "".join(
        f'<joint name="j{i:02}" type="{kind}"><parent link="l{i}"/><child link="l{i + 1}"/>'
        f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/></joint>'
        for i, (kind, rpy) in enumerate(zip(kinds, rpys, strict=True))
    )
    return f'<robot name="row">{links}{joints}</robot>'


def within_rounding(model: Model, q: Any, load: Load) -> None:
    """At rest; and 1e-12 of the load more is seen."""
    still, more = np.zeros((len(q), model.nv)), replace(load, f=load.f * (1 + 1e-12), n=load.n * (1 + 1e-12))
    right, wrong = (evaluated("recursion", model, q, still, still, (x,)) for x in (load, more))
    got = evaluated("pinocchio", model, q, still, still, (load,))
    for side, passes in ((right, True), (wrong, False)):
        compared = Comparison(model, list(QUANTITIES)).differences(Batch(model, q, still, still, (load,)), side, got)
        assert (max(float(np.max(one.of_tolerance)) for one in compared) <= 1.0) is passes


@pytest.mark.one_in(3)
@pytest.mark.parametrize("masses", [(0,) * LONG, (1,) * LONG, (*(0,) * (LONG - 1), 1)], ids=["none", "all", "last"])
@pytest.mark.parametrize("xyz", ["0 0 0", "0 0 1"])
@pytest.mark.parametrize("in_base", [False, True])
def test_what_lies_along_axes_rounds_at_each_joint(in_base: bool, xyz: str, masses: tuple[int, ...]) -> None:
    """Rotations about -z, which come from 1 - cos q: by the same angle they round in the same direction."""
    kinds, none = ("continuous",) * LONG, np.zeros(3)
    robot = rttrr_pin.load(row(kinds, masses, "0 0 -1", xyz, ("0 0 0",) * LONG), (0, 0, -9.81))
    q = np.repeat(np.random.default_rng(0).uniform(-3, 3, (50, 1)), LONG, axis=1)
    for f, n in ((np.array([0, 0, 1e3]), none), (none, np.array([0, 0, 1e3]))):
        within_rounding(robot.model, q, Load(LONG - 1, f, n, in_base))


@pytest.mark.parametrize("masses", [(0,) * LONG, (1,) * LONG], ids=["none", "all"])
@pytest.mark.parametrize("xyz", ["0 0 0", "0.1 0.2 0.3"])
@pytest.mark.parametrize("in_base", [False, True])
def test_loads_over_fixed_joints_come_back_in_axes_that_are_rounded(
    in_base: bool, xyz: str, masses: tuple[int, ...]
) -> None:
    """To the body's origin and back: the last fixed joint does not turn, where the recursion rounds nothing."""
    rng = np.random.default_rng(0)
    for count in (2, 8):
        turned = (numbers(rng.uniform(-3, 3, 3)),) * (count - 1)
        text = row(("fixed",) * count, masses[:count], "1 0 0", xyz, (*turned, "0 0 0"))
        robot, f = rttrr_pin.load(text, base="floating"), rng.normal(size=(2, 3)) * 1e3
        for load in (Load(count, f[0], np.zeros(3), in_base), Load(count, np.zeros(3), f[1], in_base)):
            within_rounding(robot.model, np.eye(7)[6:], load)


@pytest.mark.parametrize("mimic", [Mimic(0, -0.7, 0.2), Mimic(0, 0.7, 0.3)], ids=["multiplier", "offset"])
def test_a_misread_follower_is_an_error(mimic: Mimic) -> None:
    """Where Pinocchio can build followers: the followed joint sorts first."""
    head, tail = random_chain(8, ("revolute", "prismatic", "revolute")).rsplit("</joint>", 1)
    model = rttrr_pin.load(f'{head}<mimic joint="joint_1" multiplier="0.7" offset="0.2"/></joint>{tail}').model
    make_implementation("pinocchio", model)
    joints = (*model.joints[:2], replace(model.joints[2], mimic=mimic))
    with pytest.raises(ModelMismatchError, match="joint 'joint_3' mimic"):
        make_implementation("pinocchio", replace(model, joints=joints))


def test_names_that_pinocchio_keeps_for_itself_are_refused() -> None:
    text = random_chain(5, ("revolute", "revolute"))
    with pytest.raises(ImplementationError, match="'universe' has a name that Pinocchio keeps"):
        make_implementation("pinocchio", rttrr_pin.load(text.replace("joint_2", "universe")).model)
    floating = rttrr_pin.load(text.replace('"joint_2"', '"joint_x"'), base="floating").model
    make_implementation("pinocchio", floating)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda m: with_link(m, mass=float("nan")), "mass of link 'link_3' is nan"),
        (lambda m: with_link(m, inertia=np.triu(m.links[2].inertia)), "is not symmetric"),
        (lambda m: with_joint(m, R=2 * np.eye(3)), "expected a rotation"),
        (lambda m: with_joint(m, axis=[0, 2.0, 0]), "expected a unit vector"),
        (lambda m: with_joint(m, name="joint_1"), "'joint_1' stands 2 times"),
        (lambda m: with_joint(m, mimic=Mimic(17)), "does not move by itself"),
        (lambda m: with_joint(m, type=PLANAR), r"expected \[0, 0, 1\]"),
    ],
    ids=["mass", "symmetry", "rotation", "axis", "names", "mimic", "planar"],
)
def test_models_made_from_numbers_are_checked(rttrr: Robot, change: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        change(rttrr.model)


def test_a_robot_that_does_not_fit_in_memory_is_refused_before_it_is_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rttrr_pin.implementations.pinocchio_wrenches.TENSORS", 10**15)
    with pytest.raises(ImplementationError, match="GB for the 5 of this robot.*reference='recursion'"):
        make_implementation("pinocchio", rttrr_pin.load("rttrr").model)
