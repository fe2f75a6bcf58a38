"""Hypotheses on where joints are and how they point: what a program may make of <origin> and <axis>."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints import FIXED
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.catalogue.altering import differs, line_of, moving_axes, named, opposite_angles, with_joints
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Variant

Placed = Callable[[Joint], Joint]


@dataclass(frozen=True, slots=True)
class JointSlip:
    """A known slip at `{joint}`; `everywhere` where it may be made at every joint at once."""

    id: str
    sentence: str
    repair: str
    placed: Placed
    everywhere: bool = True


def placements(model: Model) -> Iterator[Hypothesis]:
    """All hypotheses on placements and axes; those that change no number of the robot are left out."""
    still = _on_still_links(model)
    for slip in SLIPS:
        changed = tuple(i for i, joint in enumerate(model.joints) if _changes(joint, slip.placed(joint), i in still))
        for i in changed:
            yield _hypothesis(model, slip, (i,))
        if slip.everywhere and len(changed) > 1:
            yield _hypothesis(model, slip, changed)
        fixed = tuple(i for i in changed if model.joints[i].type is FIXED)
        if slip.everywhere and 1 < len(fixed) < len(changed):
            yield _hypothesis(model, slip, fixed, "every fixed joint")


def _changes(joint: Joint, other: Joint, still: bool) -> bool:
    """Whether the joint is another: where its parent stands still, its place does not count."""
    if other is joint:
        return False
    axis = joint.type.has_axis and differs(joint.axis, other.axis)
    return axis or differs(joint.R, other.R) or (not still and differs(joint.p, other.p))


def _on_still_links(model: Model) -> set[int]:
    """Joints whose parent is the root, or fixed to it."""
    found, fixed = set[int](), {-1}
    for i, joint in enumerate(model.joints):
        if joint.parent in fixed:
            found.add(i)
            if joint.type is FIXED:
                fixed.add(i)
    return found


def _hypothesis(model: Model, slip: JointSlip, indices: tuple[int, ...], every: str = "every joint") -> Hypothesis:
    joint, label = named(model, indices, every)
    return Hypothesis(
        id=slip.id + ("" if joint else f" at {every}"),
        kind="parameters",
        sentence=slip.sentence.format(joint=label),
        repair=slip.repair.format(joint=label),
        apply=partial(_apply, placed=slip.placed, indices=indices),
        joint=joint,
        line=line_of(model, joint=joint),
    )


def _apply(variant: Variant, x: Sequence[float], placed: Placed, indices: tuple[int, ...]) -> Variant:
    return with_joints(variant, indices, placed)


def _turned(joint: Joint) -> bool:
    return not np.array_equal(joint.R, np.eye(3))


def _R(change: Callable[[Array], Array]) -> Placed:
    return lambda joint: replace(joint, R=change(joint.R), rotated=True) if _turned(joint) else joint


def _p(change: Callable[[Joint], Array]) -> Placed:
    return lambda joint: replace(joint, p=change(joint)) if joint.p.any() else joint


def _axis_of_parent(joint: Joint) -> Joint:
    """The axis as a vector of the parent's frame: in {i} it is R^T axis."""
    axis = joint.R.T @ joint.axis
    return replace(joint, axis=axis / np.linalg.norm(axis)) if joint.type.has_axis else joint


def _axis(k: int) -> Placed:
    """A coordinate axis."""
    return lambda joint: replace(joint, axis=np.eye(3)[k]) if joint.type.has_axis else joint


def _opposite_follower(joint: Joint) -> Joint:
    """Of a joint that moves by itself this is a convention, the direction of its coordinate."""
    return replace(joint, axis=-joint.axis) if joint.mimic is not None and joint.type.has_axis else joint


SLIPS = (
    JointSlip(
        "origin rpy ignored", "{joint} is not turned by the rpy of its <origin>", "turn {joint} by its rpy",
        _R(lambda R: np.eye(3)),
    ),
    JointSlip(
        "origin rpy transposed", "{joint} is turned by R^T, R of its <origin>",
        "R maps vectors of the frame of {joint} to that of its parent", _R(lambda R: R.T),
    ),
    JointSlip(
        "origin rpy about moving axes", "the rpy of {joint} turns about moving axes x, y, z: R_x R_y R_z",
        "turn {joint} about fixed axes: R = R_z(yaw) R_y(pitch) R_x(roll)", _R(moving_axes),
    ),
    JointSlip(
        "origin rpy of opposite sign", "the angles of the <origin> of {joint} have the opposite sign",
        "negate the rpy of {joint}", _R(opposite_angles),
    ),
    JointSlip(
        "origin xyz ignored", "{joint} stands at the origin of its parent's frame", "move {joint} by its xyz",
        _p(lambda joint: np.zeros(3)),
    ),
    JointSlip(
        "origin xyz negated", "the xyz of {joint} has the opposite sign", "negate the xyz of {joint}",
        _p(lambda joint: -joint.p),
    ),
    JointSlip(
        "origin xyz after rpy", "{joint} is moved by its xyz in its own axes, after it is turned",
        "the xyz of {joint} is a vector of its parent's frame", _p(lambda joint: joint.R @ joint.p),
    ),
    JointSlip(
        "origin xyz in the axes of the joint", "the xyz of {joint} is turned by R^T",
        "the xyz of {joint} is a vector of its parent's frame", _p(lambda joint: joint.R.T @ joint.p),
    ),
    JointSlip(
        "origin xyz in mm", "the xyz of {joint} is a thousand times as long", "give the xyz of {joint} in m",
        _p(lambda joint: 1e3 * joint.p),
    ),
    JointSlip(
        "origin ignored", "{joint} stands at its parent's origin, not turned", "place {joint} by its <origin>",
        lambda joint: replace(joint, R=np.eye(3), p=np.zeros(3)) if joint.p.any() and _turned(joint) else joint,
    ),
    JointSlip(
        "axis in the parent's frame", "the axis of {joint} is taken as a vector of its parent's frame",
        "the axis of {joint} is a vector of its own frame", _axis_of_parent,
    ),
    *(
        JointSlip(
            f"axis along {'xyz'[k]}", f"{{joint}} turns about or slides along {'xyz'[k]} of its frame",
            "use the <axis> of {joint}", _axis(k),
        )
        for k in (2, 0, 1)
    ),
    JointSlip(
        "axis of a follower negated", "the axis of {joint} has the opposite sign", "negate the axis of {joint}",
        _opposite_follower, everywhere=False,
    ),
)  # fmt: skip
