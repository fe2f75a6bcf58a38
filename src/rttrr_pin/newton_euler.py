"""The specification: Newton-Euler iterations outwards and inwards, written once, over scalars of any kind.

Source: Detesan, "The dynamic model of RTTRR serial robot - Iterations outwards and inwards the robot's mechanical
structure", Acta Technica Napocensis (the paper); Craig, "Introduction to Robotics", section 6.5, for the general
form. Equation numbers are the paper's; what a line yields for the RTTRR arm is said beside it.

Nothing here asks what its scalars are: the same lines run on floats, on arrays (one batch in each scalar), on
(value, bound) pairs, on balls, on symbols. It never divides, compares or takes a root.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from rttrr_pin.algebra import IDENTITY, ZERO, Matrix, Scalar, Vector
from rttrr_pin.model import JointType

SinCos = Callable[[Scalar], tuple[Scalar, Scalar]]


@dataclass(frozen=True, slots=True)
class Body:
    """Link i and the joint that carries it; the numbers are scalars of one kind.

    Attributes:
        parent: index of the parent link, -1 for the root.
        type: how the joint moves.
        axis: unit vector of the joint, in {i}.
        R: R_parent_i at coordinate zero.
        p: p_parent_i at coordinate zero, in the parent frame [m].
        M: mass [kg].
        r_C: from the origin of {i} to the centre of mass, in {i} [m]; equations (1), (2).
        I: inertia tensor about the centre of mass, in {i} [kg m^2]; equations (3)-(7).
    """

    parent: int
    type: JointType
    axis: Vector
    R: Matrix
    p: Vector
    M: Scalar
    r_C: Vector
    I: Matrix


@dataclass(frozen=True, slots=True)
class Payload:
    """f_tool, n_tool at the origin of a link's frame, equation (8): what the robot exerts on its surroundings.

    Attributes:
        link: index of the link.
        f: force [N].
        n: moment about the origin of the link's frame [N m].
        in_base: whether f and n are given in base axes; else in the link's.
    """

    link: int
    f: Vector
    n: Vector
    in_base: bool = False


@dataclass(frozen=True, slots=True)
class JointMotion:
    """How {i} moves against its parent: placement now, and rates of the joint alone, in {i}."""

    R: Matrix
    p: Vector
    w: Vector = ZERO
    w_dot: Vector = ZERO
    v: Vector = ZERO
    v_dot: Vector = ZERO


@dataclass(frozen=True, slots=True)
class Wrenches:
    """tau for each degree of freedom; F, N, f, n for each link, in {i}."""

    tau: list[Scalar]
    F: list[Vector]
    N: list[Vector]
    f: list[Vector]
    n: list[Vector]


def rotation(axis: Vector, q: Scalar, sincos: SinCos) -> Matrix:
    """The rotation by q about a unit axis u: u u^T + cos q (1 - u u^T) + sin q [u]x (Rodrigues)."""
    s, c = sincos(q)
    along = Matrix.outer(axis, axis)
    across = IDENTITY - along
    turned: Matrix = along + across * c + Matrix.skew(axis) * s
    return turned


def joint_motion(body: Body, q: Scalar, v: Scalar, a: Scalar, sincos: SinCos) -> JointMotion:
    """What the joint's coordinate q, rate v and acceleration a do to {i}."""
    u = body.axis
    if body.type.rotates:
        return JointMotion(R=body.R @ rotation(u, q, sincos), p=body.p, w=u * v, w_dot=u * a)
    if body.type is JointType.PRISMATIC:
        return JointMotion(R=body.R, p=body.p + body.R @ (u * q), v=u * v, v_dot=u * a)
    return JointMotion(R=body.R, p=body.p)


def newton_euler(
    bodies: Sequence[Body],
    q: Sequence[Scalar],
    v: Sequence[Scalar],
    a: Sequence[Scalar],
    gravity: Vector,
    payloads: Sequence[Payload],
    sincos: SinCos,
) -> Wrenches:
    """Inverse dynamics of a tree: tau, and the forces and moments on every link.

    Args:
        bodies: the links with their joints, parents before children.
        q: coordinates of the moving joints, in the order of the bodies [rad or m].
        v: their rates.
        a: their accelerations.
        gravity: the gravity field in the base frame [m/s^2].
        payloads: what the robot exerts on its surroundings.
        sincos: sine and cosine for this kind of scalar.

    Returns:
        tau, and F, N, f, n of each link in its own frame.
    """
    joints = _joint_motions(bodies, q, v, a, sincos)
    w: list[Vector] = []
    w_dot: list[Vector] = []
    v_dot: list[Vector] = []
    F: list[Vector] = []
    N: list[Vector] = []

    # Iterations outwards
    for body, joint in zip(bodies, joints, strict=True):
        i = body.parent
        R, p = joint.R, joint.p
        w_i, w_dot_i, v_dot_i = (w[i], w_dot[i], v_dot[i]) if i >= 0 else (ZERO, ZERO, -gravity)
        carried = R.T @ w_i  # the parent's angular velocity, in the link's frame
        w.append(carried + joint.w)
        w_dot.append(R.T @ w_dot_i + carried.cross(joint.w) + joint.w_dot)
        v_dot.append(
            R.T @ (w_dot_i.cross(p) + w_i.cross(w_i.cross(p)) + v_dot_i) + carried.cross(joint.v) * 2 + joint.v_dot
        )
        r_C = body.r_C
        v_dot_C = w_dot[-1].cross(r_C) + w[-1].cross(w[-1].cross(r_C)) + v_dot[-1]  # (9)-(15)
        F.append(v_dot_C * body.M)  # (16)-(22)
        N.append(body.I @ w_dot[-1] + w[-1].cross(body.I @ w[-1]))  # (23)-(30)

    # Iterations inwards
    f = [ZERO] * len(bodies)  # until link i is reached, f[i] and n[i] gather what it must pass on
    n = [ZERO] * len(bodies)
    for payload in payloads:  # (8)
        f[payload.link] += _in_link_frame(payload.f, payload, bodies, joints)
        n[payload.link] += _in_link_frame(payload.n, payload, bodies, joints)
    tau: list[Scalar] = []
    for i in reversed(range(len(bodies))):
        body, joint = bodies[i], joints[i]
        f[i] = F[i] + f[i]  # (31)-(43)
        n[i] = N[i] + n[i] + body.r_C.cross(F[i])  # the moments that the paper leaves out before (31)
        if body.type is not JointType.FIXED:
            tau.append(body.axis.dot(n[i] if body.type.rotates else f[i]))  # Qm_i; Qm_2 is (40)
        if body.parent >= 0:
            R_f = joint.R @ f[i]
            f[body.parent] += R_f
            n[body.parent] += joint.R @ n[i] + joint.p.cross(R_f)
    return Wrenches(tau[::-1], F, N, f, n)


def _joint_motions(
    bodies: Sequence[Body], q: Sequence[Scalar], v: Sequence[Scalar], a: Sequence[Scalar], sincos: SinCos
) -> list[JointMotion]:
    """The motion of each joint; a fixed one takes no coordinate."""
    coordinates = zip(q, v, a, strict=True)
    motions = []
    for body in bodies:
        q_i, v_i, a_i = (0, 0, 0) if body.type is JointType.FIXED else next(coordinates)
        motions.append(joint_motion(body, q_i, v_i, a_i, sincos))
    return motions


def _in_link_frame(vector: Vector, payload: Payload, bodies: Sequence[Body], joints: Sequence[JointMotion]) -> Vector:
    """A vector of a payload, turned from base axes to the link's where need be."""
    if not payload.in_base:
        return vector
    path = []
    i = payload.link
    while i >= 0:
        path.append(i)
        i = bodies[i].parent
    for i in reversed(path):
        vector = joints[i].R.T @ vector
    return vector
