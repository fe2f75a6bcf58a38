"""Lagrange's equations give the recursion's driving forces, and Pinocchio's, within bounds that come from arithmetic."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import RandomPayload, Robot
from rttrr_pin.cli import main
from rttrr_pin.core import dynamics as arithmetic
from rttrr_pin.core.joint import Joint, JointEffects
from rttrr_pin.core.joints import PRISMATIC, REVOLUTE
from rttrr_pin.core.model import Link, Model
from rttrr_pin.exact.intervals import INTERVAL, interval, precision
from rttrr_pin.implementations import make_implementation
from rttrr_pin.implementations.lagrange import lagrange
from rttrr_pin.validation import Sampler, compare_state, validate
from support.mutants import mutant, planted
from support.robots import BASES, BUNDLED, driven
from support.slow import slow_after
from support.tolerances import ROUNDING, norm_error
from support.trees import random_tree


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("name", BUNDLED)
def test_bundled_arms_agree(name: str, base: Any) -> None:
    robot = driven(rttrr_pin.load(name, base=base))
    result = validate(robot, "recursion", "lagrange", 200, sampling="mixed", payload=RandomPayload())
    assert result.passed
    assert {row.quantity for row in result.rows} == set(result.whole) == {"tau"}


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("seed", slow_after(4, range(8)))
def test_random_trees_agree_with_the_recursion_and_with_pinocchio(seed: int, base: Any) -> None:
    """Every joint type, followers, drives."""
    robot = driven(rttrr_pin.load(random_tree(seed, 3 + seed), base=base))
    assert validate(robot, "recursion", "lagrange", 60, seed, "mixed").passed
    states = Sampler(robot.model, "uniform", seed, RandomPayload(robot.link_names[-1])).draw(0, 40)
    one, other = (make_implementation(name, robot.model).evaluate(states) for name in ("lagrange", "pinocchio"))
    assert norm_error(one.values["tau"], other.values["tau"]) <= ROUNDING
    assert one.tau_joint is not None and other.tau_joint is not None
    assert norm_error(one.tau_joint, other.tau_joint) <= ROUNDING


def test_a_payload_in_base_axes_is_turned() -> None:
    robot = rttrr_pin.load(random_tree(3, 6), base="floating")
    wrench = rttrr_pin.Wrench((10, -20, 30), (1, 2, -3), link=robot.link_names[-1], expressed_in="base")
    bare, loaded = (validate(robot, "recursion", "lagrange", 50, payload=payload) for payload in (None, wrench))
    assert bare.passed and loaded.passed
    one, other = (compare_state(robot, 5, "lagrange", "recursion", payload=payload) for payload in (None, wrench))
    assert not np.allclose(one.result.values["tau"], other.result.values["tau"])


def test_a_robot_made_from_numbers_can_be_validated() -> None:
    """Lagrange's equations need no file."""
    slider = Joint("slide", PRISMATIC, axis=np.array([0.0, 0.0, 1.0]))
    turner = Joint("turn", REVOLUTE, parent=0, p=np.array([0.5, 0.0, 0.0]))
    links = (Link("a", 2.0), Link("b", 1.0, np.array([0.0, 0.25, 0.0]), np.eye(3)))
    robot = Robot(Model("numbers", Link("base"), links, (slider, turner)))
    robot = robot.with_joint_effects({"slide": JointEffects(armature=3.0)})
    assert validate(robot, "kernel", "lagrange", 50).passed


@pytest.mark.parametrize(
    "error",
    [
        "outwards: detune carried.cross(joint.v) * 2",
        "outwards: drop w.cross(body.I @ w)",
        "inwards: drop joint.p.cross(R_f)",
    ],
)
def test_an_error_in_the_recursion_is_seen(rttrr: Robot, error: str) -> None:
    with planted(mutant(error)):
        assert not validate(rttrr, "recursion", "lagrange", 50, sampling="large-velocities").passed


def test_the_recursion_and_lagrange_meet_in_balls(rttrr: Robot) -> None:
    """At 200 bits they agree to 50 digits."""
    with precision(200):
        drawn = Sampler(rttrr.model, seed=7).draw(0, 1)
        q, v, a = ([interval(float(x)) for x in values[0]] for values in (drawn.q, drawn.v, drawn.a))
        ours = arithmetic.dynamics(rttrr.model, INTERVAL, q, v, a).tau
        theirs, _ = lagrange(rttrr.model, INTERVAL, q, v, a)
        for x, y in zip(ours, theirs, strict=True):
            assert (x - y).contains(0)
            assert float((x - y).rad()) < 1e-50


def test_the_bound_is_of_the_size_of_rounding(rttrr: Robot) -> None:
    states = Sampler(rttrr.model).draw(0, 200)
    result = make_implementation("lagrange", rttrr.model).evaluate(states)
    assert result.allowance is not None
    bound, tau = result.allowance["tau"], result.values["tau"]
    assert (np.linalg.norm(bound, axis=1) <= ROUNDING * np.linalg.norm(tau, axis=1)).all()
    assert (bound > 0.0).all()


def test_a_state_shows_what_the_reference_has(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["state", "--reference", "lagrange", "--index", "3", "--json", "-"]) == 0
    data = json.loads(capsys.readouterr().out)
    (one,) = data["references"]
    assert set(one["values"]) == {"tau"} and set(data["values"]) == {"tau", "F", "N", "f", "n"}
    assert {difference["quantity"] for difference in one["differences"]} == {"tau"}
    assert main(["state", "--reference", "lagrange", "--index", "3"]) == 0
    assert main(["validate", "--reference", "lagrange", "--states", "30"]) == 0
