"""Hypotheses on joints that follow another."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from rttrr_pin.core.algebra import Vector
from rttrr_pin.core.dynamics import body_of, joint_effects, mimicked
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints.base import JointState
from rttrr_pin.core.model import Model
from rttrr_pin.core.scalars import FLOAT, columns
from rttrr_pin.diagnosis.altering import line_of, named, with_joints
from rttrr_pin.diagnosis.columns import added
from rttrr_pin.diagnosis.hypothesis import Hypothesis
from rttrr_pin.diagnosis.slots import slots
from rttrr_pin.diagnosis.variant import Values, Variant
from rttrr_pin.implementations.protocol import Batch

FOLLOWS = (
    (
        "mimic ignored", "{joint} stands still at 0, and its force is not passed on to the joint that it follows",
        "let {joint} follow, with multiplier and offset", {"multiplier": 0.0, "offset": 0.0},
    ),
    (
        "multiplier of mimic ignored", "{joint} follows with multiplier 1", "use the multiplier of {joint}",
        {"multiplier": 1.0},
    ),
    (
        "sign of mimic ignored", "{joint} follows with a multiplier of the opposite sign",
        "use the sign of the multiplier of {joint}", None,
    ),
    (
        "offset of mimic ignored", "{joint} follows without its offset", "add the offset of {joint}", {"offset": 0.0},
    ),
)  # fmt: skip
"""Name, sentence, repair, and the numbers of the mimic as the program has them; None for minus the multiplier."""


def mimics(model: Model) -> Iterator[Hypothesis]:
    """Joints that follow another."""
    followers = tuple(i for i, joint in enumerate(model.joints) if joint.mimic is not None)
    for name, sentence, repair, numbers in FOLLOWS:
        changed = tuple(i for i in followers if _follows(model.joints[i], numbers).mimic != model.joints[i].mimic)
        groups = [(i,) for i in changed] + ([changed] if len(changed) > 1 else [])
        for group in groups:
            joint, label = named(model, group)
            label = label if joint else "every joint that follows another"
            yield Hypothesis(
                id=name + ("" if joint else " at every joint"),
                kind="joint",
                sentence=sentence.format(joint=label),
                repair=repair.format(joint=label),
                apply=partial(_following, numbers=numbers, indices=group),
                joint=joint,
                line=line_of(model, joint=joint) if joint else "",
            )
    yield from (_not_transmitted(model, i) for i in followers)


def _follows(joint: Joint, numbers: Mapping[str, float] | None) -> Joint:
    """The joint with other numbers of its mimic."""
    mimic = joint.mimic
    if mimic is None:
        return joint
    own: dict[str, Any] = {"multiplier": -mimic.multiplier} if numbers is None else dict(numbers)
    return replace(joint, mimic=replace(mimic, **own))


def _following(
    variant: Variant, x: Sequence[float], numbers: Mapping[str, float] | None, indices: tuple[int, ...]
) -> Variant:
    return with_joints(variant, indices, lambda joint: _follows(joint, numbers))


def _not_transmitted(model: Model, i: int) -> Hypothesis:
    """The follower moves, and whatever drives it is no part of tau."""
    name = model.joints[i].name
    return Hypothesis(
        id="force of mimic ignored",
        kind="joint",
        sentence=f"what drives {name} is not passed on to the joint that it follows",
        repair=f"add the multiplier of {name} times its force to tau of the joint that it follows",
        apply=partial(_without_force, i=i),
        joint=name,
        line=line_of(model, joint=name),
    )


def _without_force(variant: Variant, x: Sequence[float], i: int) -> Variant:
    model = variant.model

    def outputs(batch: Batch, values: Values) -> Values:
        return _taken(model, i, variant.given(batch), values)

    return variant.with_output(outputs)


def _taken(model: Model, i: int, batch: Batch, values: Values) -> Values:
    """Tau without the force of a follower."""
    joint = model.joints[i]
    mimic = joint.mimic
    if mimic is None:
        return values
    leader = next(own for own in slots(model) if own.index == mimic.joint)
    states = (columns(y[:, at]) for y, at in ((batch.q, leader.q), (batch.v, leader.v), (batch.a, leader.v)))
    state = mimicked(mimic, JointState(*(list(y) for y in states)), FLOAT)
    f, n = (Vector(*columns(values[key][:, i])) for key in ("f", "n"))
    (force,) = joint.type.driving_force(body_of(joint, model.links[i], FLOAT), f, n)
    (own,) = joint_effects(joint.effects, state, FLOAT)
    total: Any = (force + own) * -mimic.multiplier
    return added(values, leader.v[:1], np.reshape(total, (-1, 1)))
