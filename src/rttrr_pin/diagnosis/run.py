"""Why does a program differ? The causes, or what the difference depends on."""

from __future__ import annotations

import math
import time
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.payload import Load, RandomPayload, load_of
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.diagnosis.catalogue.whole import hypotheses_of
from rttrr_pin.diagnosis.engine.counterexample import counterexample
from rttrr_pin.diagnosis.engine.dependence import dependence
from rttrr_pin.diagnosis.engine.evidence import Evidence, bits, part_of, places, rms
from rttrr_pin.diagnosis.engine.fitting import Explanation
from rttrr_pin.diagnosis.engine.gathering import between, evidence_of, finite_states, part_of_result
from rttrr_pin.diagnosis.engine.predictions import applied, predicted
from rttrr_pin.diagnosis.engine.search import Progress, Search
from rttrr_pin.diagnosis.results import Cause, Diagnosis, NearMiss, Residual
from rttrr_pin.diagnosis.states import sample_states
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Variant
from rttrr_pin.errors import InputError
from rttrr_pin.implementations import Batch, Implementation, label, make_implementation
from rttrr_pin.implementations.protocol import evaluated
from rttrr_pin.implementations.registry import Source
from rttrr_pin.robot import Robot
from rttrr_pin.validation.compare import labels, ratio, with_allowance
from rttrr_pin.validation.sampling import Payload
from rttrr_pin.validation.states import described, model_of, table_of

NEAR_MISSES, LEAST = 5, 0.1
"""So many are told, of those that explain this part at least."""

BARELY = 10.0
"""Times what rounding explains: a smaller difference tells causes apart badly."""

NUMBER = 10.0
"""Bits of evidence that a fitted number takes."""

OTHERS = 10
"""Other sets that are told."""


def diagnose(
    robot: Robot,
    subject: Source,
    reference: Source = "kernel",
    n_states: int = 300,
    seed: int = 0,
    payload: Payload = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Find out why a program's inverse dynamics differ from another's.

    Args:
        robot: the robot.
        subject: the program that is asked: all that `validate` takes. A table brings its own states.
        reference: what it is compared with. Where that differs from the recursion too, its causes are told as well.
        n_states: how many telling states (`sample_states`); of a table all of its own.
        seed: of the states.
        payload: what the robot exerts on its surroundings: nothing; a wrench, the same in every state; or
            `RandomPayload()`, in some of the states. A table without payload columns takes the wrench that its
            results were computed with.
        progress: called with the number of hypotheses tried so far.

    Returns:
        The verdict, the causes, and what is left with them.

    Raises:
        InputError: an argument cannot be used, the programs have no quantity in common, or all that they give is zero.
        ImplementationError: a program is missing, refuses the robot, dies, or says something else than numbers.
    """
    begin = time.perf_counter()
    model = model_of(robot, "there is nothing to diagnose")
    programs = [make_implementation(source, model) for source in (subject, reference)]
    batch, sampling = _states(robot, programs, n_states, seed, payload)
    with np.errstate(over="ignore", invalid="ignore"):
        result = _diagnosed(programs, batch, sampling, progress, begin)
    if sampling == "table" and payload is not None:
        return replace(result, notes=(f"payload in every state of the table: {described(payload)}", *result.notes))
    return result


def diagnose_at(
    batch: Batch,
    subject: Implementation,
    reference: Source = "recursion",
    ids: Collection[str] | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Find out why a program's inverse dynamics differ from another's at given states; without a test to paste.

    Args:
        batch: the states.
        subject: the program that is asked, made for the robot of the batch.
        reference: what it is compared with.
        ids: of the hypotheses that are tried (`Hypothesis.id`); None for the whole catalogue.
        progress: called with the number of hypotheses tried so far.

    Raises:
        InputError: the programs have no quantity in common, or all that they give is zero, or no number.
        ImplementationError: a program dies, or says something else than numbers.
    """
    begin = time.perf_counter()
    programs = [subject, make_implementation(reference, batch.model)]
    every = hypotheses_of(batch.model)
    tried = every if ids is None else [own for own in every if own.id in ids]
    with np.errstate(over="ignore", invalid="ignore"):
        return _diagnosed(programs, batch, "given", progress, begin, tried)


def _states(
    robot: Robot, programs: Sequence[Implementation], n_states: int, seed: int, payload: Payload
) -> tuple[Batch, str]:
    """Those of a table among the programs, with the payload that it has or that is passed; else telling ones."""
    load = payload if payload is None or isinstance(payload, RandomPayload) else load_of(robot.model, payload)
    table = table_of(programs, load)
    if table is not None:
        return table, "table"
    if isinstance(load, Load):
        return replace(sample_states(robot, n_states, seed, None).states, loads=(load,)), "telling"
    return sample_states(robot, n_states, seed, load).states, "telling"


def _diagnosed(
    programs: Sequence[Implementation],
    batch: Batch,
    sampling: str,
    progress: Progress | None,
    begin: float,
    hypotheses: Sequence[Hypothesis] | None = None,
) -> Diagnosis:
    """The diagnosis of two programs at these states, by the whole catalogue or by some hypotheses."""
    model = batch.model
    shared = tuple(key for key in QUANTITIES if all(key in one.quantities for one in programs))
    if not shared:
        raise InputError(f"{programs[0].name} and {programs[1].name} give no quantity in common")
    results = [with_allowance(batch, evaluated(one, batch)) for one in programs]
    kept, notes = finite_states(programs, results, shared)
    batch, results = part_of(batch, kept), [part_of_result(one, kept) for one in results]
    evidence = evidence_of(batch, results, shared)
    both = between(batch, results, shared)
    if not (both.values.any() or both.expected.any()):
        raise InputError(
            f"all results for robot {model.name!r} are zero in every state, by both programs: nothing was compared; "
            "pass gravity, a payload or states in which a force acts"
        )
    before = both.of_tolerance(both.expected)
    differs = bool((before > 1.0).any())
    found = _explained(programs, evidence, progress, hypotheses) if differs else _Found()
    lines: tuple[str, ...] = ()
    if differs and not found.causes:
        lines = (*found.alone, *dependence(programs, both))
    elif notes and not differs:
        lines = ("in all other states it is rounding",)
    if differs and before.max() < BARELY:
        notes.append("the difference is barely more than rounding explains: many a cause would be as good")
    if found.left_out:
        notes.append(f"{found.left_out} sets of causes more than those that are listed explain these states as well")
    after = both.difference - (found.changes if found.causes else 0.0)
    left = ratio(np.abs(after), both.tolerance + found.rounding) if found.causes else before
    return Diagnosis(
        robot=model.name,
        subject=label(programs[0]),
        reference=label(programs[1]),
        verdict="explained" if found.causes else "unexplained" if differs or lines else "agrees",
        causes=tuple(found.causes),
        others=tuple(found.others),
        residuals=_residuals(both, after, before, left),
        residual_before=float(before.max(initial=0.0)),
        residual_after=float(left.max(initial=0.0)),
        dependence=lines,
        near_misses=tuple(sorted(found.near, key=lambda near: -near.explains)[:NEAR_MISSES]),
        counterexample=counterexample(programs, both) if differs and hypotheses is None else "",
        n_states=len(batch),
        sampling=sampling,
        tried=found.tried,
        notes=(*(own.text for own in model.notes), *(x for one in programs for x in getattr(one, "notes", ())), *notes),
        seconds=time.perf_counter() - begin,
    )


@dataclass(slots=True)
class _Found:
    """What the searches came to.

    Attributes:
        causes: of both programs; none where what one of them does is unexplained.
        others: other sets.
        left_out: how many more of them there are.
        near: what comes nearest.
        changes: of the difference, by the causes.
        rounding: of the recursion under the causes.
        tried: hypotheses.
        alone: causes of one program, where what the other does is unexplained.
    """

    causes: list[Cause] = field(default_factory=list)
    others: list[tuple[Cause, ...]] = field(default_factory=list)
    left_out: int = 0
    near: list[NearMiss] = field(default_factory=list)
    changes: Array | float = 0.0
    rounding: Array | float = 0.0
    tried: int = 0
    alone: tuple[str, ...] = ()


def _explained(
    programs: Sequence[Implementation],
    evidence: Sequence[Evidence],
    progress: Progress | None,
    hypotheses: Sequence[Hypothesis] | None,
) -> _Found:
    """Each program against the recursion, where it differs from it."""
    model = evidence[0].batch.model
    base, tried = Variant(model), hypotheses_of(model) if hypotheses is None else hypotheses
    found, unexplained = _Found(), False
    for sign, program, own in zip((1.0, -1.0), programs, evidence, strict=True):
        if (own.of_tolerance(own.expected) <= 1.0).all():
            continue
        search = Search(own, base, tried, progress)
        explanations = search.run()
        found.tried += search.tried
        if not explanations or not explanations[0].explains or _by_chance(explanations[0], own, search.tried):
            unexplained = True
            found.near += _near_misses(search, explanations, program)
            continue
        first, *rest = explanations
        found.causes += _causes(first, program)
        found.others += [tuple(_causes(one, program)) for one in rest[:OTHERS]]
        found.left_out += len(rest[OTHERS:])
        values = predicted(applied(base, first.hypotheses, first.numbers), own)
        found.changes += sign * (values - own.expected)
        found.rounding += own.rounding_at(values)
    if unexplained:
        found.alone = tuple(
            f"{one.sentence}: {one.program} does nothing else otherwise than the recursion" for one in found.causes
        )
        found.causes, found.others, found.left_out = [], [], 0
    return found


def _by_chance(own: Explanation, evidence: Evidence, tried: int) -> bool:
    """Whether the differences say so little that one of so many hypotheses was bound to fit."""
    return bits(evidence) < len(own.hypotheses) * math.log2(tried + 1) + NUMBER * own.fitted


def _causes(found: Explanation, program: Implementation) -> list[Cause]:
    """The hypotheses of a set as causes."""
    causes = []
    for k, own in enumerate(found.hypotheses):
        alike = found.alike[k] if found.alike else ()
        cause = _cause(own, found.numbers_of(k), program)
        causes.append(replace(cause, alternatives=tuple(_cause(one, (), program) for one in alike)))
    return causes


def _cause(own: Hypothesis, numbers: Sequence[float], program: Implementation) -> Cause:
    values = own.values(numbers) if len(numbers) == len(own.start) else {}
    return Cause(
        own.id, own.sentence, own.repair, program.name, own.link, own.joint, dict(values), own.equation, own.line
    )


def _near_misses(search: Search, sets: Sequence[Explanation], program: Implementation) -> list[NearMiss]:
    """The single hypotheses, and the sets, that explain most."""
    found = [(1.0 - left**2, [own[0].hypothesis.sentence]) for left, own in search.ranked[:NEAR_MISSES]]
    found += [(1.0 - one.left**2, [own.sentence for own in one.hypotheses]) for one in sets[:1] if one.hypotheses[1:]]
    return [NearMiss(f"{program.name}: {'; '.join(words)}", share) for share, words in found if share >= LEAST]


def _residuals(evidence: Evidence, after: Array, before_ratio: Array, after_ratio: Array) -> tuple[Residual, ...]:
    """Row by row."""
    model = evidence.batch.model
    columns = places(model, evidence.quantities)
    rows: list[Residual] = []
    for key, at, unit in labels(model):
        if key not in evidence.quantities:
            continue
        own = [k for k, place in enumerate(columns) if place == (key, at)]
        sizes = (evidence.difference, after, before_ratio, after_ratio)
        largest = (float(np.abs(x[:, own]).max()) for x in sizes)
        rows.append(Residual(key, at, unit, float(np.linalg.norm(rms(evidence.expected[:, own]))), *largest))
    return tuple(rows)
