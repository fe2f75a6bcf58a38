"""How far a set of hypotheses goes: its numbers fitted, then every state computed as the program under it would."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import islice, product

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.diagnosis.engine.evidence import Evidence, results
from rttrr_pin.diagnosis.engine.minimax import minimax
from rttrr_pin.diagnosis.engine.predictions import applied, jacobian, predicted_all
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Variant

CLOSE = 4.0
"""A fit whose largest error is less than so many times what rounding explains is fitted in the largest error too."""

COMBINED = 64
"""Of sets that are alike on the sample, so many are computed on all states."""

EQUATIONS = 3
"""Results for each fitted number, at least."""

ITERATIONS = 8
"""Of a fit, which is nearly linear."""


@dataclass(frozen=True, slots=True, eq=False)
class Explanation:
    """A set of hypotheses, and how far it goes.

    Attributes:
        hypotheses: the set.
        numbers: the fitted numbers of all, one after the other.
        worst: the largest error / tolerance that is left.
        left: the part of the difference that is left, root mean square, each number on its own scale.
        alike: for each hypothesis others that would do the same.
    """

    hypotheses: tuple[Hypothesis, ...]
    numbers: tuple[float, ...]
    worst: float
    left: float
    alike: tuple[tuple[Hypothesis, ...], ...] = ()

    @property
    def explains(self) -> bool:
        """Whether what is left is rounding."""
        return self.worst <= 1.0

    @property
    def fitted(self) -> int:
        """How many numbers are fitted."""
        return len(self.numbers)

    @property
    def cost(self) -> int:
        """What it takes to say it: a fitted number as much as two hypotheses."""
        return len(self.hypotheses) + 2 * self.fitted

    def numbers_of(self, k: int) -> tuple[float, ...]:
        """The fitted numbers of one hypothesis."""
        first = sum(len(own.start) for own in self.hypotheses[:k])
        return self.numbers[first : first + len(self.hypotheses[k].start)]


@dataclass(frozen=True, slots=True, eq=False)
class Fitting:
    """Sets of hypotheses against the evidence.

    Attributes:
        base: the reference.
        evidence: all states.
        sample: some of them, on which a set is tried first.
        scale: of each number, by which differences are compared, (numbers,).
    """

    base: Variant
    evidence: Evidence
    sample: Evidence
    scale: Array

    def on_all(self, fit: Explanation, alike: tuple[tuple[Hypothesis, ...], ...]) -> Explanation:
        """What explains the sample, on all states; of those that are alike on the sample, those that are so on all."""
        slots = [(own, *others) for own, others in zip(fit.hypotheses, alike, strict=True)]
        sets = islice(product(*slots), COMBINED)
        first = next((own for own in (self._of_all(one, fit) for one in sets) if own.explains), None)
        if first is None:
            return replace(self._of_all(fit.hypotheses, fit), alike=alike)
        kept = []
        for k, (slot, chosen) in enumerate(zip(slots, first.hypotheses, strict=True)):
            before, after = first.hypotheses[:k], first.hypotheses[k + 1 :]
            others = [own for own in slot if own is not chosen]
            kept.append(tuple(own for own in others if self._of_all((*before, own, *after)).explains))
        return replace(first, alike=tuple(kept))

    def _of_all(self, hypotheses: tuple[Hypothesis, ...], known: Explanation | None = None) -> Explanation:
        """A set on all states, its numbers fitted to the sample first."""
        fit = known if known is not None and known.hypotheses == hypotheses else self.fit(hypotheses, self.sample)
        if not fit.explains or len(self.evidence.batch) == len(self.sample.batch):
            return fit
        return self.fit(hypotheses, self.evidence, fit.numbers)

    def fit(
        self, hypotheses: tuple[Hypothesis, ...], evidence: Evidence, start: Sequence[float] | None = None
    ) -> Explanation:
        """Fit the numbers of a set by Gauss-Newton, each equation over its tolerance; round them where one may."""
        neutral = [x for own in hypotheses for x in own.neutral]
        towards = [x for own in hypotheses for x in own.start]
        numbers = [*(neutral if start is None else start)]
        weight = 1.0 / np.maximum(evidence.tolerance + evidence.rounding, np.finfo(float).tiny)
        weight /= weight.max()
        best = self.judged(hypotheses, numbers, evidence)
        for k in range(ITERATIONS if numbers else 0):
            aim = towards if k == 0 and start is None else numbers
            base, J = jacobian(self.base, hypotheses, numbers, aim, evidence)
            rest = ((evidence.values - base) * weight).ravel()
            if not (np.isfinite(J).all() and np.isfinite(rest).all()):
                break
            step = np.linalg.lstsq((J * weight.ravel()).T, rest, rcond=None)[0]
            numbers = [x + float(dx) for x, dx in zip(numbers, step, strict=True)]
            after = self.judged(hypotheses, numbers, evidence)
            stuck = k > 1 and after.left > 0.5 * best.left
            best = min(after, best, key=lambda own: (own.left, own.worst)) if k else after
            if best.explains or stuck:
                break
        if numbers and 1.0 < best.worst < CLOSE:
            best = min(best, self._closer(best, evidence), key=lambda own: own.worst)
        return self._rounded(best, evidence) if best.explains and numbers else best

    def _closer(self, own: Explanation, evidence: Evidence) -> Explanation:
        """The same fitted in the largest error."""
        base, J = jacobian(self.base, own.hypotheses, own.numbers, own.numbers, evidence)
        bound = np.maximum(evidence.tolerance + evidence.rounding, np.finfo(float).tiny)
        step = minimax(J, (evidence.values - base).ravel(), bound.ravel())
        if step is None:
            return own
        return self.judged(own.hypotheses, [x + float(dx) for x, dx in zip(own.numbers, step, strict=True)], evidence)

    def _rounded(self, own: Explanation, evidence: Evidence) -> Explanation:
        """The same with numbers of few digits, where they explain it as well."""
        for digits in (2, 3, 4, 6, 9):
            numbers = [float(f"{x:.{digits}g}") for x in own.numbers]
            other = self.judged(own.hypotheses, numbers, evidence)
            if other.explains and other.left <= 2.0 * own.left:
                return other
        return own

    def judged(self, hypotheses: tuple[Hypothesis, ...], numbers: Sequence[float], evidence: Evidence) -> Explanation:
        """How far a set goes."""
        return self.judged_all(hypotheses, [numbers], evidence)[0]

    def judged_all(
        self, hypotheses: tuple[Hypothesis, ...], every: Sequence[Sequence[float]], evidence: Evidence
    ) -> list[Explanation]:
        """How far a set goes with each of several choices of its numbers."""
        computed = predicted_all([applied(self.base, hypotheses, numbers) for numbers in every], evidence)
        return [self._of_values(hypotheses, x, values, evidence) for x, values in zip(every, computed, strict=True)]

    def _of_values(
        self, hypotheses: tuple[Hypothesis, ...], numbers: Sequence[float], values: Array, evidence: Evidence
    ) -> Explanation:
        """How far a set goes that computes these results."""
        worst = float(evidence.of_tolerance(values, evidence.rounding_at(values)).max(initial=0.0))
        if numbers and EQUATIONS * len(numbers) > results(evidence):
            worst = np.inf  # so many numbers explain anything
        with np.errstate(over="ignore", invalid="ignore"):
            sizes = [float(np.linalg.norm(x / self.scale)) for x in (evidence.values - values, evidence.difference)]
        left = sizes[0] / sizes[1] if sizes[1] else 0.0
        return Explanation(hypotheses, tuple(numbers), worst, left if np.isfinite(left) else np.inf)
