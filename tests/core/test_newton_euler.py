"""The reference recursion, on several kinds of scalar, and against Pinocchio."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rttrr_pin
from rttrr_pin import LinkWrenches, RandomPayload, Robot, Wrench
from rttrr_pin.core.dynamics import evaluate
from rttrr_pin.core.payload import Load
from rttrr_pin.core.scalars import FLOAT
from rttrr_pin.implementations import Batch, make_implementation
from rttrr_pin.validation import EPS as PACKAGE_EPS
from rttrr_pin.validation import SAMPLINGS, Sampler, validate
from support.high_precision import mp_arithmetic
from support.recursion import recursion
from support.serial_chains import RANDOM_TYPES, random_chain
from support.tolerances import EPS, MODEL, ROUNDING, norm_error

SEEDS = (0, 1, 2)


def assert_same(ours: LinkWrenches, theirs: LinkWrenches, tolerance: float = ROUNDING) -> None:
    """Each quantity, per state, in the norm over all links."""
    for (key, x), (_, y) in zip(ours.items(), theirs.items(), strict=True):
        x_, y_ = x.reshape(len(x), -1), y.reshape(len(y), -1)
        size = np.linalg.norm(y_, axis=1)
        worst = np.max(np.linalg.norm(x_ - y_, axis=1) - tolerance * size, initial=-1.0)
        assert worst <= 0.0, f"{key} is off by {worst:.3g} more than the tolerance"


def states(robot: Robot, seed: int, count: int = 50) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    drawn = Sampler(robot.model, "uniform", seed).draw(0, count)
    return drawn.q, drawn.v, drawn.a


@pytest.mark.one_in(3)
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("sampling", SAMPLINGS)
def test_agrees_with_pinocchio_on_every_family_of_states(robot: Robot, sampling: str, seed: int) -> None:
    assert validate(robot, "recursion", n_states=64, seed=seed, sampling=sampling).passed


@pytest.mark.one_in(3)
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("expressed_in", ["link", "base"])
def test_agrees_with_pinocchio_with_a_payload_at_every_link(robot: Robot, expressed_in: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    oracle = make_implementation("pinocchio", robot.model)
    q, v, a = states(robot, seed)
    for i, link in enumerate(robot.link_names):
        f, n = rng.uniform(-20, 20, (2, len(q), 3))
        ours = recursion(robot, q, v, a, Wrench(f, n, link, expressed_in))
        theirs = oracle.evaluate(Batch(robot.model, q, v, a, (Load(i, f, n, expressed_in == "base"),))).values
        assert_same(ours, theirs)


def test_several_payloads_add_up(robot: Robot) -> None:
    q, v, a = states(robot, 3, 5)
    wrenches = [Wrench((i + 1, 2, 3), (4, i, 6), link) for i, link in enumerate(robot.link_names)]
    together = recursion(robot, q, v, a, wrenches)
    alone = [recursion(robot, q, v, a, wrench) for wrench in wrenches]
    bare = recursion(robot, q, v, a)
    for key, x in together.items():
        total = sum(getattr(one, key) - getattr(bare, key) for one in alone) + getattr(bare, key)
        assert norm_error(x, total) <= ROUNDING


@settings(max_examples=30)
@given(seed=st.integers(0, 2**32), types=st.lists(st.sampled_from(RANDOM_TYPES), min_size=1, max_size=8))
def test_agrees_with_pinocchio_on_random_chains(seed: int, types: list[str]) -> None:
    """Any axes, placements, tensors in turned axes, fixed links anywhere."""
    robot = rttrr_pin.load(random_chain(seed, tuple(types)))
    result = validate(robot, "recursion", n_states=20, seed=seed, sampling="mixed", payload=RandomPayload())
    assert result.passed, result.worst


def test_gravity_is_the_field_that_was_passed(rttrr: Robot) -> None:
    """Also where it points sideways, and where there is none."""
    for gravity in ((0, 0, 0), (1.0, -2.0, 3.0)):
        other = rttrr_pin.load("rttrr", gravity=gravity)
        assert validate(other, "recursion", n_states=50).passed
    resting = recursion(rttrr_pin.load("rttrr", gravity=(0, 0, 0)), np.ones(5), np.zeros(5), np.zeros(5))
    assert not any(x.any() for _, x in resting.items())


def test_forces_balance_on_every_link(robot: Robot) -> None:
    """What a link gets from its parent is its net force and what it passes on: the last link passes on the payload."""
    q, v, a = states(robot, 1)
    payload = Wrench((1, 2, 3), (4, 5, 6))
    result = recursion(robot, q, v, a, payload)
    f, F = result.f[:, -1], result.F[:, -1]
    assert norm_error(f, F + np.array([1, 2, 3])) <= MODEL


def test_armless_robot_has_reactions_only(robot: Robot) -> None:
    """The weight of everything rests on the first link, whatever the coordinates, when nothing moves."""
    nv = robot.model.nv
    result = recursion(robot, np.full(nv, 0.3), np.zeros(nv), np.zeros(nv))
    weight = sum(link.mass for link in robot.model.links) * 9.81
    assert abs(np.linalg.norm(result.f[0]) - weight) <= ROUNDING * weight


@pytest.mark.parametrize("seed", SEEDS)
def test_runs_unchanged_on_other_scalars(robot: Robot, seed: int) -> None:
    """The same lines in 50 digits give the floats, to their rounding."""
    q, v, a = states(robot, seed, 1)
    with mpmath.workdps(50):
        exact = evaluate(robot.model, mp_arithmetic(), q, v, a)
        ours = evaluate(robot.model, FLOAT, q, v, a)
        for key in ("F", "N", "f", "n"):
            x, y = ([[float(s) for s in vector] for vector in getattr(result, key)] for result in (ours, exact))
            assert norm_error(x, y) <= ROUNDING
        assert norm_error(ours.tau, [float(t) for t in exact.tau]) <= ROUNDING


def test_eps_is_that_of_float64() -> None:
    assert PACKAGE_EPS == EPS
