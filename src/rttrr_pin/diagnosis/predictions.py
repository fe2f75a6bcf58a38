"""What each hypothesis would change, at the states on which hypotheses are tried."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Link, Model
from rttrr_pin.diagnosis.evidence import Evidence, flat, joined, shape_of_loads
from rttrr_pin.diagnosis.hypothesis import Hypothesis
from rttrr_pin.diagnosis.mutations import Mutation
from rttrr_pin.diagnosis.simultaneous import together
from rttrr_pin.diagnosis.variant import Values, Variant, run
from rttrr_pin.implementations.protocol import Batch

TENSORS = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))
"""The entries of a tensor in the order of the parameters."""

MARKED = 1e-6
"""Relative: only changes whose projections on one random direction are as near are compared number by number."""

ALIKE = 1e-9
"""Relative: changes no farther apart are of hypotheses that these states cannot tell apart."""


@dataclass(frozen=True, slots=True, eq=False)
class Change:
    """What a hypothesis would change.

    Attributes:
        hypothesis: whose.
        change: without fitted numbers, (numbers,) the change itself; else (fitted, numbers), by each number.
        alike: other hypotheses that would change the same.
    """

    hypothesis: Hypothesis
    change: Array
    alike: tuple[Hypothesis, ...] = ()

    @property
    def fitted(self) -> int:
        """How many numbers are fitted."""
        return len(self.hypothesis.start)


Raw = tuple[Hypothesis, Array]
"""A hypothesis and its change, (numbers,) or (fitted, numbers), in the units of the numbers."""


def raw_changes(outer: Variant, hypotheses: Sequence[Hypothesis], evidence: Evidence) -> list[Raw]:
    """What each hypothesis changes on top of a program, whatever was seen; those that do not compute are left out."""
    base = predicted(outer, evidence)
    columns: Array | None = None
    errors = [own.mutation for own in hypotheses if own.mutation is not None]
    wrong = together(errors, outer.model, outer.given(evidence.batch), outer.mutations)
    found: list[Raw] = []
    for own in hypotheses:
        if own.mutation is not None:
            values = flat(_through(outer, evidence.batch, next(wrong)), evidence.quantities)
            with np.errstate(invalid="ignore"):
                change = (values - base).ravel()
        elif own.parameters is not None:
            if columns is None:
                columns = parameter_columns(outer, evidence)
            change = own.parameters @ columns
        elif own.start:
            change = jacobian(outer, [own], own.neutral, own.start, evidence, base)
        else:
            with np.errstate(invalid="ignore"):
                change = (predicted(own.apply(outer, ()), evidence) - base).ravel()
        if np.isfinite(change).all():
            found.append((own, change))
    return found


def visible_changes(raw: Sequence[Raw], evidence: Evidence, scale: Array) -> list[Change]:
    """The changes that can be seen, each number divided by its scale; of equal ones the first stands for all."""
    least, divisor = (evidence.tolerance + evidence.rounding).ravel(), scale.ravel()
    return _distinct([Change(own, change / divisor) for own, change in raw if (np.abs(change) > least).any()])


def predicted(variant: Variant, evidence: Evidence) -> Array:
    """What a program computes at the states, (N, numbers)."""
    return flat(variant.evaluate(evidence.batch), evidence.quantities)


def jacobian(
    outer: Variant,
    hypotheses: Sequence[Hypothesis],
    at: Sequence[float],
    towards: Sequence[float],
    evidence: Evidence,
    base: Array,
) -> Array:
    """By secants, how the results change with each fitted number, (fitted, numbers); `base` is what they are there."""
    rows = []
    for k, (x, y) in enumerate(zip(at, towards, strict=True)):
        step = y - x or 1e-6 * max(1.0, abs(x))
        moved = [*at]
        moved[k] = x + step
        rows.append((predicted(applied(outer, hypotheses, moved), evidence) - base).ravel() / step)
    return np.array(rows).reshape(len(at), -1)


def applied(outer: Variant, hypotheses: Sequence[Hypothesis], numbers: Sequence[float]) -> Variant:
    """The program under several hypotheses, with the fitted numbers of all of them."""
    first = 0
    for own in hypotheses:
        count = len(own.start)
        outer = own.apply(outer, tuple(numbers[first : first + count]))
        first += count
    return outer


def parameter_columns(outer: Variant, evidence: Evidence) -> Array:
    """The change by each inertial parameter, (10 links, numbers), in the order of `Robot.inertial_parameters`."""
    return Stack([outer], evidence).parameter_columns()[0]


def _through(outer: Variant, batch: Batch, values: Values) -> Values:
    for own in outer.outputs:
        values = own(batch, values)
    return values


def _of_bodies(model: Model, batch: Batch, mutations: Sequence[Mutation]) -> Iterator[Values]:
    """What a unit of each parameter of each link gives: of mass, first moment and tensor about the origin.

    Of a robot that has this one body alone: no difference of large numbers.
    """
    alone = model.without_joint_effects()

    def of(i: int, m: float, c: Array, J: Array) -> Values:
        links = [Link(own.name) for own in model.links]
        links[i] = Link(links[i].name, m, c, J)
        return run(replace(alone, links=tuple(links)), batch, mutations)

    nothing, none = np.zeros(3), np.zeros((3, 3))
    for i in range(len(model.links)):
        of_mass = of(i, 1.0, nothing, none)
        yield of_mass
        for c in np.eye(3):
            centred = of(i, 1.0, c, -(np.eye(3) - np.outer(c, c)))  # about the origin it has no tensor
            yield {key: x - of_mass[key] for key, x in centred.items()}
        for r, s in TENSORS:
            J = none.copy()
            J[r, s] = J[s, r] = 1.0
            yield of(i, 0.0, nothing, J)


def _distinct(found: list[Change]) -> list[Change]:
    """One for all that change the same; with a fitted number, that change it in the same direction."""
    kept: list[Change] = []
    marked: dict[tuple[int, int, int], list[int]] = {}
    rng = np.random.default_rng(0)
    weights: dict[int, Array] = {}
    for own in found:
        direction = own.change.ravel() / (np.linalg.norm(own.change) if own.fitted == 1 else 1.0)
        weight = weights.setdefault(direction.size, rng.standard_normal(direction.size))
        mark = round(math.log(abs(float(direction @ weight)) + np.finfo(float).tiny) / MARKED)
        near = [k for step in (-1, 0, 1) for k in marked.get((own.fitted, direction.size, mark + step), ())]
        same = next((k for k in near if _same(direction, kept[k])), None)
        if same is None:
            marked.setdefault((own.fitted, direction.size, mark), []).append(len(kept))
            kept.append(own)
        else:
            kept[same] = replace(kept[same], alike=(*kept[same].alike, own.hypothesis))
    return kept


def _same(direction: Array, other: Change) -> bool:
    """Whether a change is another's, where a number is fitted but for its size and sign."""
    y = other.change.ravel()
    if y.size != direction.size:
        return False
    if other.fitted == 1:
        y = y / np.linalg.norm(y)
        y = y if direction @ y > 0.0 else -y
    return bool(np.linalg.norm(direction - y) <= ALIKE * np.linalg.norm(y))


class Stack:
    """Programs that differ in input and output alone, evaluated together."""

    def __init__(self, outers: Sequence[Variant], evidence: Evidence) -> None:
        self.outers, self.evidence = outers, evidence
        self.given = [own.given(evidence.batch) for own in outers]
        groups: dict[tuple[tuple[int, bool], ...], list[int]] = {}
        for k, batch in enumerate(self.given):
            groups.setdefault(shape_of_loads(batch), []).append(k)
        self.groups = [(members, joined([self.given[k] for k in members])) for members in groups.values()]

    def predicted(self, hypothesis: Hypothesis, base: Variant) -> list[Array]:
        """What each of them computes under a hypothesis that alters numbers or the recursion, (N, numbers) each."""
        own = hypothesis.apply(base, ())
        out: list[Array] = [np.empty(0)] * len(self.outers)
        for members, batch in self.groups:
            values = run(own.model, batch, own.mutations)
            for place, k in enumerate(members):
                out[k] = self._shown(k, self._slice(values, place))
        return out

    def parameter_columns(self) -> list[Array]:
        """The change by each inertial parameter, of each of them, (10 links, numbers)."""
        first = self.outers[0]
        rows: list[list[Array]] = [[] for _ in self.outers]
        for members, batch in self.groups:
            base = run(first.model, batch, first.mutations)
            before = [self._slice(base, place) for place in range(len(members))]
            shown = [self._shown(k, own) for k, own in zip(members, before, strict=True)]
            for values in _of_bodies(first.model, replace(batch, loads=()), first.mutations):
                for place, k in enumerate(members):
                    own = self._slice(values, place)
                    if self.outers[k].outputs:  # which need not be linear
                        own = {key: before[place][key] + x for key, x in own.items()}
                        rows[k].append((self._shown(k, own) - shown[place]).ravel())
                    else:
                        rows[k].append(flat(own, self.evidence.quantities).ravel())
        return [np.array(own) for own in rows]

    def _slice(self, values: Values, place: int) -> Values:
        """The part of one program."""
        rows = len(self.evidence.batch)
        return {key: x[place * rows : (place + 1) * rows] for key, x in values.items()}

    def _shown(self, k: int, values: Values) -> Array:
        """What a program makes of its results."""
        return flat(_through(self.outers[k], self.evidence.batch, values), self.evidence.quantities)
