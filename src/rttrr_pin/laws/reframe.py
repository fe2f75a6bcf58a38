"""One robot with other link frames.

A frame may be rotated at will where the joint's axis can be written in the new axes, and moved along what the joint
leaves alone: anywhere on a prismatic or fixed joint, along the axis of a revolute one. Planar and floating joints keep
theirs, since their rates are components in {i}.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from rttrr_pin.core.algebra import IDENTITY, ZERO, Matrix, Vector
from rttrr_pin.core.dynamics import Result
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.laws.case import Case


@dataclass(frozen=True, slots=True)
class Frame:
    """A new frame of link i: R maps its vectors to {i}; p is where its origin is, in {i} [m]."""

    R: Matrix
    p: Vector


def reframing(case: Case, turn: Matrix) -> list[Frame]:
    """A new frame for each link, rotated by `turn`, and moved where the joint allows it."""
    offset = Vector.of((0.25, -0.5, 0.125), lambda value: case.arithmetic.number(value, 0.0))
    frames = []
    for body in case.links:
        shift = body.type.origin_shift(body.axis, offset)
        frames.append(Frame(IDENTITY, ZERO) if shift is None else Frame(turn, shift))
    return frames


def reframed(case: Case, frames: Sequence[Frame]) -> Result:
    """The results of the recursion in the new frames, about their origins and in their axes.

    With S, o the frame of the link and P, c that of its parent:

        R' = P^T R S,   p' = P^T (p + R o - c),   u' = S^T u,   r_C' = S^T (r_C - o),   I' = S^T I S
    """
    base = Frame(IDENTITY, ZERO)
    links = []
    for joint, body, frame in zip(case.model.joints, case.links, frames, strict=True):
        links.append(_moved(body, frame, frames[joint.parent] if joint.parent >= 0 else base))
    return case.forces(links=links, payloads=[_payload(case, x, frames[x.link]) for x in case.payloads])


def _moved(body: Body, frame: Frame, parent: Frame) -> Body:
    back, S, o = parent.R.T, frame.R, frame.p
    return replace(
        body,
        R=back @ body.R @ S,
        p=back @ (body.p + body.R @ o - parent.p),
        axis=S.T @ body.axis,
        r_C=S.T @ (body.r_C - o),
        I=S.T @ body.I @ S,
    )


def _payload(case: Case, payload: Payload, frame: Frame) -> Payload:
    """The payload about the new origin, in base axes or those of the new frame as it was."""
    if payload.in_base:
        arm = case.placed[payload.link].R @ frame.p
        return replace(payload, n=payload.n - arm.cross(payload.f))
    moment = payload.n - frame.p.cross(payload.f)
    return replace(payload, f=frame.R.T @ payload.f, n=frame.R.T @ moment)
