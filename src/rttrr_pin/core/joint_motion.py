"""How {i} moves against its parent, joint by joint, and which components of f and n drive it.

Part of the specification: over scalars of any kind, as `newton_euler`. A joint type is one function here and one
line in each of the two tables.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from rttrr_pin.core.algebra import IDENTITY, ZERO, Matrix, Scalar, Vector
from rttrr_pin.core.joint import JointType

SinCos = Callable[[Scalar], tuple[Scalar, Scalar]]


@dataclass(frozen=True, slots=True)
class Body:
    """Link i and the joint that carries it; the numbers are scalars of one kind.

    Attributes:
        type: how the joint moves.
        axis: unit vector of the joint, in {i}.
        R: R_parent_i at coordinate zero.
        p: p_parent_i at coordinate zero, in the parent frame [m].
        M: mass [kg].
        r_C: from the origin of {i} to the centre of mass, in {i} [m]; equations (1), (2).
        I: inertia tensor about the centre of mass, in {i} [kg m^2]; equations (3)-(7).
    """

    type: JointType
    axis: Vector
    R: Matrix
    p: Vector
    M: Scalar
    r_C: Vector
    I: Matrix


@dataclass(frozen=True, slots=True)
class JointState:
    """Coordinates, rates and accelerations of one joint; a fixed one has none.

    Attributes:
        q: [rad, m]; of a floating joint x, y, z and a unit quaternion (x, y, z, w).
        v: rates; of a planar or floating joint the components, in {i}, of the twist against the parent.
        a: time derivatives of the components of v.
    """

    q: Sequence[Scalar]
    v: Sequence[Scalar]
    a: Sequence[Scalar]


@dataclass(frozen=True, slots=True)
class JointMotion:
    """Placement of {i} on its parent now, and the motion of the joint alone, in {i}.

    Attributes:
        R: R_parent_i.
        p: p_parent_i, in the parent frame [m].
        w: angular velocity of {i} against the parent [rad/s].
        w_dot: time derivative of the components of w [rad/s^2].
        v: velocity of the origin of {i} against the parent [m/s].
        v_dot: time derivative of the components of v [m/s^2].
    """

    R: Matrix
    p: Vector
    w: Vector = ZERO
    w_dot: Vector = ZERO
    v: Vector = ZERO
    v_dot: Vector = ZERO


def rotation(axis: Vector, q: Scalar, sincos: SinCos) -> Matrix:
    """The rotation by q about a unit axis u: u u^T + cos q (1 - u u^T) + sin q [u]x (Rodrigues)."""
    s, c = sincos(q)
    along = Matrix.outer(axis, axis)
    across = IDENTITY - along
    turned: Matrix = along + across * c + Matrix.skew(axis) * s
    return turned


def quaternion_rotation(x: Scalar, y: Scalar, z: Scalar, w: Scalar) -> Matrix:
    """The rotation of a unit quaternion with vector part (x, y, z) and real part w."""
    return Matrix(
        (
            Vector(1 - (y * y + z * z) * 2, (x * y - w * z) * 2, (x * z + w * y) * 2),
            Vector((x * y + w * z) * 2, 1 - (x * x + z * z) * 2, (y * z - w * x) * 2),
            Vector((x * z - w * y) * 2, (y * z + w * x) * 2, 1 - (x * x + y * y) * 2),
        )
    )


def _revolute(body: Body, state: JointState, sincos: SinCos) -> JointMotion:
    u, (q,), (v,), (a,) = body.axis, state.q, state.v, state.a
    return JointMotion(R=body.R @ rotation(u, q, sincos), p=body.p, w=u * v, w_dot=u * a)


def _prismatic(body: Body, state: JointState, sincos: SinCos) -> JointMotion:
    u, (q,), (v,), (a,) = body.axis, state.q, state.v, state.a
    return JointMotion(R=body.R, p=body.p + body.R @ (u * q), v=u * v, v_dot=u * a)


def _planar(body: Body, state: JointState, sincos: SinCos) -> JointMotion:
    (x, y, theta), (v_x, v_y, w_z), (a_x, a_y, w_dot_z) = state.q, state.v, state.a
    return JointMotion(
        R=body.R @ rotation(body.axis, theta, sincos),
        p=body.p + body.R @ Vector(x, y, 0),
        w=Vector(0, 0, w_z),
        w_dot=Vector(0, 0, w_dot_z),
        v=Vector(v_x, v_y, 0),
        v_dot=Vector(a_x, a_y, 0),
    )


def _floating(body: Body, state: JointState, sincos: SinCos) -> JointMotion:
    q, v, a = state.q, state.v, state.a
    return JointMotion(
        R=body.R @ quaternion_rotation(*q[3:]),
        p=body.p + body.R @ Vector(*q[:3]),
        w=Vector(*v[3:]),
        w_dot=Vector(*a[3:]),
        v=Vector(*v[:3]),
        v_dot=Vector(*a[:3]),
    )


def _fixed(body: Body, state: JointState, sincos: SinCos) -> JointMotion:
    return JointMotion(R=body.R, p=body.p)


MOTION: dict[JointType, Callable[[Body, JointState, SinCos], JointMotion]] = {
    JointType.REVOLUTE: _revolute,
    JointType.CONTINUOUS: _revolute,
    JointType.PRISMATIC: _prismatic,
    JointType.PLANAR: _planar,
    JointType.FLOATING: _floating,
    JointType.FIXED: _fixed,
}
"""What a joint's coordinates do to {i}."""

DRIVING_FORCE: dict[JointType, Callable[[Body, Vector, Vector], list[Scalar]]] = {
    JointType.REVOLUTE: lambda body, f, n: [body.axis.dot(n)],
    JointType.CONTINUOUS: lambda body, f, n: [body.axis.dot(n)],
    JointType.PRISMATIC: lambda body, f, n: [body.axis.dot(f)],
    JointType.PLANAR: lambda body, f, n: [f.x, f.y, n.z],
    JointType.FLOATING: lambda body, f, n: [*f, *n],
    JointType.FIXED: lambda body, f, n: [],
}
"""The components of f and n along the joint's degrees of freedom, in the order of its rates."""
