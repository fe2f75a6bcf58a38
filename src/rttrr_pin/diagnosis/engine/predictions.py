"""What each hypothesis would change, at the states on which hypotheses are tried."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rttrr_pin.core.algebra import ZERO, Matrix, Vector
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.dynamics import bodies
from rttrr_pin.core.scalars import FLOAT
from rttrr_pin.diagnosis.engine.evidence import Evidence, flat
from rttrr_pin.diagnosis.engine.side_by_side import Program, evaluate_all, run_all
from rttrr_pin.diagnosis.engine.simultaneous import together
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Values, Variant

ENTRIES = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))
"""The entries of a tensor in the order of the parameters."""

NOTHING = Matrix((ZERO, ZERO, ZERO))


def _entry(r: int, s: int) -> Array:
    """A symmetric matrix with 1 there."""
    unit = np.zeros((3, 3))
    unit[r, s] = unit[s, r] = 1.0
    return unit


UNITS = (
    (1.0, np.zeros(3), np.zeros((3, 3))),
    *((1.0, c, np.outer(c, c) - np.eye(3)) for c in np.eye(3)),  # about the origin they have no tensor
    *((0.0, np.zeros(3), _entry(r, s)) for r, s in ENTRIES),
)
"""Mass, centre of mass and tensor about it, of a body whose parameters are one of the ten, or that and a mass."""

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
    errors = [own.mutation for own in hypotheses if own.mutation is not None]
    wrong = together(errors, outer.model, outer.given(evidence.batch), outer.mutations)
    others = [own for own in hypotheses if own.mutation is None and own.parameters is None]
    steps = {id(own): list(_moved(own.neutral, own.start)) or [((), 1.0)] for own in others}
    variants = [outer, *(own.apply(outer, numbers) for own in others for numbers, _ in steps[id(own)])]
    base, *computed = predicted_all(variants, evidence)
    results = iter(computed)
    any_parameters = any(own.parameters is not None for own in hypotheses)
    columns = parameter_columns([outer], evidence)[0] if any_parameters else np.empty((0, 0))
    found: list[Raw] = []
    for own in hypotheses:
        with np.errstate(invalid="ignore"):
            if own.mutation is not None:
                change = (flat(outer.shown(evidence.batch, next(wrong)), evidence.quantities) - base).ravel()
            elif own.parameters is not None:
                change = own.parameters @ columns
            else:
                rows = [(next(results) - base).ravel() / step for _, step in steps[id(own)]]
                change = np.array(rows) if own.start else rows[0]
        if np.isfinite(change).all():
            found.append((own, change))
    return found


def visible_changes(raw: Sequence[Raw], evidence: Evidence, scale: Array) -> list[Change]:
    """The changes that can be seen, each number divided by its scale; of equal ones the first stands for all."""
    least, divisor = (evidence.tolerance + evidence.rounding).ravel(), scale.ravel()
    seen = [Change(own, change / divisor) for own, change in raw if (np.abs(change) > least).any()]
    # beside a difference of 1e200 a change is nothing, and has no direction
    return _distinct([own for own in seen if 0.0 < np.linalg.norm(own.change) < np.inf])


def predicted(variant: Variant, evidence: Evidence) -> Array:
    """What a program computes at the states, (N, numbers)."""
    return flat(variant.evaluate(evidence.batch), evidence.quantities)


def predicted_all(variants: Sequence[Variant], evidence: Evidence) -> list[Array]:
    """What each of several programs computes at the states, (N, numbers)."""
    return [flat(values, evidence.quantities) for values in evaluate_all(variants, evidence.batch)]


def jacobian(
    outer: Variant,
    hypotheses: Sequence[Hypothesis],
    at: Sequence[float],
    towards: Sequence[float],
    evidence: Evidence,
) -> tuple[Array, Array]:
    """The results, (N, numbers), and by secants how they change with each fitted number, (fitted, numbers)."""
    steps = list(_moved(at, towards))
    programs = [applied(outer, hypotheses, numbers) for numbers in (at, *(numbers for numbers, _ in steps))]
    base, *values = predicted_all(programs, evidence)
    rows = [(own - base).ravel() / step for own, (_, step) in zip(values, steps, strict=True)]
    return base, np.array(rows).reshape(len(at), -1)


def _moved(at: Sequence[float], towards: Sequence[float]) -> Iterator[tuple[tuple[float, ...], float]]:
    """The numbers with one of them moved, and by how much, one after the other."""
    for k, (x, y) in enumerate(zip(at, towards, strict=True)):
        step = y - x or 1e-6 * max(1.0, abs(x))
        yield (*at[:k], x + step, *at[k + 1 :]), step


def applied(outer: Variant, hypotheses: Sequence[Hypothesis], numbers: Sequence[float]) -> Variant:
    """The program under several hypotheses, with the fitted numbers of all of them."""
    first = 0
    for own in hypotheses:
        count = len(own.start)
        outer = own.apply(outer, tuple(numbers[first : first + count]))
        first += count
    return outer


def parameter_columns(outers: Sequence[Variant], evidence: Evidence) -> list[Array]:
    """The change by each inertial parameter on top of each program, (10 links, numbers).

    In the order of `Robot.inertial_parameters`. Of a robot that has one body alone, whose parameter is 1: no
    difference of large numbers.
    """
    programs: list[Program] = []
    for outer in outers:
        bare = replace(outer.given(evidence.batch), loads=())
        alone = outer.model.without_joint_effects()
        empty = [replace(own, M=0.0, r_C=ZERO, I=NOTHING) for own in bodies(outer.model, FLOAT)]
        for i, body in enumerate(empty):
            for m, c, tensor in UNITS:
                links = [*empty[:i], replace(body, M=m, r_C=Vector.of(c), I=Matrix.of(tensor)), *empty[i + 1 :]]
                programs.append(Program(alone, links, bare, outer.mutations))
    results = iter(run_all(programs))
    whole = iter(evaluate_all([replace(own, outputs=()) for own in outers if own.outputs], evidence.batch))
    found = []
    for outer in outers:
        own = [_of_unit(next(results) for _ in UNITS) for _ in outer.model.links]
        columns = [values for link in own for values in link]
        base = next(whole) if outer.outputs else None
        found.append(np.array([_shown(outer, values, base, evidence).ravel() for values in columns]))
    return found


def _of_unit(results: Iterator[Values]) -> list[Values]:
    """The ten columns of a link: a first moment is what a mass beside the origin has more than one in it."""
    of_mass, *others = results
    moments = [{key: x - of_mass[key] for key, x in own.items()} for own in others[:3]]
    return [of_mass, *moments, *others[3:]]


def _shown(outer: Variant, change: Values, base: Values | None, evidence: Evidence) -> Array:
    """The change of what a program shows, which need not be linear in what it computes."""
    if base is None:
        return flat(change, evidence.quantities)
    moved = outer.shown(evidence.batch, {key: base[key] + x for key, x in change.items()})
    return flat(moved, evidence.quantities) - flat(outer.shown(evidence.batch, base), evidence.quantities)


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
