"""Lagrange's equations give the recursion's driving forces, and Pinocchio's, within bounds that come from arithmetic."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.cli import main
from rttrr_pin.core import dynamics as arithmetic
from rttrr_pin.core.joint import Joint, JointEffects
from rttrr_pin.core.joints import PRISMATIC, REVOLUTE
from rttrr_pin.core.model import Link, Model
from rttrr_pin.exact.intervals import INTERVAL, interval, precision
from rttrr_pin.implementations import make_oracle
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
    result = validate(
        driven(rttrr_pin.load(name, base=base)), 200, sampling="mixed", payload="random", oracle="lagrange"
    )
    assert result.agrees
    assert {row.quantity for row in result.rows} == set(result.whole) == {"tau"}


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("seed", slow_after(4, range(8)))
def test_random_trees_agree_with_the_recursion_and_with_pinocchio(seed: int, base: Any) -> None:
    """Every joint type, followers, drives."""
    robot = driven(rttrr_pin.load(random_tree(seed, 3 + seed), base=base))
    assert validate(robot, 60, seed, "mixed", oracle="lagrange").agrees
    states = Sampler(robot.model, "uniform", seed, robot.link_names[-1]).draw(0, 40)
    ours, theirs = (
        make_oracle(name, robot.model).evaluate(states.q, states.v, states.a, states.loads).wrenches
        for name in ("lagrange", "pinocchio")
    )
    for key in ("tau", "tau_joint"):
        assert norm_error(getattr(ours, key), getattr(theirs, key)) <= ROUNDING


def test_a_payload_in_base_axes_is_turned() -> None:
    robot = rttrr_pin.load(random_tree(3, 6), base="floating")
    wrench = rttrr_pin.Wrench((10, -20, 30), (1, 2, -3), link=robot.link_names[-1], expressed_in="base")
    bare, loaded = (validate(robot, 50, payload=payload, oracle="lagrange") for payload in (None, wrench))
    assert bare.agrees and loaded.agrees
    one, other = (compare_state(robot, 5, payload=payload, oracle="lagrange") for payload in (None, wrench))
    assert not np.allclose(one.theirs.tau, other.theirs.tau)


def test_a_robot_made_from_numbers_can_be_validated() -> None:
    """Lagrange's equations need no file."""
    slider = Joint("slide", PRISMATIC, axis=np.array([0.0, 0.0, 1.0]))
    turner = Joint("turn", REVOLUTE, parent=0, p=np.array([0.5, 0.0, 0.0]))
    links = (Link("a", 2.0), Link("b", 1.0, np.array([0.0, 0.25, 0.0]), np.eye(3)))
    robot = Robot(Model("numbers", Link("base"), links, (slider, turner)))
    assert validate(robot.with_joint_effects({"slide": JointEffects(armature=3.0)}), 50, oracle="lagrange").agrees


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
        assert not validate(rttrr, 50, sampling="large-velocities", oracle="lagrange").agrees


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
    got = make_oracle("lagrange", rttrr.model).evaluate(states.q, states.v, states.a)
    bound, tau = got.rounding["tau"], got.wrenches.tau
    assert (np.linalg.norm(bound, axis=1) <= ROUNDING * np.linalg.norm(tau, axis=1)).all()
    assert (bound > 0.0).all()


def test_a_state_shows_what_the_oracle_has(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["validate", "--oracle", "lagrange", "--state", "3", "--json", "-"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert set(data["theirs"]) == {"tau"} and set(data["ours"]) == {"tau", "F", "N", "f", "n"}
    assert {gap["quantity"] for gap in data["gaps"]} == {"tau"}
    assert main(["validate", "--oracle", "lagrange", "--state", "3"]) == 0
    assert "PASS closest to the gate" in capsys.readouterr().out
    assert main(["validate", "--oracle", "lagrange", "--states", "30"]) == 0
    assert "all of 30 states x 5 rows" in capsys.readouterr().out
