"""The reference recursion: Newton-Euler iterations outwards and inwards, written once, over scalars of any kind.

Source: Detesan, "The dynamic model of RTTRR serial robot - Iterations outwards and inwards the robot's mechanical
structure", Acta Technica Napocensis (the paper); Craig, "Introduction to Robotics", section 6.5, for the general
form. Equation numbers are the paper's; what a line yields for the RTTRR arm is said beside it.

The same lines run on floats, arrays (one batch in each scalar), values with error bounds, intervals, dual numbers and
polynomials. Nothing here asks what its scalars are, and nothing divides, compares or takes a root.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from rttrr_pin.core.algebra import ZERO, Matrix, Scalar, SinCos, Vector
from rttrr_pin.core.joints.base import Body, JointMotion, JointState

Keep = Callable[[Vector], Vector]
Call = Callable[..., Any]


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


@dataclass(frozen=True, slots=True)
class LinkMotion:
    """How link i moves, in {i}.

    Attributes:
        w: angular velocity [rad/s].
        w_dot: angular acceleration [rad/s^2].
        v_dot: acceleration of the origin of {i}, gravity included [m/s^2].
    """

    w: Vector
    w_dot: Vector
    v_dot: Vector


def newton_euler(
    bodies: Sequence[Body],
    parents: Sequence[int],
    states: Sequence[JointState],
    gravity: Vector,
    payloads: Sequence[Payload],
    sincos: SinCos,
    keep: Keep = lambda x: x,
    call: Call = lambda step, *arguments: step(*arguments),
) -> Wrenches:
    """Inverse dynamics of a tree: the forces and moments on every link, and what drives every joint.

    Args:
        bodies: the links with their joints, parents before children.
        parents: index of the parent of each link, -1 for the root.
        states: coordinates, rates and accelerations of each joint.
        gravity: the gravity field in the base frame [m/s^2].
        payloads: what the robot exerts on its surroundings.
        sincos: sine and cosine for this kind of scalar.
        keep: gets each w, w_dot, v_dot, F, N, f, n once complete, and returns what is used in its place from there on.
        call: runs each step on a link; a compiler may compile equal steps once.

    Returns:
        F, N, f, n of each link in its own frame, and tau of each joint.
    """
    base = LinkMotion(ZERO, ZERO, -gravity)  # the base accelerates upwards, equation (9)
    joints: list[JointMotion] = []
    motions: list[LinkMotion] = []
    F: list[Vector] = []
    N: list[Vector] = []

    # Iterations outwards
    for body, parent, state in zip(bodies, parents, states, strict=True):
        joint, motion, F_i, N_i = call(outwards, body, state, motions[parent] if parent >= 0 else base, sincos, keep)
        joints.append(joint)
        motions.append(motion)
        F.append(F_i)
        N.append(N_i)

    # Iterations inwards
    f = [ZERO] * len(bodies)  # until link i is reached, f[i] and n[i] gather what it must pass on
    n = [ZERO] * len(bodies)
    for payload in payloads:  # (8)
        f[payload.link] += _in_link_frame(payload.f, payload, parents, joints, call)
        n[payload.link] += _in_link_frame(payload.n, payload, parents, joints, call)
    tau: list[list[Scalar]] = [[] for _ in bodies]
    for i in reversed(range(len(bodies))):
        f[i], n[i], tau[i], R_f, R_n = call(inwards, bodies[i], joints[i], F[i], N[i], f[i], n[i], keep)
        if parents[i] >= 0:
            f[parents[i]] += R_f
            n[parents[i]] += R_n
    return Wrenches(tau, F, N, f, n)


def outwards(
    body: Body, state: JointState, parent: LinkMotion, sincos: SinCos, keep: Keep
) -> tuple[JointMotion, LinkMotion, Vector, Vector]:
    """A step outwards: from the motion of the parent to that of link i, and to F_i, N_i."""
    joint = body.type.motion(body, state, sincos)
    R, p, r_C = joint.R, joint.p, body.r_C
    w_p, w_dot_p, v_dot_p = parent.w, parent.w_dot, parent.v_dot
    carried = R.T @ w_p  # the parent's angular velocity, in the link's frame
    w = keep(carried + joint.w)
    w_dot = keep(R.T @ w_dot_p + carried.cross(joint.w) + joint.w_dot)
    v_dot = keep(
        R.T @ (w_dot_p.cross(p) + w_p.cross(w_p.cross(p)) + v_dot_p)
        + carried.cross(joint.v) * 2
        + joint.w.cross(joint.v)  # of joints that turn and slide at once
        + joint.v_dot
    )
    v_dot_C = w_dot.cross(r_C) + w.cross(w.cross(r_C)) + v_dot  # (9)-(15)
    F = keep(v_dot_C * body.M)  # (16)-(22)
    N = keep(body.I @ w_dot + w.cross(body.I @ w))  # (23)-(30)
    return joint, LinkMotion(w, w_dot, v_dot), F, N


def inwards(
    body: Body, joint: JointMotion, F: Vector, N: Vector, f_on: Vector, n_on: Vector, keep: Keep
) -> tuple[Vector, Vector, list[Scalar], Vector, Vector]:
    """A step inwards: from what link i must pass on to f_i, n_i and tau_i, and to their f, n at the parent's origin."""
    f = keep(F + f_on)  # (31)-(43)
    n = keep(N + n_on + body.r_C.cross(F))  # the moments that the paper leaves out before (31)
    tau = body.type.driving_force(body, f, n)  # Qm_i; Qm_2 is (40)
    R_f = joint.R @ f
    return f, n, tau, R_f, joint.R @ n + joint.p.cross(R_f)


def _in_link_frame(
    vector: Vector, payload: Payload, parents: Sequence[int], joints: Sequence[JointMotion], call: Call
) -> Vector:
    """A vector of a payload, turned from base axes to the link's where need be."""
    if not payload.in_base:
        return vector
    path = []
    i = payload.link
    while i >= 0:
        path.append(i)
        i = parents[i]
    for i in reversed(path):
        vector = call(Matrix.__matmul__, joints[i].R.T, vector)
    return vector
