"""Hypotheses on signs, units and factors of q, v, a and tau, and on which of them count."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import pi
from typing import Any

from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.catalogue.altering import WORDS, line_of, told_first
from rttrr_pin.diagnosis.catalogue.columns import geared, scaled, tau_scaled
from rttrr_pin.diagnosis.catalogue.slots import Slots, single, slots
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Variant
from rttrr_pin.implementations.protocol import Batch

DEGREE = pi / 180.0

FORCES = {"mN m": 1e3, "N cm": 1e2, "kgf m": 9.80665, "lbf ft": 1.3558179483314004, "lbf in": 0.1129848290276167}
"""What a factor of tau may come from; one for 1 N m, or the other way round."""

GIVEN_QUARTERS = (90, -90, 180)
"""Degrees by which the zero of a joint may be off: those that tables of DH parameters bring."""


def signs_and_units(model: Model) -> Iterator[Hypothesis]:
    """All of them."""
    own = slots(model)
    yield from _units(own)
    yield from _of_tau(own)
    for joint in own:
        yield from _of_joint(model, joint)
    for joint in single(own):
        yield from _zeros(model, joint)


@dataclass(frozen=True, slots=True)
class Unit:
    """A factor on coordinates, rates or accelerations that are angles, or lengths."""

    id: str
    sentence: str
    repair: str
    factor: float
    on: str
    angles: bool = True


UNITS = (
    Unit("degrees taken", "q, v and a of angles are taken for degrees", "pass degrees, or take radians", DEGREE, "qva"),
    Unit("degrees given", "q, v and a of angles are converted to degrees and taken for radians", "pass radians",
         1.0 / DEGREE, "qva"),
    Unit("degrees of q taken", "q of angles is taken for degrees, v and a for rad/s and rad/s^2",
         "pass q in degrees, or take radians", DEGREE, "q"),
    Unit("degrees of q given", "q of angles is converted to degrees and taken for radians", "pass q in radians",
         1.0 / DEGREE, "q"),
    Unit("degrees of v and a taken", "v and a of angles are taken for degrees, q for radians",
         "pass v and a in degrees, or take radians", DEGREE, "va"),
    Unit("degrees of v and a given", "v and a of angles are converted to degrees and taken for radians",
         "pass v and a in radians", 1.0 / DEGREE, "va"),
    Unit("rpm", "v of angles is taken for revolutions per minute", "pass v in rpm, or take rad/s", pi / 30.0, "v"),
    Unit("mm taken", "q, v and a of lengths are taken for mm", "pass mm, or take m", 1e-3, "qva", angles=False),
    Unit("mm given", "q, v and a of lengths are converted to mm and taken for m", "pass m", 1e3, "qva", angles=False),
)  # fmt: skip


def _units(own: Sequence[Slots]) -> Iterator[Hypothesis]:
    """Units of what is given."""
    for unit in UNITS:
        columns: dict[str, dict[int, float]] = {"q": {}, "v": {}, "a": {}}
        for joint in own:
            lengths = [k for k in joint.q if k not in joint.angles and not joint.quaternions]
            lengths += joint.q[:3] if joint.quaternions else []  # x, y, z before the quaternion
            q = joint.angles if unit.angles else lengths
            v = joint.turns if unit.angles else [k for k in joint.v if k not in joint.turns]
            for name in unit.on:
                columns[name] |= dict.fromkeys(q if name == "q" else v, unit.factor)
        if columns["q"] or columns["v"] or columns["a"]:
            yield Hypothesis(unit.id, "convention", unit.sentence, unit.repair, partial(_in_unit, columns=columns))


def _in_unit(variant: Variant, x: Sequence[float], columns: Mapping[str, Mapping[int, float]]) -> Variant:
    return scaled(variant, columns["q"], columns["v"], columns["a"])


def no_tau(model: Model) -> Iterator[Hypothesis]:
    """Tau left out, as in a table that was never filled: at every joint, or at the only one."""
    joints = slots(model)
    if len(joints) == 1:
        yield _missing(joints[0])
        return
    yield Hypothesis(
        id="tau missing at every joint",
        kind="convention",
        sentence="tau is 0",
        repair="compute tau; of a table, fill its columns",
        apply=partial(_tau_times, columns=[k for joint in joints for k in joint.v], factor=0.0),
    )


def _missing(joint: Slots) -> Hypothesis:
    return Hypothesis(
        id="tau missing",
        kind="convention",
        sentence=f"tau of {joint.name} is 0",
        repair=f"compute tau of {joint.name}",
        apply=partial(_tau_times, columns=joint.v, factor=0.0),
        joint=joint.name,
    )


def _of_tau(own: Sequence[Slots]) -> Iterator[Hypothesis]:
    """Sign and factors of all of tau, or of its moments or forces."""
    rates = [k for joint in own for k in joint.v]
    turns = [k for joint in own for k in joint.turns]
    forces = [k for k in rates if k not in turns]
    yield Hypothesis(
        id="sign of tau",
        kind="convention",
        sentence="tau has the opposite sign",
        repair="multiply tau by -1",
        apply=partial(_tau_times, columns=rates, factor=-1.0),
    )
    parts = [("tau", rates)] + ([("moments in tau", turns), ("forces in tau", forces)] if turns and forces else [])
    for name, columns in parts:
        verb = "is" if name == "tau" else "are"
        yield Hypothesis(
            id=f"factor of {name}",
            kind="convention",
            sentence=f"{name} {verb} multiplied by a factor",
            repair=f"give {name} in N m and N",
            apply=partial(_tau_times, columns=columns),
            start=(2.0,),
            neutral=(1.0,),
            values=partial(told_first, units=FORCES | WORDS),
        )


def _tau_times(variant: Variant, x: Sequence[float], columns: Sequence[int], factor: float | None = None) -> Variant:
    """Tau times a factor, which is fitted where none is given."""
    return tau_scaled(variant, dict.fromkeys(columns, float(x[0]) if factor is None else factor))


def _of_joint(model: Model, joint: Slots) -> Iterator[Hypothesis]:
    """Sign, direction and factor of one joint, and its tau left out where it is one of several."""
    name = joint.name
    if len(joint.q) == len(joint.v) == 1:
        yield Hypothesis(
            id="joint direction",
            kind="convention",
            sentence=f"{name} counts in the opposite direction: its axis, or q, v, a and tau, have the opposite sign",
            repair=f"negate the axis of {name}",
            apply=lambda variant, x: geared(variant, (-1.0,), joint),
            joint=name,
            line=line_of(model, joint=name),
        )
    if model.nv == len(joint.v):
        return
    yield _missing(joint)
    yield Hypothesis(
        id="sign of tau at a joint",
        kind="convention",
        sentence=f"tau of {name} has the opposite sign",
        repair=f"multiply tau of {name} by -1",
        apply=partial(_tau_times, columns=joint.v, factor=-1.0),
        joint=name,
    )
    yield Hypothesis(
        id="factor of tau at a joint",
        kind="convention",
        sentence=f"tau of {name} is multiplied by a factor, such as a gear ratio",
        repair=f"give tau of {name} at the joint, in N m or N",
        apply=partial(_tau_times, columns=joint.v),
        joint=name,
        start=(2.0,),
        neutral=(1.0,),
        values=partial(told_first, units=FORCES | WORDS),
    )


def _zeros(model: Model, joint: Slots) -> Iterator[Hypothesis]:
    """Another zero of a joint."""
    yield Hypothesis(
        id="joint offset",
        kind="convention",
        sentence=f"the zero of {joint.name} is elsewhere",
        repair=f"count q of {joint.name} from the zero of the robot's file",
        apply=partial(_offset, joint=joint),
        joint=joint.name,
        start=(0.3,) if joint.angles else (0.1,),
        neutral=(0.0,),
        values=lambda x: {"offset": x[0]} | ({"degrees": x[0] / DEGREE} if joint.angles else {}),
        line=line_of(model, joint=joint.name),
    )
    for degrees in GIVEN_QUARTERS if joint.angles else ():
        yield Hypothesis(
            id=f"joint offset of {degrees} degrees",
            kind="convention",
            sentence=f"the zero of {joint.name} is {degrees} degrees off",
            repair=f"subtract {degrees} degrees from q of {joint.name}",
            apply=partial(_offset, joint=joint, offset=degrees * DEGREE),
            joint=joint.name,
            values=partial(_degrees, degrees=degrees),
            line=line_of(model, joint=joint.name),
        )


def _degrees(x: Sequence[float], degrees: int) -> Mapping[str, Any]:
    return {"offset": degrees * DEGREE, "degrees": degrees}


def _offset(variant: Variant, x: Sequence[float], joint: Slots, offset: float | None = None) -> Variant:
    """Another zero, which is fitted where none is given."""

    def inputs(batch: Batch) -> Batch:
        q = batch.q.copy()
        q[:, joint.q] += x[0] if offset is None else offset
        return replace(batch, q=q)

    return variant.with_input(inputs)
