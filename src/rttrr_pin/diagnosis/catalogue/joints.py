"""Hypotheses on joints: armature, friction, gears, springs and mimic, counted or not."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from rttrr_pin.core.joint import EFFECTS, Joint, JointEffects
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.catalogue.altering import each_and_all, line_of, named, with_joints
from rttrr_pin.diagnosis.catalogue.columns import added, geared
from rttrr_pin.diagnosis.catalogue.mimics import mimics
from rttrr_pin.diagnosis.catalogue.slots import Slots, single, slots
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Variant

WHAT = {"armature": "armature", "damping": "viscous friction", "friction": "Coulomb friction"}
"""What each effect is called."""

TERMS = {"armature": "armature a", "damping": "damping v", "friction": "friction sign(v)"}
"""What each adds to tau."""

START = 0.1
"""Where fits of an effect begin [kg m^2, N m s/rad, N m]."""


def joints(model: Model) -> list[Hypothesis]:
    """All hypotheses on what the joints of a robot add to tau."""
    return [*_effects(model), *_springs(model), *_gears(model), *mimics(model)]


def _effects(model: Model) -> Iterator[Hypothesis]:
    """Armature, damping and friction: ignored where the robot has them, and of another size everywhere."""
    moving = tuple(i for i, joint in enumerate(model.joints) if joint.nv)
    for effect in EFFECTS:
        having = tuple(i for i in moving if getattr(model.joints[i].effects, effect))
        yield from (_ignored(model, (effect,), group) for group in each_and_all(having))
        yield from (_of_size(model, effect, group) for group in each_and_all(moving))
    yield from _friction_of_the_file(model)
    for several in (("damping", "friction"), EFFECTS):
        having = tuple(i for i in moving if any(getattr(model.joints[i].effects, own) for own in several))
        if sum(any(getattr(model.joints[i].effects, own) for i in moving) for own in several) > 1:
            yield _ignored(model, several, having)


def _ignored(model: Model, effects: tuple[str, ...], indices: tuple[int, ...]) -> Hypothesis:
    """The program counts none of these."""
    joint, name = named(model, indices)
    what = " and ".join(filter(None, (", ".join(WHAT[own] for own in effects[:-1]), WHAT[effects[-1]])))
    verb = "is" if len(effects) == 1 else "are"
    own = {effect: [float(getattr(model.joints[i].effects, effect)) for i in indices] for effect in effects}
    label = {("damping", "friction"): "friction", EFFECTS: "joint effects"}.get(effects, what)
    return Hypothesis(
        id=f"{label} ignored" + (" at every joint" if joint is None else ""),
        kind="joint",
        sentence=f"the {what} of {name} {verb} not counted",
        repair=f"add the {what} of {name} to tau: {' + '.join(TERMS[own] for own in effects)}",
        apply=partial(_without, effects=effects, indices=indices),
        joint=joint,
        values=lambda x: {effect: numbers[0] if joint else numbers for effect, numbers in own.items()},
        line=line_of(model, joint=joint),
    )


def _without(variant: Variant, x: Sequence[float], effects: tuple[str, ...], indices: tuple[int, ...]) -> Variant:
    nothing = dict.fromkeys(effects, 0.0)
    return with_joints(variant, indices, lambda joint: replace(joint, effects=replace(joint.effects, **nothing)))


def _of_size(model: Model, effect: str, indices: tuple[int, ...]) -> Hypothesis:
    """The program adds so much more."""
    joint, name = named(model, indices)
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
        line=line_of(model, joint=joint) if counted else "",
    )  # fmt: skip


def _with_more(variant: Variant, x: Sequence[float], effect: str, indices: tuple[int, ...]) -> Variant:
    def more(joint: Joint) -> Joint:
        effects: JointEffects = replace(joint.effects, **{effect: getattr(joint.effects, effect) + float(x[0])})
        return replace(joint, effects=effects)

    return with_joints(variant, indices, more)


def _friction_of_the_file(model: Model) -> Iterator[Hypothesis]:
    """Damping and friction that the file has and the robot, as it is asked, has not."""
    given = (
        i for i, joint in enumerate(model.joints) if joint.nv and (joint.dynamics.damping or joint.dynamics.friction)
    )
    left_out = tuple(i for i in given if _with_friction(model.joints[i]) is not model.joints[i])
    for group in each_and_all(left_out):
        joint, name = named(model, group)
        yield Hypothesis(
            id="friction of the file" + ("" if joint else " at every joint"),
            kind="joint",
            sentence=f"damping and friction of {name}, as the file has them, are counted",
            repair="leave damping v + friction sign(v) out, or give the robot the joint effects of the file",
            apply=partial(_with_friction_of, indices=group),
            joint=joint,
            line=line_of(model, joint=joint),
        )


def _with_friction(joint: Joint) -> Joint:
    """The joint with the damping and friction of its file."""
    own = replace(joint.effects, damping=joint.dynamics.damping, friction=joint.dynamics.friction)
    return joint if own == joint.effects else replace(joint, effects=own)


def _with_friction_of(variant: Variant, x: Sequence[float], indices: tuple[int, ...]) -> Variant:
    return with_joints(variant, indices, _with_friction)


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


def _gears(model: Model) -> Iterator[Hypothesis]:
    """Coordinates of the motor in place of those of the joint."""
    for own in single(slots(model)):
        yield Hypothesis(
            id="gear ratio",
            kind="joint",
            sentence=f"q, v, a and tau of {own.name} are taken as those of a motor behind a gear",
            repair=f"convert q, v, a and tau of {own.name} by the gear ratio",
            apply=partial(geared, joint=own),
            joint=own.name,
            start=(1.1,),
            neutral=(1.0,),
            values=lambda x: {"gear ratio": x[0]},
        )
