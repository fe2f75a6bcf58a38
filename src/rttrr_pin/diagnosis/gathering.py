"""The results of programs, gathered as evidence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.diagnosis.evidence import Evidence, flat, spread
from rttrr_pin.errors import InputError
from rttrr_pin.implementations import Batch, Evaluation, Implementation, default_allowance


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


def between(subject: Evidence, reference: Evidence) -> Evidence:
    """One program beside the other, without any line of the recursion."""
    return replace(
        subject,
        expected=reference.values,
        tolerance=subject.tolerance + reference.tolerance,
        rounding=np.zeros_like(subject.rounding),
    )


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
                f"{program.name} has no number in {int((~own).sum())} states, first {first}: these are left out"
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
