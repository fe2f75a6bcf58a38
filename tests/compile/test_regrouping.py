"""Base-parameter regrouping leaves the driving forces as they are, whatever the masses: negative, zero, or far apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rttrr_pin import Robot
from rttrr_pin.compile.regrouping import regroup
from rttrr_pin.core.algebra import Vector
from rttrr_pin.core.dynamics import bodies, dynamics
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints import CONTINUOUS, FIXED, FLOATING, PLANAR, PRISMATIC, REVOLUTE
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.scalars import FLOAT
from rttrr_pin.exact.rounding import bounded_dynamics
from rttrr_pin.validation import Sampler
from support.bodies import random_joint, random_link

TYPES = (REVOLUTE, CONTINUOUS, PRISMATIC, PLANAR, FLOATING, FIXED)

MUCH = 100.0
"""Times the bound of the reference recursion: centres of mass far from the axis that they move to cost some digits."""


def tree(seed: int, decades: float) -> Model:
    """Links of masses of any sign over so many decades, some without mass, some centred on their axes."""
    rng = np.random.default_rng(seed)
    joints, links = [], []
    for i in range(int(rng.integers(1, 9))):
        joint = random_joint(rng, f"joint_{i}", TYPES[rng.choice(6, p=(0.35, 0.1, 0.15, 0.05, 0.05, 0.3))], -1)
        joint = replace(joint, parent=int(rng.integers(-1, i)) if i else -1)
        if joint.type.has_axis and rng.random() < 0.4:
            joint = replace(joint, axis=np.eye(3)[rng.integers(3)], R=np.eye(3))
        mass = rng.choice([-1.0, 0.0, 1.0, 1.0]) * 10.0 ** rng.uniform(-decades / 2, decades / 2)
        link = random_link(rng, f"link_{i}", mass)
        if rng.random() < 0.3:
            link = replace(link, com=joint.axis * rng.integers(-2, 3))
        joints.append(joint)
        links.append(link)
    return Model("signs", Link("base"), tuple(links), tuple(joints))


def check(model: Model, seed: int = 0) -> None:
    """The regrouped robot needs the same driving forces, to a few times what rounding may do to the reference."""
    state = Sampler(model, seed=seed).draw(0, 8)
    expected, bounds = bounded_dynamics(model, state.q, state.v, state.a)
    regrouped, links = regroup(model, bodies(model, FLOAT))
    columns = [list(x.T) for x in (state.q, state.v, state.a)]
    tau = dynamics(regrouped, FLOAT, *columns, links=links).tau
    for k, force in enumerate(tau):
        assert np.all(np.abs(force - expected.tau[:, k]) <= MUCH * bounds.tau[:, k])


@pytest.mark.one_in(4)
@pytest.mark.parametrize("part", range(3))
@pytest.mark.parametrize("decades", [0, 6, 60])
def test_driving_forces_stay_for_masses_of_any_sign_and_size(decades: float, part: int) -> None:
    for seed in range(50 * part, 50 * part + 50):
        check(tree(seed, decades), seed)


@pytest.mark.parametrize("seed", range(6))
def test_bounds_hold_for_masses_of_any_sign(seed: int) -> None:
    """What moving inertia rounds counts in the kernel's bounds."""
    model = tree(seed, 6)
    state = Sampler(model, seed=seed).draw(0, 8)
    expected, bounds = bounded_dynamics(model, state.q, state.v, state.a)
    out = Robot(model).compile(("tau", "tau_bound"), emitter="numpy")(state.q, state.v, state.a)
    assert np.all(np.abs(out["tau"] - expected.tau) <= out["tau_bound"] + bounds.tau)


CANCELLING = {
    "a negative mass on a link without mass": (REVOLUTE, (0.0, -1.0)),
    "masses that add up to zero, fixed together": (FIXED, (1.0, -1.0)),
    "masses that nearly cancel, fixed together": (FIXED, (1.0, -1.0 + 2.0**-40)),
    "a heavy link on a light one": (REVOLUTE, (2.0**-60, 1.0)),
    "masses that add up to zero, on one axis": (REVOLUTE, (1.0, -1.0)),
}


@pytest.mark.parametrize("case", CANCELLING)
def test_masses_that_cancel_lose_no_first_moment(case: str) -> None:
    joint_type, masses = CANCELLING[case]
    rng = np.random.default_rng(1)
    joints = [random_joint(rng, "joint_0", REVOLUTE, -1), random_joint(rng, "joint_1", joint_type, 0)]
    links = [random_link(rng, f"link_{i}", mass) for i, mass in enumerate(masses)]
    if "axis" in case:
        joints[1] = replace(joints[1], axis=np.array([0.0, 0.0, 1.0]))
        links[1] = replace(links[1], com=np.array([0.0, 0.0, 0.25]))
    check(Model("cancelling", Link("base"), tuple(links), tuple(joints)))


def test_a_long_sum_of_masses_that_cancel_bit_by_bit_keeps_its_digits() -> None:
    """Each step leaves a sixteenth of the mass before it, and all together next to nothing."""
    rng = np.random.default_rng(2)
    masses = [1.0]
    for _ in range(10):
        masses.append(-sum(masses) * 15 / 16)
    joints = [random_joint(rng, "joint_0", REVOLUTE, -1)]
    joints += [random_joint(rng, f"joint_{i}", FIXED, 0) for i in range(1, len(masses))]
    links = tuple(random_link(rng, f"link_{i}", mass) for i, mass in enumerate(masses))
    check(Model("cancelling", Link("base"), links, tuple(joints)))


def test_a_link_fixed_to_another_is_one_body_with_it() -> None:
    rng = np.random.default_rng(3)
    joints = (random_joint(rng, "joint_0", REVOLUTE, -1), Joint("joint_1", FIXED, 0, p=np.array([0.5, 0.0, 0.0])))
    links = tuple(random_link(rng, f"link_{i}") for i in range(2))
    model = Model("fixed", Link("base"), links, joints)
    _, (_, fixed) = regroup(model, bodies(model, FLOAT))
    assert (fixed.M, *fixed.r_C) == (0.0, 0.0, 0.0, 0.0)
    assert all(row.dot(Vector(1, 1, 1)) == 0.0 for row in fixed.I.rows)
