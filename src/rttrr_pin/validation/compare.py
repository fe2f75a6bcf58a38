"""Two results side by side: how far apart, and whether rounding can explain it.

For each state, quantity and link (or degree of freedom), with Euclidean norms:

    |subject - reference| <= allowance of the subject + allowance of the reference

Each allowance says how far rounding can take that program from the true value (`implementations.allowance`). There is
no tolerance to choose.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from itertools import accumulate
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array, norm
from rttrr_pin.core.model import Model
from rttrr_pin.core.scalars import EPS
from rttrr_pin.core.wrench import LINK_QUANTITIES, QUANTITIES
from rttrr_pin.implementations import Batch, Evaluation, default_allowance
from rttrr_pin.implementations.allowance import carriers
from rttrr_pin.validation.histogram import Histogram
from rttrr_pin.validation.ranking import Worst

SLACK = 1e-9
"""Relative: more than rounding makes of the quotients that say which others are worth computing."""

LOST = 2.0**-900
"""Below it a limit, or what is compared with it, may have lost bits that count."""


@dataclass(slots=True)
class Row:
    """What was seen of one quantity at one link or joint.

    Attributes:
        quantity: tau, F, N, f or n.
        at: name of the link (of the joint for tau).
        unit: of the quantity.
        absolute: largest |subject - reference| in that unit.
        relative: largest |subject - reference| / |reference| in eps, of the states in which |reference| is more than
            the tolerance: beside a true zero, it would be rounding divided by rounding. For tau the divisor is the norm
            of the joint's n (of its f, where it slides), of which tau is one component.
        of_tolerance: largest error / tolerance.
        failures: states beyond the tolerance.
    """

    quantity: str
    at: str
    unit: str
    absolute: Worst = field(default_factory=Worst)
    relative: Worst = field(default_factory=Worst)
    of_tolerance: Worst = field(default_factory=Worst)
    failures: int = 0

    @property
    def passed(self) -> bool:
        """Whether every state lies within the tolerance."""
        return self.failures == 0


@dataclass(frozen=True, slots=True)
class Difference:
    """How far apart two results are in consecutive states, by place: (rows, N) each, or (N,) at one place.

    Attributes:
        error: |subject - reference|.
        size: |reference|.
        tolerance: what rounding can explain.
    """

    error: Array
    size: Array
    tolerance: Array

    @property
    def relative(self) -> Array:
        """|subject - reference| / |reference| in eps; 0 where they are equal."""
        return ratio(self.error, self.size * EPS)

    @property
    def known(self) -> NDArray[np.bool_]:
        """Whether |reference| is more than what rounding can explain, so that the relative error means anything."""
        return self.size > self.tolerance

    @property
    def of_tolerance(self) -> Array:
        """Error / tolerance; 0 where they are equal."""
        return ratio(self.error, self.tolerance)

    @property
    def known_relative(self) -> Array:
        """The relative error in eps where it means anything; elsewhere 0."""
        relative = self.relative
        np.copyto(relative, 0.0, where=~self.known)
        return relative

    def at(self, rows: Any) -> Difference:
        """That of some rows, or of one."""
        return Difference(self.error[rows], self.size[rows], self.tolerance[rows])

    def __iter__(self) -> Iterator[Difference]:
        """Row by row."""
        return map(self.at, range(len(self.error)))


class Comparison:
    """What is seen of one reference: the worst over any number of states, in memory that does not grow with them.

    Attributes:
        name: of the program.
        version: of it.
        quantities: those that both programs give.
        rows: of each quantity at each link or joint.
        whole: by quantity, the largest relative error in eps, in the norm over all links or joints; as `Row.relative`.
        histograms: by quantity, how many states have how large an error / tolerance, the largest over all places.
        zero: the quantities that are zero everywhere, in every state so far, by both programs.
        seen: the others.
    """

    def __init__(self, model: Model, quantities: Sequence[str] = QUANTITIES, name: str = "", version: str = "") -> None:
        """Prepare to compare these quantities."""
        self.name, self.version = name, version
        self.quantities = tuple(key for key in QUANTITIES if key in quantities)
        self.rows = tuple(Row(*own) for own in labels(model) if own[0] in self.quantities)
        self.whole = {quantity: Worst() for quantity in self.quantities}
        self.histograms = {quantity: Histogram() for quantity in self.quantities}
        self._carriers = carriers(model)
        self.zero = {row.quantity for row in self.rows}
        self.seen = set[str]()
        counts = [sum(row.quantity == key for row in self.rows) for key in self.quantities]
        ends = zip(self.quantities, accumulate(counts), counts, strict=True)
        self._places = {key: slice(end - count, end) for key, end, count in ends}

    @property
    def passed(self) -> bool:
        """Whether every state of every row lies within the tolerance."""
        return all(row.passed for row in self.rows)

    @property
    def worst(self) -> Row:
        """The row that comes closest to its tolerance, or lies furthest beyond."""
        return farthest_of(self.rows)

    def to_dict(self) -> dict[str, Any]:
        """By quantity and place, the worst and where."""
        quantities: dict[str, dict[str, Any]] = {}
        for row in self.rows:
            quantities.setdefault(row.quantity, {})[row.at] = asdict(row) | {"passed": row.passed}
        worst = {key: getattr(self.worst, key) for key in ("quantity", "at")} | asdict(self.worst.of_tolerance)
        normwise = {quantity: asdict(largest) for quantity, largest in self.whole.items()}
        histograms = {quantity: own.to_dict() for quantity, own in self.histograms.items()}
        names = {"reference": f"{self.name} {self.version}".rstrip(), "passed": self.passed}
        return {**names, "worst": worst, "normwise_eps": normwise, "histograms": histograms, "quantities": quantities}

    def add(self, batch: Batch, subject: Evaluation, reference: Evaluation) -> Array:
        """Take in the results of consecutive states; return the largest error / tolerance of each state, (N,)."""
        difference = self.differences(batch, subject, reference)
        of_tolerance = difference.of_tolerance
        _see([row.absolute for row in self.rows], difference.error, batch.first)
        _see([row.of_tolerance for row in self.rows], of_tolerance, batch.first)
        largest = [of_tolerance[places].max(axis=0, initial=0.0) for places in self._places.values()]
        for histogram, values in zip(self.histograms.values(), largest, strict=True):
            histogram.see(values)
        ratios: Array = np.max(largest, axis=0)
        if ratios.max() > 1.0:
            for row, failures in zip(self.rows, np.count_nonzero(of_tolerance > 1.0, axis=1).tolist(), strict=True):
                row.failures += failures
        self._see_relative(difference, batch.first)
        for key, places in self._places.items():
            _see_whole(self.whole[key], subject.values[key], reference.values[key], difference.at(places), batch.first)
        return ratios

    def _see_relative(self, difference: Difference, first: int) -> None:
        """Quotients are computed of the rows in which one may be larger than the largest so far."""
        worst = [row.relative for row in self.rows]
        limit = np.array([[_at_most(own, first)] for own in worst]) * difference.size
        rows = np.flatnonzero((difference.error > _trusted(limit)).any(axis=1))
        if len(rows):
            _see([worst[k] for k in rows], difference.at(rows).known_relative, first)

    def differences(self, batch: Batch, subject: Evaluation, reference: Evaluation) -> Difference:
        """The difference of each row, in the order of `rows`."""
        allowance, other = (_allowance(batch, side) for side in (subject, reference))
        for key in self.quantities:
            if key not in self.seen and (subject.values[key].any() or reference.values[key].any()):
                self.zero.discard(key)
                self.seen.add(key)
        lengths = {key: norm(y) for key, y in reference.values.items() if key != "tau"}
        parts = []
        for key in self.quantities:
            x, y = subject.values[key], reference.values[key]
            errors = np.abs(x - y) if key == "tau" else norm(x - y)
            sizes = self._sizes_of_tau(batch, subject, reference, lengths) if key == "tau" else lengths[key]
            # A result that is not finite is as far off as can be: an infinite error, of a size that excuses nothing.
            parts.append((_finite_or(errors, np.inf), _finite_or(sizes, 0.0), allowance[key] + other[key]))
        return Difference(*(np.concatenate([x.T for x in of_all]) for of_all in zip(*parts, strict=True)))

    def _sizes_of_tau(
        self, batch: Batch, subject: Evaluation, reference: Evaluation, lengths: Mapping[str, Array]
    ) -> Array:
        """The norms of the vectors that driving forces are components of, (N, nv); of the reference where it has them.

        `lengths` are those of the reference's vectors.
        """
        if not {"f", "n"} <= lengths.keys():
            own = subject.values if {"f", "n"} <= subject.values.keys() else dict(batch.recursion[0].items())
            lengths = {key: norm(own[key]) for key in "fn"}
        joints = [side.tau_joint for side in (reference, subject) if side.tau_joint is not None]
        sizes: Array = np.abs(joints[0] if joints else batch.recursion[0].tau_joint)
        for column, parts in enumerate(self._carriers):
            sizes[:, column] += sum(weight * lengths[key][:, link] for weight, key, link in parts)
        return sizes


def _see(worst: Sequence[Worst], rows: Array, first: int) -> None:
    """Take in the values of consecutive states, (rows, N)."""
    states = rows.argmax(axis=1)
    values = rows[np.arange(len(rows)), states]
    for own, value, state in zip(worst, values.tolist(), states.tolist(), strict=True):
        own.take(value, first + state)


def _at_most(worst: Worst, first: int) -> float:
    """What error / size is more than where the relative error may be larger than the largest so far."""
    worst.take(0.0, first)
    return worst.value * EPS * (1 - SLACK)


def _trusted(limits: Array) -> Array:
    """The limits, in place: 0 for those that have overflowed or lost a bit."""
    lost = limits <= LOST if limits.max() < np.inf else ~((limits > LOST) & (limits < np.inf))
    np.copyto(limits, 0.0, where=lost)
    return limits


def _see_whole(worst: Worst, x: Array, y: Array, rows: Difference, first: int) -> None:
    """Take in the relative errors of consecutive states in the norm over all places; x and y are (N, places, ...).

    Squares of the norms at each place say in which states it may be larger than the largest so far.
    """
    sides = rows.error, y.T if y.ndim == 2 else rows.size  # driving forces have other sizes in their rows
    error, size = (np.einsum("ij,ij->j", side, side) for side in sides)
    states = np.flatnonzero(error >= _trusted(np.square(_at_most(worst, first)) * size))
    states = states[rows.error[:, states].any(axis=0)]
    if len(states):
        x, y = (side[states].reshape(len(states), -1) for side in (x, y))
        whole = Difference(_finite_or(norm(x - y), np.inf), norm(y), norm(rows.tolerance[:, states].T))
        k = int(np.argmax(values := whole.known_relative))
        worst.take(float(values[k]), first + int(states[k]))


def farthest_of(rows: Iterable[Row]) -> Row:
    """The row that comes closest to its tolerance, or lies furthest beyond."""
    return max(rows, key=lambda row: row.of_tolerance.value)


def with_allowance(batch: Batch, evaluation: Evaluation) -> Evaluation:
    """The result with what rounding may make of it, by default of a program of which nothing is known."""
    return evaluation if evaluation.allowance is not None else replace(evaluation, allowance=default_allowance(batch))


def _allowance(batch: Batch, evaluation: Evaluation) -> Mapping[str, Array]:
    """What rounding may make of a result; what is not finite excuses nothing."""
    return {key: _finite_or(x, 0.0) for key, x in (with_allowance(batch, evaluation).allowance or {}).items()}


def _finite_or(values: Array, otherwise: float) -> Array:
    """Values that are not negative, and something else for what is not finite."""
    return values if values.max(initial=0.0) < np.inf else np.where(np.isfinite(values), values, otherwise)


def ratio(part: Array, whole: Array) -> Array:
    """The quotient part / whole; 0 where part is 0, inf where only whole is."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        quotient = part / whole
    if quotient.size and np.isnan(quotient.max()):
        unknown = np.isnan(quotient)
        quotient[unknown] = np.where(part[unknown] == 0.0, 0.0, np.inf)
    return quotient


def labels(model: Model) -> Iterator[tuple[str, str, str]]:
    """Quantity, place and unit of each row."""
    for joint in model.moving:
        for name, rotates in zip(joint.v_labels(), joint.type.rotations, strict=True):
            yield "tau", name, "N m" if rotates else "N"
    for key in LINK_QUANTITIES:
        for name in model.link_names:
            yield key, name, "N" if key in ("F", "f") else "N m"
