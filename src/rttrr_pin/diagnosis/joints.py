"""Hypotheses on joints: armature, friction, gears, springs and mimic, counted or not."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from rttrr_pin.core.algebra import Vector
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.dynamics import body_of, joint_effects, mimicked
from rttrr_pin.core.joint import EFFECTS, Joint, JointEffects
from rttrr_pin.core.joints.base import JointState
from rttrr_pin.core.model import Model
from rttrr_pin.core.scalars import FLOAT, columns
from rttrr_pin.diagnosis.altering import line_of, with_joints
from rttrr_pin.diagnosis.hypothesis import Hypothesis
from rttrr_pin.diagnosis.slots import Slots, single, slots
from rttrr_pin.diagnosis.variant import Values, Variant
from rttrr_pin.implementations.protocol import Batch

WHAT = {"armature": "armature", "damping": "viscous friction", "friction": "Coulomb friction"}
"""What each effect is called."""

START = 0.1
"""Where fits of an effect begin [kg m^2, N m s/rad, N m]."""


def joints(model: Model) -> list[Hypothesis]:
    """All hypotheses on what the joints of a robot add to tau."""
    return [*_effects(model), *_springs(model), *_gears(model), *_mimics(model)]


def _effects(model: Model) -> Iterator[Hypothesis]:
    """Armature, damping and friction: ignored where the robot has them, and of another size everywhere."""
    moving = tuple(i for i, joint in enumerate(model.joints) if joint.nv)
    for effect in EFFECTS:
        having = tuple(i for i in moving if getattr(model.joints[i].effects, effect))
        yield from (_ignored(model, (effect,), (i,)) for i in having)
        if len(having) > 1:
            yield _ignored(model, (effect,), having)
        yield from (_of_size(model, effect, (i,)) for i in moving)
        if len(moving) > 1:
            yield _of_size(model, effect, moving)
    for several in (("damping", "friction"), EFFECTS):
        having = tuple(i for i in moving if any(getattr(model.joints[i].effects, own) for own in several))
        if sum(any(getattr(model.joints[i].effects, own) for i in moving) for own in several) > 1:
            yield _ignored(model, several, having)


def _named(model: Model, indices: tuple[int, ...]) -> tuple[str | None, str]:
    """The joint's name, if it is one, and what a sentence calls them."""
    if len(indices) == 1:
        name = model.joints[indices[0]].name
        return name, name
    return None, "every joint"


def _ignored(model: Model, effects: Sequence[str], indices: tuple[int, ...]) -> Hypothesis:
    """The program counts none of these."""
    joint, name = _named(model, indices)
    what = " and ".join(filter(None, (", ".join(WHAT[own] for own in effects[:-1]), WHAT[effects[-1]])))
    verb = "is" if len(effects) == 1 else "are"
    own = {effect: [float(getattr(model.joints[i].effects, effect)) for i in indices] for effect in effects}
    many = joint is None or len(effects) > 1
    label = "friction" if tuple(effects) == ("damping", "friction") else "joint effects" if many else effects[0]
    if len(effects) == 1:
        label = WHAT[effects[0]]
    return Hypothesis(
        id=f"{label} ignored" + (" at every joint" if joint is None else ""),
        kind="joint",
        sentence=f"the {what} of {name} {verb} not counted",
        repair=f"add the {what} of {name} to tau: {_term(effects)}",
        apply=partial(_without, effects=tuple(effects), indices=indices),
        joint=joint,
        values=lambda x: {effect: numbers[0] if joint else numbers for effect, numbers in own.items()},
        line=line_of(model, joint=joint) if joint else "",
    )


TERMS = {"armature": "armature a", "damping": "damping v", "friction": "friction sign(v)"}


def _term(effects: Sequence[str]) -> str:
    return " + ".join(TERMS[own] for own in effects)


def _without(variant: Variant, x: Sequence[float], effects: tuple[str, ...], indices: tuple[int, ...]) -> Variant:
    nothing = dict.fromkeys(effects, 0.0)
    return with_joints(variant, indices, lambda joint: replace(joint, effects=replace(joint.effects, **nothing)))


def _of_size(model: Model, effect: str, indices: tuple[int, ...]) -> Hypothesis:
    """The program adds so much more."""
    joint, name = _named(model, indices)
    own = [float(getattr(model.joints[i].effects, effect)) for i in indices]
    counted = any(own)
    sentence = f"the {WHAT[effect]} of {name} is another" if counted else f"{name} has {WHAT[effect]}"

    def told(x: Sequence[float]) -> Mapping[str, Any]:
        of_all = {f"{effect} added": x[0]} if joint is None and counted else {effect: own[0] + x[0]}
        return of_all | ({} if joint is None else {f"{effect} of the robot": own[0]})

    return Hypothesis(
        id=f"{WHAT[effect]} of another size" + (" at every joint" if joint is None else ""),
        kind="joint",
        sentence=sentence,
        repair=f"leave {TERMS[effect]} out, or give the robot such joint effects" if not counted
        else f"use the {WHAT[effect]} of the robot",
        apply=partial(_with_more, effect=effect, indices=indices),
        joint=joint,
        start=(START,),
        neutral=(0.0,),
        values=told,
        line=line_of(model, joint=joint) if joint and counted else "",
    )  # fmt: skip


def _with_more(variant: Variant, x: Sequence[float], effect: str, indices: tuple[int, ...]) -> Variant:
    def more(joint: Joint) -> Joint:
        effects: JointEffects = replace(joint.effects, **{effect: getattr(joint.effects, effect) + float(x[0])})
        return replace(joint, effects=effects)

    return with_joints(variant, indices, more)


def _springs(model: Model) -> Iterator[Hypothesis]:
    """Springs and constant offsets of tau."""
    for own in single(slots(model)):
        yield Hypothesis(
            id="spring",
            kind="joint",
            sentence=f"a spring acts at {own.name}: K (q - q0) is part of its tau",
            repair=f"leave the spring of {own.name} out: the robot has none",
            apply=partial(_spring, own=own),
            joint=own.name,
            start=(1.0, 0.0),
            neutral=(0.0, 0.0),
            values=lambda x: {"stiffness": x[0], "rest": -x[1] / x[0] if x[0] else None},
        )
        yield Hypothesis(
            id="offset of tau",
            kind="joint",
            sentence=f"tau of {own.name} has a constant offset",
            repair=f"subtract the offset from tau of {own.name}, such as that of a sensor",
            apply=partial(_spring_force, own=own),
            joint=own.name,
            start=(1.0,),
            neutral=(0.0,),
            values=lambda x: {"offset": x[0]},
        )


def _spring(variant: Variant, x: Sequence[float], own: Slots) -> Variant:
    """K q - K q0, linear in both numbers."""
    stiffness, constant = float(x[0]), float(x[1])
    return variant.with_output(lambda batch, values: added(values, own.v, stiffness * batch.q[:, own.q] + constant))


def _spring_force(variant: Variant, x: Sequence[float], own: Slots) -> Variant:
    return variant.with_output(lambda batch, values: added(values, own.v, float(x[0])))


def added(values: Values, at: Sequence[int], force: Array | float) -> Values:
    """Values with a force more at some rates."""
    tau = values["tau"].copy()
    tau[:, at] += force
    return {**values, "tau": tau}


def _gears(model: Model) -> Iterator[Hypothesis]:
    """Coordinates of the motor in place of those of the joint."""
    for own in single(slots(model)):
        yield Hypothesis(
            id="gear ratio",
            kind="joint",
            sentence=f"q, v, a and tau of {own.name} are taken as those of a motor behind a gear",
            repair=f"convert q, v, a and tau of {own.name} by the gear ratio",
            apply=partial(_geared, own=own),
            joint=own.name,
            start=(1.1,),
            neutral=(1.0,),
            values=lambda x: {"gear ratio": x[0]},
        )


def _geared(variant: Variant, x: Sequence[float], own: Slots) -> Variant:
    ratio = float(x[0])

    def inputs(batch: Batch) -> Batch:
        q, v, a = (y.copy() for y in (batch.q, batch.v, batch.a))
        q[:, own.q] *= ratio
        for y in (v, a):
            y[:, own.v] *= ratio
        return replace(batch, q=q, v=v, a=a)

    def outputs(batch: Batch, values: Values) -> Values:
        return {**values, "tau": np.where(np.isin(np.arange(batch.model.nv), own.v), ratio, 1.0) * values["tau"]}

    return variant.with_input(inputs).with_output(outputs)


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


def _mimics(model: Model) -> Iterator[Hypothesis]:
    """Joints that follow another."""
    followers = tuple(i for i, joint in enumerate(model.joints) if joint.mimic is not None)
    for name, sentence, repair, numbers in FOLLOWS:
        changed = tuple(i for i in followers if _follows(model.joints[i], numbers).mimic != model.joints[i].mimic)
        groups = [(i,) for i in changed] + ([changed] if len(changed) > 1 else [])
        for group in groups:
            joint, label = _named(model, group)
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
