"""Where the coordinates and rates of each joint stand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rttrr_pin.core.model import Model


@dataclass(frozen=True, slots=True)
class Slots:
    """A joint that moves by itself.

    Attributes:
        name: of the joint.
        index: of the joint in `Model.joints`.
        q: its columns of q.
        v: its columns of v, a and tau.
        angles: those of `q` that are angles.
        turns: those of `v` that are rates of angles; the others are of lengths.
        quaternions: where in q its unit quaternions begin.
    """

    name: str
    index: int
    q: list[int]
    v: list[int]
    angles: list[int]
    turns: list[int]
    quaternions: list[int]


def slots(model: Model) -> list[Slots]:
    """Those of all joints, in the order of q."""
    found, q, v = [], 0, 0
    for i in model.independent:
        joint = model.joints[i]
        own_q, own_v = list(range(q, q + joint.nq)), list(range(v, v + joint.nv))
        angles = [k for k, own in zip(own_q, joint.type.coordinates, strict=True) if own.unit == "rad"]
        turns = [k for k, turning in zip(own_v, joint.type.rotations, strict=True) if turning]
        found.append(Slots(joint.name, i, own_q, own_v, angles, turns, [q + k for k in joint.type.quaternions]))
        q, v = q + joint.nq, v + joint.nv
    return found


def single(all_slots: Sequence[Slots]) -> list[Slots]:
    """Joints of one coordinate and one rate."""
    return [own for own in all_slots if len(own.q) == len(own.v) == 1]
