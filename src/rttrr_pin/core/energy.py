"""Energy, momentum and power of a robot in motion, over scalars of any kind.

From the kinematics of single joints (`JointType.motion`) alone. Accelerations and forces come from derivatives, by
duals, so what stands on this module shares with the Newton-Euler recursion only the motion of single joints, which is
checked by derivatives too (law K101).

Source: Goldstein, "Classical Mechanics", chapters 1 and 5; for twists as rates Kirchhoff's equations, Lamb,
"Hydrodynamics", article 124.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rttrr_pin.core.algebra import IDENTITY, ZERO, Matrix, Scalar, Vector
from rttrr_pin.core.dual import part_of, value_of
from rttrr_pin.core.dynamics import joint_states
from rttrr_pin.core.joints.base import Body, JointState
from rttrr_pin.core.model import Model
from rttrr_pin.core.scalars import Arithmetic
from rttrr_pin.core.tangent import TIME

if TYPE_CHECKING:
    from rttrr_pin.core.newton_euler import Payload


@dataclass(frozen=True, slots=True)
class LinkState:
    """Placement and velocity of link i.

    Attributes:
        R: R_0_i.
        p: p_0_i, in base axes [m].
        w: angular velocity, in {i} [rad/s].
        v: velocity of the origin of {i}, in {i} [m/s].
    """

    R: Matrix
    p: Vector
    w: Vector
    v: Vector

    def velocity_of(self, r: Vector) -> Vector:
        """Velocity of the point of the link at r, v + w x r; both in {i}."""
        return self.v + self.w.cross(r)

    def position_of(self, r: Vector) -> Vector:
        """Position p + R r of the point of the link at r, from the base's origin in base axes."""
        return self.p + self.R @ r

    @property
    def now(self) -> LinkState:
        """The values of the duals."""
        a, b, c = (now(row) for row in self.R.rows)
        return LinkState(Matrix((a, b, c)), now(self.p), now(self.w), now(self.v))


def link_states(
    model: Model, links: Sequence[Body], states: Sequence[JointState], arithmetic: Arithmetic
) -> list[LinkState]:
    """Placement and velocity of each link, from the base outwards.

    R_0_i = R_0_p R,   p_0_i = p_0_p + R_0_p p,   w_i = R^T w_p + w,   v_i = R^T (v_p + w_p x p) + v

    with R, p, w, v of the joint against its parent p.
    """
    base = LinkState(IDENTITY, ZERO, ZERO, ZERO)
    moving: list[LinkState] = []
    for joint, body, state in zip(model.joints, links, states, strict=True):
        parent = moving[joint.parent] if joint.parent >= 0 else base
        motion = body.type.motion(body, state, arithmetic.sincos)
        R, p = motion.R, motion.p
        moving.append(
            LinkState(
                R=parent.R @ R,
                p=parent.p + parent.R @ p,
                w=R.T @ parent.w + motion.w,
                v=R.T @ (parent.v + parent.w.cross(p)) + motion.v,
            )
        )
    return moving


def moving_links(
    model: Model, links: Sequence[Body], q: Sequence[Scalar], v: Sequence[Scalar], arithmetic: Arithmetic
) -> list[LinkState]:
    """Placement and velocity of each link, from coordinates and rates."""
    at_rest = [0] * len(v)
    return link_states(model, links, joint_states(model, arithmetic, q, v, at_rest), arithmetic)


def kinetic_energy(links: Sequence[Body], moving: Sequence[LinkState]) -> Scalar:
    """T = sum of (M v_C . v_C + w . I w) / 2 [J]."""
    total: Scalar = 0
    for body, link in zip(links, moving, strict=True):
        v_C = link.velocity_of(body.r_C)
        total = v_C.dot(v_C) * body.M + link.w.dot(body.I @ link.w) + total
    return total * 0.5


def potential_energy(links: Sequence[Body], moving: Sequence[LinkState], gravity: Vector) -> Scalar:
    """V = - sum of M g . p_C [J]; zero where the centre of mass is at the base's origin."""
    total: Scalar = 0
    for body, link in zip(links, moving, strict=True):
        total = gravity.dot(link.position_of(body.r_C)) * body.M + total
    return -total


def linear_momentum(body: Body, link: LinkState) -> Vector:
    """M v_C of one link, in base axes [kg m/s]."""
    return link.R @ (link.velocity_of(body.r_C) * body.M)


def spin(body: Body, link: LinkState) -> Vector:
    """I w of one link: its angular momentum about its centre of mass, in base axes [kg m^2/s]."""
    return link.R @ (body.I @ link.w)


def angular_momentum(body: Body, link: LinkState) -> Vector:
    """p_C x M v_C + I w of one link: about the base's origin, in base axes [kg m^2/s]."""
    return link.position_of(body.r_C).cross(linear_momentum(body, link)) + spin(body, link)


def in_base_axes(payload: Payload, link: LinkState) -> tuple[Vector, Vector]:
    """f_tool, n_tool at the origin of the link, in base axes [N, N m]."""
    if payload.in_base:
        return payload.f, payload.n
    return link.R @ payload.f, link.R @ payload.n


def payload_power(payloads: Sequence[Payload], moving: Sequence[LinkState]) -> Scalar:
    """Power of the robot on its surroundings: sum of f_tool . v + n_tool . w [W]."""
    total: Scalar = 0
    for payload in payloads:
        link = moving[payload.link]
        f, n = payload.f, payload.n
        if payload.in_base:
            f, n = link.R.T @ f, link.R.T @ n
        total = f.dot(link.v) + n.dot(link.w) + total
    return total


def joint_effects_power(
    model: Model, arithmetic: Arithmetic, states: Sequence[JointState], rates: Sequence[JointState]
) -> Scalar:
    """Power of armature, damping and friction: sum of (armature a + damping v + friction sign(v)) . rate [W].

    v and a are those of `states`; the forces work at `rates`: the same, or duals of them to get the force along each.
    """
    total: Scalar = 0
    for joint, state, at in zip(model.joints, states, rates, strict=True):
        effects = joint.effects
        coefficients = (effects.armature, effects.damping, effects.friction)
        for v, a, signed, rate in zip(state.v, state.a, state.signs_of or state.v, at.v, strict=True):
            for coefficient, factor in zip(coefficients, (a, v, arithmetic.sign(signed)), strict=True):
                if coefficient:
                    total = rate * (factor * arithmetic.number(coefficient, 0.0)) + total
    return total


def gyroscopic(model: Model, v: Sequence[Scalar], p: Sequence[Scalar]) -> list[Scalar]:
    """What turns with {i}: where rates are a twist (v, w) in {i}, its momenta (P, L) turn with the frame.

        force w x P,   moment w x L + v x P          (Kirchhoff)

    Zero for joints whose rates are derivatives of coordinates. p are the momenta that belong to the rates v.
    """
    out: list[Scalar] = []
    at = 0
    for joint in model.moving:
        own = slice(at, at + joint.nv)
        out += joint.type.gyroscopic(v[own], p[own])
        at += joint.nv
    return out


def rate_of(vector: Vector) -> Vector:
    """The time derivative of a vector of duals."""
    return Vector(*(part_of(x, TIME) for x in vector))


def now(vector: Vector) -> Vector:
    """The values of a vector of duals."""
    return Vector(*(value_of(x) for x in vector))
