"""Hypotheses on joints that follow another."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from rttrr_pin.core.joint import Joint
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.catalogue.altering import each_and_all, line_of, named, with_joints
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.mutations import at, mutation
from rttrr_pin.diagnosis.variants.variant import Variant

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

PASSED_ON = "generalised_forces: drop forces[i][0] * multiplier"
"""The error that leaves the force of a follower out."""


def mimics(model: Model) -> Iterator[Hypothesis]:
    """Joints that follow another."""
    followers = tuple(i for i, joint in enumerate(model.joints) if joint.mimic is not None)
    for name, sentence, repair, numbers in FOLLOWS:
        changed = tuple(i for i in followers if _follows(model.joints[i], numbers).mimic != model.joints[i].mimic)
        for group in each_and_all(changed):
            joint, label = named(model, group, "every joint that follows another")
            yield Hypothesis(
                id=name + ("" if joint else " at every joint"),
                kind="joint",
                sentence=sentence.format(joint=label),
                repair=repair.format(joint=label),
                apply=partial(_following, numbers=numbers, indices=group),
                joint=joint,
                line=line_of(model, joint=joint),
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
    name, error = model.joints[i].name, at(mutation(PASSED_ON), i)
    return Hypothesis(
        id="force of mimic ignored",
        kind="joint",
        sentence=f"what drives {name} is not passed on to the joint that it follows",
        repair=f"add the multiplier of {name} times its force to tau of the joint that it follows",
        apply=lambda variant, x: variant.with_mutation(error),
        joint=name,
        line=line_of(model, joint=name),
        mutation=error,
    )
