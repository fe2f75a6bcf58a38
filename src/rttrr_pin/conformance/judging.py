"""How far a program is off the proven values of a case, in units of the rounding of the numbers it computes in."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np

from rttrr_pin.conformance.levels import Case, ProvenCase
from rttrr_pin.conformance.results import BINS, LevelResult, QuantityResult, Value
from rttrr_pin.core.arguments import choice
from rttrr_pin.core.arrays import Array, norm
from rttrr_pin.core.scalars import EPS
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.errors import ImplementationError, RefusalError, RttrrError
from rttrr_pin.exact.enclosures import Enclosures, enclose
from rttrr_pin.implementations import Batch, Evaluation, Implementation, default_allowance
from rttrr_pin.implementations.allowance import DOUBLE, SINGLE, Precision
from rttrr_pin.implementations.function import Function
from rttrr_pin.implementations.protocol import evaluated
from rttrr_pin.validation.comparison import check_bounds, off_the_truth, true_parameters

Wanted = Literal["auto", "float64", "float32"]
"""The precision that a program is judged at; "auto" finds it out from its numbers (`precision_of`)."""

PRECISIONS = {own.name: own for own in (DOUBLE, SINGLE)}

DISTINCT, LONG, SHORT_BITS = 16, 8, 2.0**16
"""Numbers that differ, of which so many are long, before all of them say that a program computes in float32: long is
what takes more than 16 bits, or eight digits where it was printed. Every number of few digits is one of float32's."""


def judge(case: Case, subject: Implementation, precision: Wanted = "auto") -> LevelResult:
    """Ask a program one case, and compare what it gives with enclosures of the true values.

    Every number must lie within what rounding can explain: that of a program of which nothing is known, or for
    programs of this package their running bounds (docs/tolerance.md). What a program of yours allows itself counts
    for nothing. The truth is that of the robot's file, as any program reads it.

    Args:
        case: what is asked (`cases`).
        subject: the program, made for the case's robot.
        precision: "float64" or "float32", in whose rounding it is judged; "auto": see `precision_of`.

    Returns:
        The outcome; a program that does not offer what is asked, or fails, is one too.

    Raises:
        InputError: there is no such precision, or float64 holds no bound on the rounding.
    """
    choice("precision", precision, "auto", *PRECISIONS)
    evaluation = ask(case, subject)
    if isinstance(evaluation, LevelResult):
        return evaluation
    own = precision_of([evaluation.values]) if precision == "auto" else PRECISIONS[precision]
    return judged(case, subject, evaluation, own)


def ask(case: Case, subject: Implementation) -> Evaluation | LevelResult:
    """What a program says of a case; an outcome where it says nothing."""
    try:
        evaluation = answered(subject, case.batch)
        if not evaluation.values:
            raise ImplementationError(f"{subject.name} gives none of tau, F, N, f, n: name some in its quantities")
    except RttrrError as error:
        return without_numbers(case, error)
    return evaluation


def answered(subject: Implementation, batch: Batch) -> Evaluation:
    """What a program says of states, without what it allows itself: nobody sets the bar for his own numbers.

    Of this package's own it stays: running bounds of a recursion, digits of what is printed, float32 of a function.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        evaluation = evaluated(subject, batch)
    if isinstance(subject, Function):
        ours = subject.type in (np.float64, np.float32)
    else:
        ours = type(subject).__module__.startswith(Function.__module__.rpartition(".")[0])
    return evaluation if ours else replace(evaluation, allowance=None)


def without_numbers(case: Case, error: RttrrError) -> LevelResult:
    """The outcome of a case in which a program refused, or failed."""
    outcome: Literal["not offered", "error"] = "not offered" if isinstance(error, RefusalError) else "error"
    return LevelResult(case.level.id, case.name, outcome, len(case.batch), "", (), str(error))


def precision_of(results: Iterable[Mapping[str, Array]]) -> Precision:
    """float32 where all numbers are of float32, or what is printed of one, and enough of them are long; else float64.

    A double that is computed as one has a chance of 2^-29 to be a float32; a number of eight or nine digits one of
    1/2 or 1/6 to be what is printed of one. Small integers and short decimals say nothing, nor does what is not finite.
    """
    found = [np.abs(x).ravel() for values in results for x in values.values()]
    numbers = np.unique(np.concatenate([*found, np.empty(0)]))  # none where the program failed each time
    numbers = numbers[np.isfinite(numbers) & (numbers > 0.0)]
    if len(numbers) < DISTINCT:
        return DOUBLE
    with np.errstate(over="ignore"):
        singles = numbers.astype(np.float32)
    equal = singles == numbers
    mantissas = np.frexp(numbers)[0] * SHORT_BITS
    long = int((equal & (mantissas != np.floor(mantissas))).sum())
    for x, single in zip(numbers[~equal].tolist(), singles[~equal], strict=True):
        if x not in (float(str(single)), float(f"{single:.8e}")):
            return DOUBLE
        long += any(digit != "0" for digit in f"{x:.8e}".partition("e")[0][-2:])
    return SINGLE if long >= LONG else DOUBLE


def allowed(batch: Batch, evaluation: Evaluation, precision: Precision) -> Evaluation:
    """The result with what rounding in that precision may make of it, or its author's allowance where that is more."""
    if precision is DOUBLE and evaluation.allowance is not None:
        return evaluation
    least = default_allowance(batch, precision)
    own = evaluation.allowance or {}
    return replace(evaluation, allowance={key: np.maximum(x, own.get(key, 0.0)) for key, x in least.items()})


def truth(case: Case) -> Enclosures:
    """Enclosures of the true values of a case, its own if it has some; those of the last cases are kept."""
    return case.enclosures if isinstance(case, ProvenCase) else _truth(_States(case.batch))


@dataclass(frozen=True, slots=True, eq=False)
class _States:
    """States that equal others with the same numbers, of the same model."""

    batch: Batch

    def _key(self) -> tuple[object, ...]:
        batch = self.batch
        loads = tuple((x.link, x.in_base, x.f.tobytes(), x.n.tobytes()) for x in batch.loads)
        return id(batch.model), batch.q.tobytes(), batch.v.tobytes(), batch.a.tobytes(), loads

    def __hash__(self) -> int:
        return hash(self._key())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _States) and self._key() == other._key()


@lru_cache(maxsize=64)
def _truth(states: _States) -> Enclosures:
    batch = states.batch
    return enclose(batch.model, batch.q, batch.v, batch.a, batch.loads, true_parameters(batch.model))


def judged(case: Case, subject: Implementation, evaluation: Evaluation, precision: Precision) -> LevelResult:
    """The outcome of a case in which the program gave numbers.

    Raises:
        InputError: no bound on the rounding is finite.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        result = allowed(case.batch, evaluation, precision)
        check_bounds(case.batch, subject, result)
        parts = _by_quantity(case, result, precision)
    outcome: Literal["pass", "fail"] = "fail" if any(own.failures for own in parts) else "pass"
    return LevelResult(case.level.id, case.name, outcome, len(case.batch), precision.name, parts)


def _by_quantity(case: Case, result: Evaluation, precision: Precision) -> tuple[QuantityResult, ...]:
    """What was seen of each quantity."""
    rows: dict[str, list[tuple[str, str, Array, Array, Array, Array]]] = {}
    for row, one in off_the_truth(case.batch, truth(case), result):
        eps = np.where(one.known & np.isfinite(one.error), one.relative * (EPS / precision.eps), np.nan)
        parts = (eps, one.of_tolerance, one.error, one.tolerance)
        rows.setdefault(row.quantity, []).append((row.at, row.unit, *parts))
    return tuple(_quantity(key, own, _sizes(case, key), precision) for key, own in rows.items())


def _sizes(case: Case, key: str) -> Array:
    """The true sizes of driving forces, (N, nv), or of vectors, (N, links)."""
    middle = getattr(truth(case), key).mid
    return norm(middle) if key in LINK_QUANTITIES else np.abs(middle)


def _quantity(
    key: str, rows: list[tuple[str, str, Array, Array, Array, Array]], sizes: Array, precision: Precision
) -> QuantityResult:
    """One quantity, at all places in all states."""
    eps, of_allowance, error, allowance = (np.stack([own[k] for own in rows]) for k in (2, 3, 4, 5))  # (places, N)
    beyond = of_allowance > 1.0
    inside = eps[~beyond]
    relative = inside[~np.isnan(inside)]
    bins = np.bincount(np.searchsorted(BINS, relative), minlength=len(BINS) + 1)
    known = ~np.isnan(eps)

    def value(order: Array) -> Value:
        place, state = np.unravel_index(int(np.argmax(order)), order.shape)
        at, unit = rows[place][:2]
        of_eps, part, own = (float(x[place, state]) for x in (eps, of_allowance, error))
        return Value(at, int(state), of_eps, part, own, unit)

    return QuantityResult(
        quantity=key,
        count=eps.size,
        failures=int(beyond.sum()),
        not_finite=int(np.isinf(error).sum()),
        near_zero=int(np.isnan(inside).sum()),
        histogram=tuple(bins.tolist()),
        median=float(np.median(eps[known])) if known.any() else math.nan,
        worst=value(of_allowance),
        farthest=value(np.where(known, eps, -1.0)) if known.any() else None,
        digits=_digits(error, allowance, sizes.T, precision),
    )


def _digits(error: Array, allowance: Array, sizes: Array, precision: Precision) -> float:
    """The fewest true decimal digits of any number that is more than rounding itself; NaN where there is none."""
    told = sizes > allowance
    if not told.any():
        return math.nan
    with np.errstate(divide="ignore"):
        digits = -np.log10(np.where(np.isfinite(error), error, sizes)[told] / sizes[told])
    return float(np.clip(digits, 0.0, -math.log10(precision.eps / 2)).min()) + 0.0  # never -0.0
