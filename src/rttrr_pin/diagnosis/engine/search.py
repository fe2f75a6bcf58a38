"""The smallest set of hypotheses that brings a difference down to what rounding explains.

Single hypotheses first, all of them, then pairs, then sets that grow by one. Changes that two hypotheses make are
nearly always additive, so that pairs are ranked by sums of their changes; where they are not (degrees for radians
beside a wrong mass), one hypothesis is tried on top of the other. What ranks first is then computed as it is, and only
what lies within the tolerance in every state is an explanation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from itertools import islice

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.diagnosis.engine.evidence import Evidence, rms, screened, with_worst
from rttrr_pin.diagnosis.engine.fitting import Explanation, Fitting
from rttrr_pin.diagnosis.engine.predictions import (
    Change,
    Raw,
    applied,
    parameter_columns,
    predicted,
    predicted_all,
    raw_changes,
    visible_changes,
)
from rttrr_pin.diagnosis.engine.spans import left_by, left_by_each, pairs, rest_of
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Variant

CONFIRMED = 40
"""So many of the best sets are computed as they are."""

NEAR = 0.5
"""A set is computed only if it leaves less than this part of the difference, or than rounding may leave."""

OUTER = 6
"""On top of so many of the best hypotheses all others are tried."""

FEWER = 3
"""Where hypotheses are tried on top of each convention, on each third state of the sample."""

NOT_KNOWN = np.empty(0)
"""A change that was not computed by itself."""

OUTERMOST = 40
"""On top of so many, those on inertial parameters, whose changes cost little."""

MOST = 4
"""Hypotheses of one set."""

BETTER = 0.1
"""A set grows further only where it leaves less than this part of the difference."""

FEW = 3
"""Fitted numbers of a single hypothesis that say more than a pair does."""

FAR = 100.0
"""Times what rounding explains: a change that leaves more is not computed again."""

FAR_STARTS = (-10.0, -6.0, -3.5, -2.0, -1.0, -0.5, 0.5, 2.0, 3.5, 6.0, 10.0)
"""Times the first step of a number that does not enter linearly: from the best of these its fit begins again."""

NEARER = 0.7
"""It does if that leaves less than this part of the difference."""

LINEAR = 1e-6
"""Relative: a change that far away is as near to so many times the first step is linear."""

HIDDEN = 0.01
"""If the largest difference of the sample is less than this part of the largest, the worst states are taken in."""

FLOOR = 1e-7
"""A number's scale is at least this part of its size: less is not told apart while sets are ranked."""

Progress = Callable[[int], None]


Candidate = tuple[float, tuple[Change, ...]]
"""The part of the difference that is left by ranking, and the changes of a set."""


class Search:
    """Hypotheses against the evidence.

    Attributes:
        evidence: all states.
        base: the reference.
        hypotheses: those that are tried.
        progress: called with the number of hypotheses tried.
        raw: what they change on the sample, where it is known already.
        sample: the states on which they are tried first.
        fitting: fits the numbers of a set.
        near: a set is computed only if it leaves less than this part of the difference; rounding leaves as much.
        tried: how many times one was tried.
        ranked: single hypotheses, by how much of the difference they leave.
    """

    def __init__(
        self,
        evidence: Evidence,
        base: Variant,
        hypotheses: Sequence[Hypothesis],
        progress: Progress | None = None,
        raw: Sequence[Raw] | None = None,
    ) -> None:
        self.evidence, self.base, self.hypotheses, self.progress = evidence, base, hypotheses, progress
        self.raw = raw
        rows = screened(evidence.batch)
        ratios = evidence.of_tolerance(evidence.expected).max(axis=1)
        if ratios[rows].max() < HIDDEN * ratios.max():
            rows, self.raw = with_worst(rows, ratios), None
        self.sample = part = evidence.part(rows)
        self.tried, self.ranked = 0, list[Candidate]()
        seen, allowed, usual = (rms(x) for x in (part.difference, part.tolerance, part.expected))
        scale = np.maximum(np.maximum(seen, allowed), FLOOR * usual)
        self.scale = np.broadcast_to(np.where(scale > 0.0, scale, 1.0), part.values.shape)
        self.fitting = Fitting(base, evidence, part, self.scale[0])
        self.target = (part.difference / self.scale).ravel()
        self.size = float(np.linalg.norm(self.target))
        open_ = float(np.linalg.norm((part.tolerance + part.rounding) / self.scale))
        self.near = max(NEAR, open_ / self.size) if self.size else NEAR

    def run(self) -> list[Explanation]:
        """The explanations that cost least, best first; where there is none, what comes nearest."""
        self.raw = raw_changes(self.base, self.hypotheses, self.sample) if self.raw is None else self.raw
        singles = self._visible(self.raw)
        self.ranked = sorted((self._rank((), one) for one in singles), key=_order)
        best = self.confirmed(self.ranked)
        if not any(own.explains and own.fitted <= FEW for own in best):
            best += self._far(singles)
        if any(own.explains and own.fitted <= FEW for own in best):
            return self._cheapest(best)
        for stage in (self._sums, self._conventions, self._on_top):
            best += self.confirmed(stage(singles))
            if any(own.explains for own in best):
                return self._cheapest(best)
        grown = sorted(best, key=lambda own: own.left)
        for _ in range(MOST - 2):
            grown = [own for own in grown if own.left < BETTER and len(own.hypotheses) > 1][:2]
            grown = sorted(self._grown(grown), key=lambda own: own.left)
            best += grown
            if any(own.explains for own in grown):
                return self._cheapest(best)
        return sorted(best, key=lambda own: (own.left, own.cost))

    def changes_on(self, outer: Variant) -> list[Change]:
        """What each hypothesis changes on top of a program."""
        return self._visible(raw_changes(outer, self.hypotheses, self.sample))

    def _visible(self, raw: Sequence[Raw]) -> list[Change]:
        """Those that can be seen."""
        self.tried += len(self.hypotheses)
        if self.progress is not None:
            self.progress(self.tried)
        return visible_changes(raw, self.sample, self.scale)

    def _rank(self, before: tuple[Change, ...], one: Change, target: Array | None = None) -> Candidate:
        """A hypothesis more, by how much of the difference is left."""
        return left_by(self.target if target is None else target, one) / self.size, (*before, one)

    def _far(self, singles: Sequence[Change]) -> list[Explanation]:
        """Hypotheses with one number that does not enter linearly, fitted from the best of numbers far and near."""
        found = []
        for own in singles:
            hypothesis = own.hypothesis
            if own.fitted != 1 or hypothesis.parameters is not None:
                continue
            (neutral,), (start,) = hypothesis.neutral, hypothesis.start
            numbers = [neutral + times * (start - neutral) for times in FAR_STARTS]
            if self._linear(own, numbers[0]):
                continue
            tried = self.fitting.judged_all((hypothesis,), [(x,) for x in numbers], self.sample)
            best = min(tried, key=lambda one: one.left)
            if best.left < NEARER:
                fit = self.fitting.fit((hypothesis,), self.sample, best.numbers)
                if fit.explains:
                    found.append(self.fitting.on_all(fit, (own.alike,)))
        return found

    def _linear(self, own: Change, number: float) -> bool:
        """Whether a change far away is as many times as large."""
        predicted_there = predicted(own.hypothesis.apply(self.base, (number,)), self.sample)
        change = ((predicted_there - self.sample.expected) / self.scale).ravel()
        expected = own.change[0] * (number - own.hypothesis.neutral[0])
        return bool(np.linalg.norm(change - expected) <= LINEAR * np.linalg.norm(expected))

    def _sums(self, singles: Sequence[Change]) -> list[Candidate]:
        """Pairs by the sum of their changes."""
        found = [(left / self.size, pair) for left, pair in pairs(self.target, singles, 4 * CONFIRMED)]
        return sorted(found, key=_order)

    def _conventions(self, singles: Sequence[Change]) -> list[Candidate]:
        """What alters numbers or the recursion at all links, on top of each convention."""
        outers = [own for own in singles if own.hypothesis.kind == "convention"]
        alone = [(own, variant) for own in outers if (variant := self._alone(own)) is not None]
        if not alone:
            return []
        found: list[Candidate] = []
        variants = [variant for _, variant in alone]
        few_states = self.sample.part(np.arange(0, len(self.sample.batch), FEWER))
        scale = self.scale[: len(few_states.batch)]
        size = float(np.linalg.norm(few_states.difference / scale)) or 1.0
        for own in self.hypotheses:
            if not _general(own) or own.start or own.parameters is not None:
                continue
            applied_to = predicted_all([own.apply(variant, ()) for variant in variants], few_states)
            for (outer, _), values in zip(alone, applied_to, strict=True):
                with np.errstate(invalid="ignore", over="ignore"):
                    left = float(np.linalg.norm((few_states.values - values) / scale)) / size
                if np.isfinite(left):
                    found.append((left, (outer, Change(own, NOT_KNOWN))))
            self.tried += 1
        without = predicted_all(variants, self.sample)
        parts = [(own, own.parameters) for own in self.hypotheses if len(own.start) <= 1]
        few = [(own, direction.ravel()) for own, direction in parts if direction is not None]
        fitted = [len(own.start) for own, _ in few]
        for (outer, _), base, columns in zip(alone, without, parameter_columns(variants, self.sample), strict=True):
            target = ((self.sample.values - base) / self.scale).ravel()
            directions = np.array([direction for _, direction in few]).reshape(len(few), len(columns))
            rows = directions @ (columns / self.scale.ravel())
            for (own, _), row, left in zip(few, rows, left_by_each(target, rows, fitted), strict=True):
                found.append((float(left) / self.size, (outer, Change(own, row[None] if own.start else row))))
        return sorted(found, key=_order)

    def _on_top(self, singles: Sequence[Change]) -> list[Candidate]:
        """On top of those that come nearest by themselves all hypotheses; on top of more, inertial parameters."""
        found: list[Candidate] = []
        for rank, (_, (own,)) in enumerate(self.ranked[:OUTERMOST]):
            variant = self._alone(own)
            if variant is None or (rank >= OUTER and own.hypothesis.parameters is not None):
                continue
            target = ((self.sample.values - predicted(variant, self.sample)) / self.scale).ravel()
            inner = self.changes_on(variant) if rank < OUTER else self._parameters_on(variant)
            found += [self._rank((own,), one, target) for one in inner]
        return sorted(found, key=_order)

    def _parameters_on(self, outer: Variant) -> list[Change]:
        """What hypotheses on inertial parameters change on top of a program."""
        own = [one for one in self.hypotheses if one.parameters is not None]
        return visible_changes(raw_changes(outer, own, self.sample), self.sample, self.scale)

    def _alone(self, own: Change) -> Variant | None:
        """The program under one hypothesis, its numbers fitted as if it were the only one."""
        numbers = self.fitting.fit((own.hypothesis,), self.sample).numbers if own.fitted else ()
        variant = applied(self.base, (own.hypothesis,), numbers)
        return variant if np.isfinite(predicted(variant, self.sample)).all() else None

    def _grown(self, sets: Iterable[Explanation]) -> list[Explanation]:
        """Each set with a hypothesis more."""
        candidates: list[Candidate] = []
        for own in sets:
            variant = applied(self.base, own.hypotheses, own.numbers)
            target = ((self.sample.values - predicted(variant, self.sample)) / self.scale).ravel()
            before = tuple(Change(one, NOT_KNOWN) for one in own.hypotheses)
            candidates += [self._rank(before, one, target) for one in self.changes_on(variant)]
        return self.confirmed(sorted(candidates, key=_order))

    def confirmed(self, candidates: Sequence[Candidate]) -> list[Explanation]:
        """The best candidates, computed as they are; on all states where the sample is explained."""
        found: list[Explanation] = []
        promising = (own for own in candidates if not (len(own[1]) == 1 and found and self._hopeless(own[1][0])))
        for left, own in islice(promising, CONFIRMED):
            if left > self.near and found:
                break
            fit = self.fitting.fit(tuple(one.hypothesis for one in own), self.sample)
            alike = tuple(one.alike for one in own)
            found.append(self.fitting.on_all(fit, alike) if fit.explains else replace(fit, alike=alike))
        return found

    def _hopeless(self, one: Change) -> bool:
        """Whether a change, which is known as it is, leaves far more than rounding."""
        if one.fitted and one.hypothesis.parameters is None:
            return False  # it may not be linear
        rest = self.target - one.change if not one.fitted else rest_of(self.target, one.change)
        allowed = (self.sample.tolerance + self.sample.rounding_at(self.sample.values)) / self.scale
        return bool((np.abs(rest) > FAR * allowed.ravel()).any())

    def _cheapest(self, found: Sequence[Explanation]) -> list[Explanation]:
        """Explanations that cost as little as the cheapest, those that leave least first."""
        explaining = [own for own in found if own.explains]
        least = min(own.cost for own in explaining)
        return sorted((own for own in explaining if own.cost == least), key=lambda own: own.worst)


def _general(own: Hypothesis) -> bool:
    """Whether it alters numbers or the recursion, and is no error of one link."""
    return own.kind in ("parameters", "joint") or (own.kind == "mechanics" and own.link is None and own.joint is None)


def _order(candidate: Candidate) -> tuple[float, int]:
    left, own = candidate
    return round(left, 9), sum(one.fitted for one in own)
