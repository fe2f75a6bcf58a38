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

from rttrr_pin.algebra import ZERO, Scalar, Vector
from rttrr_pin.joint_motion import DRIVING_FORCE, MOTION, Body, JointMotion, JointState, SinCos


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
class Wrenches:
    """tau for each joint, one for each of its degrees of freedom; F, N, f, n for each link, in {i}."""

    tau: list[list[Scalar]]
    F: list[Vector]
    N: list[Vector]
    f: list[Vector]
    n: list[Vector]


def newton_euler(
    bodies: Sequence[Body],
    states: Sequence[JointState],
    gravity: Vector,
    payloads: Sequence[Payload],
    sincos: SinCos,
    keep: Callable[[Vector], Vector] = lambda x: x,
) -> Wrenches:
    """Inverse dynamics of a tree: the forces and moments on every link, and what drives every joint.

    Args:
        bodies: the links with their joints, parents before children.
        states: coordinates, rates and accelerations of each joint.
        gravity: the gravity field in the base frame [m/s^2].
        payloads: what the robot exerts on its surroundings.
        sincos: sine and cosine for this kind of scalar.
        keep: is shown each w, w_dot, v_dot, F, N, f, n once complete, and returns what stands for it from there on.

    Returns:
        F, N, f, n of each link in its own frame, and tau of each joint.
    """
    joints = [MOTION[body.type](body, state, sincos) for body, state in zip(bodies, states, strict=True)]
    w: list[Vector] = []
    w_dot: list[Vector] = []
    v_dot: list[Vector] = []
    F: list[Vector] = []
    N: list[Vector] = []

    # Iterations outwards
    for body, joint in zip(bodies, joints, strict=True):
        R, p, i = joint.R, joint.p, body.parent
        w_p, w_dot_p, v_dot_p = (w[i], w_dot[i], v_dot[i]) if i >= 0 else (ZERO, ZERO, -gravity)
        carried = R.T @ w_p  # the parent's angular velocity, in the link's frame
        w.append(keep(carried + joint.w))
        w_dot.append(keep(R.T @ w_dot_p + carried.cross(joint.w) + joint.w_dot))
        v_dot_0 = (
            R.T @ (w_dot_p.cross(p) + w_p.cross(w_p.cross(p)) + v_dot_p)
            + carried.cross(joint.v) * 2
            + joint.w.cross(joint.v)  # of joints that turn and slide at once
            + joint.v_dot
        )
        v_dot.append(keep(v_dot_0))
        r_C = body.r_C
        v_dot_C = w_dot[-1].cross(r_C) + w[-1].cross(w[-1].cross(r_C)) + v_dot[-1]  # (9)-(15)
        F.append(keep(v_dot_C * body.M))  # (16)-(22)
        N.append(keep(body.I @ w_dot[-1] + w[-1].cross(body.I @ w[-1])))  # (23)-(30)

    # Iterations inwards
    f = [ZERO] * len(bodies)  # until link i is reached, f[i] and n[i] gather what it must pass on
    n = [ZERO] * len(bodies)
    for payload in payloads:  # (8)
        f[payload.link] += _in_link_frame(payload.f, payload, bodies, joints)
        n[payload.link] += _in_link_frame(payload.n, payload, bodies, joints)
    tau: list[list[Scalar]] = [[] for _ in bodies]
    for i in reversed(range(len(bodies))):
        body, joint = bodies[i], joints[i]
        f[i] = keep(F[i] + f[i])  # (31)-(43)
        n[i] = keep(N[i] + n[i] + body.r_C.cross(F[i]))  # the moments that the paper leaves out before (31)
        tau[i] = DRIVING_FORCE[body.type](body, f[i], n[i])  # Qm_i; Qm_2 is (40)
        if body.parent >= 0:
            R_f = joint.R @ f[i]
            f[body.parent] += R_f
            n[body.parent] += joint.R @ n[i] + joint.p.cross(R_f)
    return Wrenches(tau, F, N, f, n)


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
