"""The results of programs, gathered as evidence."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.diagnosis.engine.evidence import Evidence, flat, spread
from rttrr_pin.errors import InputError
from rttrr_pin.implementations import Batch, Evaluation, Implementation, default_allowance
from rttrr_pin.implementations.protocol import evaluated
from rttrr_pin.reporting.results import counted
from rttrr_pin.validation.compare import with_allowance


def evidence_of(batch: Batch, results: Sequence[Evaluation], quantities: tuple[str, ...]) -> list[Evidence]:
    """Each program beside the recursion."""
    expected = flat(dict(batch.recursion[0].items()), quantities)
    rounding = spread(default_allowance(batch), quantities)
    return [
        Evidence(
            batch,
            quantities,
            flat(dict(one.values), quantities),
            expected,
            spread(dict(one.allowance or {}), quantities),
            rounding,
        )
        for one in results
    ]


def asked(programs: Sequence[Implementation], batch: Batch, quantities: tuple[str, ...]) -> Evidence:
    """What two programs say of these states, one beside the other."""
    return between(batch, [with_allowance(batch, evaluated(one, batch)) for one in programs], quantities)


def between(batch: Batch, results: Sequence[Evaluation], quantities: tuple[str, ...]) -> Evidence:
    """One program beside the other, without any line of the recursion."""
    values, expected = (flat(dict(one.values), quantities) for one in results)
    own, other = (spread(dict(one.allowance or {}), quantities) for one in results)
    return Evidence(batch, quantities, values, expected, own + other, np.zeros_like(own))


def finite_states(
    programs: Sequence[Implementation], results: Sequence[Evaluation], quantities: Sequence[str]
) -> tuple[NDArray[np.int64], list[str]]:
    """The states in which all results are numbers; and what is to be said of the others."""
    finite = [np.isfinite(flat(dict(one.values), quantities)).all(axis=1) for one in results]
    notes = []
    for program, own in zip(programs, finite, strict=True):
        if not own.all():
            first = int(np.argmin(own))
            notes.append(
                f"{program.name} has no number in {counted(int((~own).sum()), 'state')}, first {first}: left out"
            )
    kept = np.flatnonzero(np.logical_and.reduce(finite))
    if not len(kept):
        raise InputError(f"no state has numbers of both programs: {'; '.join(notes)}")
    return kept, notes


def part_of_result(result: Evaluation, rows: NDArray[np.int64]) -> Evaluation:
    """The results of some states."""
    values, allowance = (
        {key: x[rows] for key, x in (arrays or {}).items()} for arrays in (result.values, result.allowance)
    )
    joint = None if result.tau_joint is None else result.tau_joint[rows]
    return Evaluation(values, allowance, joint)
