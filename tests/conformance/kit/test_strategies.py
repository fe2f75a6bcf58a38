"""Drawn robots are possible ones, drawn states lie within limits, and what fails shrinks to the least that fails."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pytest
from hypothesis import Phase, find, given, settings
from hypothesis import strategies as st

from rttrr_pin import Robot, load
from rttrr_pin.conformance.kit.strategies import TYPES, State, robots, robots_in_motion, states
from rttrr_pin.core.joints import FIXED
from rttrr_pin.diagnosis.variants.mutations import mutation
from rttrr_pin.diagnosis.variants.variant import Variant
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.implementations import Batch
from rttrr_pin.validation.sampling import Ranges

PHASES = (Phase.generate, Phase.shrink)  # to explain what failed takes ten times as long
FEW = settings(max_examples=25, database=None, deadline=None, derandomize=True, phases=PHASES)


def moving(robot: Robot) -> st.SearchStrategy[tuple[Robot, State]]:
    return st.tuples(st.just(robot), states(robot))


@FEW
@given(robots())
def test_drawn_inertias_are_those_of_bodies(robot: Robot) -> None:
    """The eigenvalues of a tensor obey the triangle inequality, and something moves."""
    assert robot.model.nv > 0
    for link in robot.model.links:
        least, middle, most = np.linalg.eigvalsh(link.inertia)
        assert link.mass > 0.0 and least > 0.0 and least + middle > most


@FEW
@given(robots(most_links=4, trees=False, mimic=False))
def test_a_chain_has_no_branches_and_no_followers(robot: Robot) -> None:
    parents = [joint.parent for joint in robot.model.joints]
    assert sorted(parents) == list(range(-1, len(parents) - 1))
    assert len(parents) <= 4 and all(joint.mimic is None for joint in robot.model.joints)


@pytest.mark.parametrize("kind", TYPES)
def test_each_type_of_joint_is_drawn(kind: str) -> None:
    base: Any = "floating" if kind == "fixed" else "fixed"
    robot = find(robots(types=kind, base=base), lambda robot: True, settings=FEW)
    joints = robot.model.joints[base == "floating" :]
    assert [joint.type == FIXED for joint in joints] == [kind == "fixed"]
    assert len(joints) == 1 and robot.model.floating == (base == "floating")


@FEW
@given(robots().flatmap(moving))
def test_drawn_states_lie_within_the_limits(example: tuple[Robot, State]) -> None:
    robot, (q, v, a) = example
    model, ranges = robot.model, Ranges.of(robot.model)
    assert (q.shape, v.shape, a.shape) == ((model.nq,), (model.nv,), (model.nv,))
    assert (np.abs(v) <= ranges.rate).all()
    single = [k for k, joint in enumerate(model.moving) if joint.nq == joint.nv == 1]
    if len(single) == len(model.moving):
        assert ((ranges.lower <= q) & (q <= ranges.upper)).all()


@FEW
@given(robots_in_motion(base="floating"))
def test_a_robot_in_motion_has_a_state_of_its_own(example: tuple[Robot, State]) -> None:
    robot, (q, v, a) = example
    model = robot.model
    assert (q.shape, v.shape, a.shape) == ((model.nq,), (model.nv,), (model.nv,))
    assert np.linalg.norm(q[3:7]) == pytest.approx(1.0)


def test_a_narrow_range_is_kept() -> None:
    text = load_text(lower="0.2013", upper="0.2017")
    state = find(states(load(text)), lambda state: True, settings=FEW)
    assert state.q == pytest.approx(0.2013, abs=4.1e-4) and 0.2013 <= state.q[0] <= 0.2017


def load_text(lower: str, upper: str) -> str:
    inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    limit = f'<limit lower="{lower}" upper="{upper}" velocity="1" effort="1"/>'
    joint = f'<joint name="j" type="revolute"><parent link="b"/><child link="l"/><axis xyz="0 0 1"/>{limit}</joint>'
    return f'<robot name="r"><link name="b"/><link name="l">{inertial}</link>{joint}</robot>'


@pytest.mark.one_in(2)
@pytest.mark.parametrize(("types", "links"), [(("revolute", "prismatic"), 2), (("revolute", "floating"), 1)])
def test_a_dropped_gyroscopic_term_shrinks_to_few_links_in_round_numbers(types: tuple[str, ...], links: int) -> None:
    """One link that turns about a fixed axis shows none: w x I w has no part along w. One that floats does."""
    error = mutation("outwards: drop w.cross(body.I @ w)")

    def differs(example: tuple[Robot, State]) -> bool:
        robot, state = example
        right = Variant(robot.model)
        batch = Batch(robot.model, *(x[None] for x in state))
        wrong = right.with_mutation(error).evaluate(batch)
        return bool((np.abs(wrong["tau"] - right.evaluate(batch)["tau"]) > 1e-9).any())

    robot, (q, v, a) = find(robots_in_motion(4, types), differs, settings=settings(FEW, max_examples=200))
    assert len(robot.model.links) == links
    assert not a.any()
    np.testing.assert_array_equal(q, robot.model.coordinates_at(np.zeros((1, robot.model.nv)))[0])
    assert np.abs(v).max() <= 0.2
    for link in robot.model.links:
        assert link.mass == 1.0 and not link.com.any()


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        ({"most_links": 0}, InputError),
        ({"types": ("revolute", "helical")}, UnknownNameError),
        ({"types": "fixed"}, InputError),
        ({"base": "flying"}, InputError),
    ],
)
def test_wrong_arguments_are_refused(arguments: dict[str, Any], error: type[Exception]) -> None:
    with pytest.raises(error):
        robots(**arguments)


def test_a_missing_hypothesis_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "hypothesis", None)
    with pytest.raises(InputError, match=r"pip install 'rttrr-pin\[hypothesis\]'"):
        robots()
