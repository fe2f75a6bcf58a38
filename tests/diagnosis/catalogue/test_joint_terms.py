"""Terms of the equation of motion in tau of one joint: what they are, and that a slip in one is named."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.core.arrays import Array
from rttrr_pin.diagnosis import diagnose
from rttrr_pin.diagnosis.catalogue.joint_terms import SLIPS, TERMS, joint_terms, parts_of_tau
from rttrr_pin.diagnosis.catalogue.whole import hypotheses_of
from rttrr_pin.diagnosis.variants.variant import Variant
from rttrr_pin.validation.sampling import Sampler
from support.robots import driven
from support.serial_chains import random_chain
from support.trees import random_tree

CLOSE = 1e-11
"""Relative to the largest tau."""


@cache
def robots() -> dict[str, Robot]:
    return {
        "rttrr": rttrr_pin.load("rttrr"),
        "mimic and friction": driven(rttrr_pin.load(random_tree(11, 6, ("revolute", "prismatic")))),
        "all types": rttrr_pin.load(random_tree(39, 6)),
        "floating": Robot(rttrr_pin.load(random_tree(3, 4)).model.with_floating_base()),
    }


NAMES = ("rttrr", "mimic and friction", "all types", "floating")


@cache
def bare(robot: Robot) -> Robot:
    """Without gravity and what joints take themselves."""
    return Robot(robot.model.without_joint_effects().with_gravity(np.zeros(3)))


def tau(robot: Robot, q: Array, v: Array, a: Array) -> Array:
    return bare(robot).inverse_dynamics(q, v, a).tau


@pytest.mark.one_in(4)
@pytest.mark.parametrize("name", NAMES)
def test_terms_are_those_of_the_equation_of_motion(name: str) -> None:
    """M a without the joint's own, C v by pairs of rates, and what is left at rest; friction and payloads take no part."""
    robot = robots()[name]
    states = Sampler(robot.model, seed=1).draw(0, 4)
    q, v, a = states.q, states.v, states.a
    terms, nothing = parts_of_tau(robot.model, states), np.zeros_like(v)
    size = np.abs(robot.inverse_dynamics(q, v, a).tau).max()
    whole = Robot(robot.model.without_joint_effects()).inverse_dynamics(q, v, a).tau
    own = np.zeros_like(v)
    for joint in {tuple(columns) for columns in columns_of(robot)}:
        only = np.zeros_like(v)
        only[:, joint] = a[:, joint]
        own[:, joint] = tau(robot, q, nothing, only)[:, joint]
    parts = terms["gravity"] + terms["velocity terms"] + terms["inertial coupling"] + own
    assert np.abs(parts - whole).max() < CLOSE * size
    singles = [np.eye(robot.model.nv)[k] * v for k in range(robot.model.nv)]
    alone = [tau(robot, q, one, nothing) for one in singles]
    pairs = [
        tau(robot, q, singles[i] + singles[k], nothing) - alone[i] - alone[k]
        for i in range(robot.model.nv)
        for k in range(i)
    ]
    assert np.abs(np.sum(alone, axis=0) - terms["centrifugal terms"]).max() < CLOSE * size
    assert np.abs(np.sum(pairs, axis=0) - terms["Coriolis terms"]).max() < CLOSE * size


def columns_of(robot: Robot) -> list[list[int]]:
    """The rates of each joint."""
    found, first = [], 0
    for i in robot.model.independent:
        nv = robot.model.joints[i].nv
        found.append(list(range(first, first + nv)))
        first += nv
    return found


def test_terms_that_a_joint_has_not_are_not_tried() -> None:
    """The first joint of RTTRR is vertical: it feels no gravity; one joint alone has no terms of its own."""
    ids = {(one.id, one.joint) for one in joint_terms(robots()["rttrr"].model)}
    assert ("gravity of a joint negated", "joint_2") in ids
    assert ("gravity of a joint negated", "joint_1") not in ids
    assert len(ids) <= len(TERMS) * len(SLIPS) * 5
    one_joint = rttrr_pin.load(random_chain(1, ("revolute",)))
    assert joint_terms(one_joint.model) == []
    weightless = robots()["rttrr"].model.with_gravity(np.zeros(3))
    assert not any("gravity" in one.id for one in joint_terms(weightless))


def test_what_comes_before_is_done_to_the_term_too() -> None:
    """Tau of the other sign, states in degrees and another mass: the term is that of the program itself."""
    model = robots()["rttrr"].model
    states = Sampler(model, seed=2).draw(0, 4)
    by_id = {(one.id, one.joint, one.link): one for one in hypotheses_of(model)}
    slip = by_id["Coriolis terms of a joint missing", "joint_5", None]
    sign, degrees = by_id["sign of tau", None, None], by_id["degrees taken", None, None]
    mass = by_id["mass ignored", None, "link_3"]
    before = mass.apply(degrees.apply(Variant(model), ()), ())
    given, altered = before.given(states), before.model
    wanted = -before.evaluate(states)["tau"]
    wanted[:, 4] += parts_of_tau(altered, given)["Coriolis terms"][:, 4]
    got = slip.apply(sign.apply(before, ()), ()).evaluate(states)["tau"]
    assert np.abs(got - wanted).max() < CLOSE * np.abs(wanted).max()
    assert np.abs(got + before.evaluate(states)["tau"]).max() > 1e-6 * np.abs(wanted).max()


def factor_at(robot: Robot, term: str, joint: int, factor: float) -> Callable[[Array, Array, Array], Array]:
    """A program that counts a term so many times, by `inverse_dynamics` alone."""
    heavy = Robot(robot.model.without_joint_effects())

    def program(q: Array, v: Array, a: Array) -> Array:
        nothing = np.zeros_like(v)
        if term == "gravity":
            own = heavy.inverse_dynamics(q, nothing, nothing).tau
        elif term == "inertial coupling":
            own = tau(robot, q, nothing, np.where(np.arange(robot.model.nv) == joint, 0.0, a))
        else:
            own = tau(robot, q, v, nothing)
            singles = np.sum([tau(robot, q, x * v, nothing) for x in np.eye(robot.model.nv)], axis=0)
            own = {"velocity terms": own, "centrifugal terms": singles, "Coriolis terms": own - singles}[term]
        result = robot.inverse_dynamics(q, v, a).tau.copy()
        result[..., joint] += (factor - 1.0) * own[..., joint]
        return result

    return program


@pytest.mark.one_in(6)
@pytest.mark.parametrize(
    ("name", "term", "slip", "joint"),
    [
        ("rttrr", "velocity terms", "doubled", 0),
        ("rttrr", "centrifugal terms", "missing", 3),
        ("rttrr", "Coriolis terms", "halved", 4),
        ("rttrr", "inertial coupling", "negated", 1),
        ("mimic and friction", "gravity", "halved", 0),
        ("mimic and friction", "velocity terms", "negated", 0),
    ],
)
def test_a_slip_in_one_term_of_one_joint_is_named(name: str, term: str, slip: str, joint: int) -> None:
    robot = robots()[name]
    factor = {one.id: one.factor for one in SLIPS}[slip]
    result = diagnose(robot, factor_at(robot, term, joint, factor), n_states=60)
    assert result.verdict == "explained", result.summary()
    (cause,) = result.causes
    assert (cause.hypothesis, cause.joint) == (f"{term} of a joint {slip}", robot.model.v_names[joint])
