"""Every joint type keeps what `JointType` promises; a new one is a class, and one line in `JOINT_TYPES`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np
import pytest

from rttrr_pin import JointEffects, Robot
from rttrr_pin.compile.regrouping import regroup
from rttrr_pin.core.algebra import Matrix, Scalar, SinCos, Vector, rotation
from rttrr_pin.core.dual import Dual, part_of, value_of
from rttrr_pin.core.dynamics import bodies, dynamics
from rttrr_pin.core.joint import Joint, Mimic
from rttrr_pin.core.joints import JOINT_TYPES, PRISMATIC, REVOLUTE, JointType
from rttrr_pin.core.joints.base import Body, Coordinate, JointMotion, JointState
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.scalars import FLOAT
from rttrr_pin.core.tangent import TIME, over_duals, tangent
from rttrr_pin.exact.rounding import bounded_dynamics
from rttrr_pin.implementations import default_allowance
from rttrr_pin.laws import check_laws
from rttrr_pin.validation import Sampler
from support.bodies import random_joint, random_link
from support.implementations import evaluated


@dataclass(frozen=True)
class Helical(JointType):
    """A screw: a turn by q about the axis u, with a slide along it of `pitch` for each turn.

    Attributes:
        pitch: length of one turn [m].
    """

    pitch: float

    name = "helical"
    coordinates = rates = (Coordinate("rad"),)
    has_axis = True

    @property
    def parameters(self) -> tuple[float, ...]:
        """The slide for each radian, h [m/rad]."""
        return (self.pitch / (2 * pi),)

    def motion(self, body: Body, state: JointState, sincos: SinCos) -> JointMotion:
        """R = R_0 R(u, q), p = p_0 + R_0 u h q, w = u v, v = u h v."""
        u, (h,), (q,), (v,), (a,) = body.axis, body.parameters, state.q, state.v, state.a
        return JointMotion(
            R=body.R @ rotation(u, q, sincos),
            p=body.p + body.R @ (u * (q * h)),
            w=u * v,
            w_dot=u * a,
            v=u * (v * h),
            v_dot=u * (a * h),
        )

    def driving_force(self, body: Body, f: Vector, n: Vector) -> list[Scalar]:
        """The moment about the axis, and h times the force along it."""
        (h,) = body.parameters
        return [body.axis.dot(n) + body.axis.dot(f) * h]


HELICAL = Helical(0.75)

TYPES = (*JOINT_TYPES.values(), HELICAL)

MOVING = [joint_type for joint_type in TYPES if joint_type.nv]


def chain(*types: JointType, seed: int = 0) -> Robot:
    """A robot of these joints, one behind the other, about random axes, with massive links."""
    rng = np.random.default_rng(seed)
    joints = tuple(random_joint(rng, f"joint_{i}", joint_type, i - 1) for i, joint_type in enumerate(types))
    links = tuple(random_link(rng, f"link_{i}") for i in range(len(types)))
    return Robot(Model("chain", Link("base"), links, joints))


def moved(joint_type: JointType, seed: int) -> tuple[Robot, Body, JointState, JointMotion]:
    """One joint at random, its state as duals along time, and the motion that follows."""
    robot = chain(joint_type, seed=seed)
    state = Sampler(robot.model, seed=seed).draw(0, 1)
    q, v, a = ([float(x) for x in y[0]] for y in (state.q, state.v, state.a))
    arithmetic = over_duals(FLOAT)
    coordinates = [
        Dual(x.value, {TIME: sum(part * v[k] for k, part in x.parts.items())})
        for x in tangent(robot.model.moving, q, FLOAT)
    ]
    joint_state = JointState(coordinates, [Dual(x, {TIME: y}) for x, y in zip(v, a, strict=True)], a)
    (body,) = bodies(robot.model, FLOAT)
    return robot, body, joint_state, joint_type.motion(body, joint_state, arithmetic.sincos)


def values(vector: Vector) -> np.ndarray:
    return np.array([float(value_of(x)) for x in vector])


def rates(vector: Vector) -> np.ndarray:
    return np.array([float(part_of(x, TIME)) for x in vector])


@pytest.mark.parametrize("joint_type", TYPES, ids=str)
def test_names_and_sizes(joint_type: JointType) -> None:
    for own in (joint_type.coordinates, joint_type.rates):
        names = [x.name for x in own]
        assert len(set(names)) == len(names)
        assert len(own) == 1 or all(names)
        assert all(x.unit in ("rad", "m", "") for x in own)
    assert len(joint_type.coordinates) == joint_type.nq >= joint_type.nv == len(joint_type.rates)
    assert joint_type.nq - joint_type.nv == len(joint_type.quaternions)
    assert all(rate.unit for rate in joint_type.rates)
    assert not (joint_type.has_axis and joint_type.axis_direction)
    assert str(joint_type) == joint_type.name


def test_the_registry_knows_every_type_by_its_own_name() -> None:
    assert all(name == joint_type.name for name, joint_type in JOINT_TYPES.items())
    assert len({*TYPES}) == len(TYPES)
    assert Helical(0.75) == HELICAL != Helical(0.5)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("joint_type", MOVING, ids=str)
def test_the_motion_is_what_its_derivatives_say(joint_type: JointType, seed: int) -> None:
    """R' = R [w]x, p' = R v, and w_dot, v_dot are the derivatives of the components of w, v."""
    _, _, _, motion = moved(joint_type, seed)
    R = np.array([values(row) for row in motion.R.rows])
    R_dot = np.array([rates(row) for row in motion.R.rows])
    skew = np.array([values(row) for row in Matrix.skew(motion.w).rows])
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(R_dot, R @ skew, atol=1e-13)
    np.testing.assert_allclose(rates(motion.p), R @ values(motion.v), atol=1e-13)
    np.testing.assert_allclose(rates(motion.w), values(motion.w_dot), atol=1e-13)
    np.testing.assert_allclose(rates(motion.v), values(motion.v_dot), atol=1e-13)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("joint_type", TYPES, ids=str)
def test_driving_forces_do_the_work_of_f_and_n(joint_type: JointType, seed: int) -> None:
    _, body, state, motion = moved(joint_type, seed)
    f, n = (Vector(*x) for x in np.random.default_rng(seed).normal(size=(2, 3)))
    driven = sum(tau * value_of(v) for tau, v in zip(joint_type.driving_force(body, f, n), state.v, strict=True))
    power = values(f) @ values(motion.v) + values(n) @ values(motion.w)
    np.testing.assert_allclose(driven, power, atol=1e-12)


@pytest.mark.parametrize("joint_type", MOVING, ids=str)
def test_states_are_drawn_within_limits_and_quaternions_have_length_one(joint_type: JointType) -> None:
    robot = chain(joint_type, seed=1)
    q = Sampler(robot.model, "mixed").draw(0, 300).q
    assert q.shape == (300, joint_type.nq)
    for at in robot.model.quaternions:
        np.testing.assert_allclose(np.linalg.norm(q[:, at : at + 4], axis=1), 1.0, atol=1e-15)
    for column, coordinate in zip(q.T, joint_type.coordinates, strict=True):
        assert np.abs(column).max() <= {"rad": pi, "m": 1.0, "": 1.0}[coordinate.unit]
    assert joint_type.coordinates_at(np.zeros((1, joint_type.nv))).sum() == len(joint_type.quaternions)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("joint_type", TYPES, ids=str)
def test_regrouped_inertia_drives_the_same_forces(joint_type: JointType, seed: int) -> None:
    model = chain(REVOLUTE, joint_type, PRISMATIC, joint_type, seed=seed).model
    regrouped, links = regroup(model, bodies(model, FLOAT))
    state = Sampler(model, seed=seed).draw(0, 20)
    columns = [list(x.T) for x in (state.q, state.v, state.a)]
    expected = dynamics(model, FLOAT, *columns).tau
    got = dynamics(regrouped, FLOAT, *columns, links=links).tau
    np.testing.assert_allclose(got, expected, rtol=0.0, atol=1e-11 * np.abs(expected).max())


@pytest.mark.one_in(6)
@pytest.mark.parametrize("joint_type", TYPES, ids=str)
def test_every_program_takes_the_type(joint_type: JointType) -> None:
    """The laws of mechanics, the compiled kernel, bounds, Lagrange's equations and derivatives, in a chain with it."""
    robot = chain(REVOLUTE, joint_type, joint_type, PRISMATIC, seed=2)
    moving = [joint.name for joint in robot.model.moving]
    robot = robot.with_joint_effects({name: JointEffects(0.5, 0.25, 0.125) for name in moving})
    state = Sampler(robot.model, "mixed").draw(0, 40)
    q, v, a = state.q, state.v, state.a
    expected, bounds = bounded_dynamics(robot.model, q, v, a)
    scale = np.abs(expected.tau).max()
    for tau in (robot.compile("tau")(q, v, a), evaluated("lagrange", robot.model, q, v, a).values["tau"]):
        np.testing.assert_allclose(tau, expected.tau, rtol=0.0, atol=1e-11 * scale)
    assert 0.0 < bounds.tau.max() < 1e-11 * scale
    assert [row.law.id for row in check_laws(robot, n_states=20).rows if not row.passed] == []
    M = robot.mass_matrix(q)
    np.testing.assert_allclose(M, M.swapaxes(1, 2), atol=1e-12 * np.abs(M).max())
    np.testing.assert_allclose(robot.derivatives(q, v, a)[2], M, atol=1e-12 * np.abs(M).max())


@pytest.mark.slow
def test_a_screw_is_a_turn_and_a_slide_that_follows_it() -> None:
    """An equal robot of known types: the slide follows the turn, and by virtual work its force counts h times."""
    screw = chain(REVOLUTE, HELICAL, PRISMATIC, seed=3).model
    first, helical, last = screw.joints
    slide = Joint("slide", PRISMATIC, 1, axis=helical.axis, mimic=Mimic(1, HELICAL.parameters[0]))
    pair = replace(
        screw,
        links=(screw.links[0], Link("frame"), *screw.links[1:]),
        joints=(first, replace(helical, type=REVOLUTE), slide, replace(last, parent=2)),
    )
    state = Sampler(screw).draw(0, 30)
    one, other = (Robot(model).inverse_dynamics(state.q, state.v, state.a) for model in (screw, pair))
    np.testing.assert_allclose(one.tau, other.tau, atol=1e-12 * np.abs(other.tau).max())
    np.testing.assert_allclose(one.n, other.n[:, [0, 2, 3]], atol=1e-12 * np.abs(other.n).max())


@pytest.mark.parametrize("joint_type", MOVING, ids=str)
def test_a_driving_force_is_allowed_what_it_is_made_of(joint_type: JointType) -> None:
    """By the sizes of f and n that enter it: a tenth of a running error bound and more, also of a screw of a long pitch."""
    for pitch in (1e-9, 1.0, 1e9):
        own = replace(joint_type, pitch=pitch) if isinstance(joint_type, Helical) else joint_type
        model = chain(REVOLUTE, own, PRISMATIC, seed=4).model
        batch = Sampler(model, "mixed").draw(0, 40)
        assert (10 * default_allowance(batch)["tau"] >= batch.recursion[1].tau).all()
