"""Two results side by side: how far apart, and whether rounding can explain it.

The gate, for each state, quantity and link (or joint):

    |ours - oracle| <= |bound| + (|bound of x| + 4 eps |x| + cancelled)

with Euclidean norms. `bound` is the running error bound on our own rounding (`enclose.rounding`). The bracket is the
oracle's allowance. It adds up the same terms in another order and in other axes, so it gets the same bound once more,
but for the whole vector x that the quantity belongs to: F, N, f or n of the link itself, and for tau the n of the
joint (its f, where it slides), of which tau is one component. In other axes an error of one component is an error of
all. The 4 eps are for the rounding of what is handed to the oracle; `cancelled` is the rounding of terms that only the
oracle's formulas have and that cancel in its result (`oracles.Evaluation.rounding`). Where the oracle bounds the
rounding of its own driving forces, that bound is the bracket.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.scalars import EPS
from rttrr_pin.core.wrench import LINK_QUANTITIES, QUANTITIES, LinkWrenches
from rttrr_pin.implementations import Evaluation

HANDOVER = 4 * EPS
"""Relative: payloads, placements and angles are rounded on their way into the oracle's conventions."""


@dataclass(slots=True)
class Worst:
    """The largest value seen, and the state it was seen in."""

    value: float = 0.0
    state: int = -1

    def see(self, values: Array, first: int) -> None:
        """Take in the values of consecutive states; the earliest of equals stays."""
        if len(values):
            k = int(np.argmax(values))
            if values[k] > self.value or self.state < 0:
                self.value, self.state = float(values[k]), first + k


ADJUDICATED = 10
"""Failing states that are remembered, the worst."""


@dataclass(slots=True)
class Ranking:
    """Which states to look at again.

    Attributes:
        failing: how many lie outside the gate.
        worst: those that lie farthest outside, worst first, at most `ADJUDICATED`: share and state.
        passing: the state within the gate that comes closest to it.
    """

    failing: int = 0
    worst: list[tuple[float, int]] = field(default_factory=list)
    passing: Worst = field(default_factory=Worst)

    def see(self, shares: Array, first: int) -> None:
        """Take in the largest share of each of consecutive states."""
        outside = np.flatnonzero(shares > 1.0)
        self.failing += len(outside)
        found = self.worst + [(float(shares[k]), first + int(k)) for k in outside]
        self.worst = sorted(found, key=lambda pair: (-pair[0], pair[1]))[:ADJUDICATED]
        if len(outside) < len(shares):
            k = int(np.argmax(np.where(shares > 1.0, -1.0, shares)))
            self.passing.see(shares[k : k + 1], first + k)

    def chosen(self) -> list[int]:
        """The worst failing states, then the worst passing one."""
        return [state for _, state in self.worst] + [self.passing.state] * (self.passing.state >= 0)


@dataclass(slots=True)
class Row:
    """What was seen of one quantity at one link or joint.

    Attributes:
        quantity: tau, F, N, f or n.
        at: name of the link (of the joint for tau).
        unit: of the quantity.
        absolute: largest |ours - oracle| in that unit.
        relative: largest |ours - oracle| / |oracle| in eps. For tau the divisor is the norm of the joint's n (of its
            f, where it slides), of which tau is one component.
        share: largest |ours - oracle| as a share of what the gate allows.
        failures: states outside the gate.
    """

    quantity: str
    at: str
    unit: str
    absolute: Worst = field(default_factory=Worst)
    relative: Worst = field(default_factory=Worst)
    share: Worst = field(default_factory=Worst)
    failures: int = 0

    @property
    def passed(self) -> bool:
        """Whether every state lies within the gate."""
        return self.failures == 0


@dataclass(frozen=True, slots=True)
class Gap:
    """One quantity at one link over consecutive states, (N,) each.

    Attributes:
        difference: |ours - oracle|.
        size: |oracle|.
        own: what our rounding may make of it.
        allowance: what the oracle's may.
    """

    difference: Array
    size: Array
    own: Array
    allowance: Array

    @property
    def allowed(self) -> Array:
        """The gate."""
        return self.own + self.allowance

    @property
    def relative(self) -> Array:
        """|ours - oracle| / |oracle| in eps; 0 where they are equal."""
        return ratio(self.difference, self.size * EPS)

    @property
    def share(self) -> Array:
        """|ours - oracle| as a share of what is allowed; 0 where they are equal."""
        return ratio(self.difference, self.allowed)


class Comparison:
    """Gathers the worst over any number of states, in memory that does not grow with them.

    Attributes:
        rows: of each quantity at each link or joint.
        whole: by quantity, the largest |ours - oracle| / |oracle| in eps, in the norm over all links or joints.
    """

    def __init__(self, model: Model, quantities: Sequence[str] = QUANTITIES) -> None:
        """Prepare to compare the quantities that an oracle gives."""
        self.rows = [Row(*labels) for labels in _labels(model) if labels[0] in quantities]
        self.whole = {quantity: Worst() for quantity in quantities}
        self._shares = _shares(model)

    def add(self, first: int, ours: LinkWrenches, oracle: Evaluation, bound: LinkWrenches) -> Array:
        """Take in the results of consecutive states, (N, ...) each; return the largest share of each state, (N,)."""
        shares = np.zeros(len(ours.tau))
        for row, gap in zip(self.rows, self.gaps(ours, oracle, bound), strict=True):
            share = gap.share
            row.absolute.see(gap.difference, first)
            row.relative.see(gap.relative, first)
            row.share.see(share, first)
            row.failures += int((share > 1.0).sum())
            np.maximum(shares, share, out=shares)
        for quantity, worst in self.whole.items():
            mine, theirs = (getattr(x, quantity).reshape(len(ours.tau), -1) for x in (ours, oracle.wrenches))
            worst.see(ratio(_finite_norm(mine - theirs), EPS * _norm(theirs)), first)
        return shares

    def gaps(self, ours: LinkWrenches, oracle: Evaluation, bound: LinkWrenches) -> Iterator[Gap]:
        """The gap of each row, in the order of `rows`."""
        theirs, cancelled = oracle.wrenches, oracle.rounding
        carrier = theirs if theirs.links else ours  # whose f and n say how large a driving force is
        for column, shares in enumerate(self._shares):
            difference = np.abs(ours.tau[:, column] - theirs.tau[:, column])
            own = np.abs(theirs.tau_joint[:, column])
            size = own + sum(weight * _norm(getattr(carrier, whole)[:, link]) for weight, whole, link in shares)
            mine_bound = np.abs(bound.tau[:, column])
            if "tau" in cancelled:
                yield _gap(difference, mine_bound, size, cancelled["tau"][:, column], handed=0.0)
                continue
            allowance = HANDOVER * own
            for weight, whole, link in shares:
                x_bound = _norm(getattr(bound, whole)[:, link])
                allowance = allowance + weight * (x_bound + cancelled[whole][:, link])
            yield _gap(difference, mine_bound, size, allowance)
        for key in (key for key in LINK_QUANTITIES if key in self.whole):
            for link in range(len(ours.links)):
                mine, their, mine_bound = (getattr(result, key)[:, link] for result in (ours, theirs, bound))
                x_bound = _norm(mine_bound)
                yield _gap(_norm(mine - their), x_bound, _norm(their), x_bound + cancelled[key][:, link])


def _gap(difference: Array, bound: Array, x: Array, x_bound: Array, handed: float = HANDOVER) -> Gap:
    difference = np.where(np.isfinite(difference), difference, np.inf)  # as far off as can be
    x = np.where(np.isfinite(x), x, 0.0)  # and must not widen the gate of what else is measured against it
    return Gap(difference, size=x, own=bound, allowance=x_bound + handed * x)


def _finite_norm(vectors: Array) -> Array:
    """The norm; infinite where there is a NaN."""
    norm = _norm(vectors)
    return np.where(np.isfinite(norm), norm, np.inf)


def _norm(vectors: Array) -> Array:
    norm: Array = np.linalg.norm(vectors, axis=-1)
    return norm


def ratio(part: Array, whole: Array) -> Array:
    """The quotient part / whole; 0 where part is 0, inf where only whole is."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(part == 0.0, 0.0, part / whole)
    return np.where(np.isnan(ratio), np.inf, ratio)


Share = tuple[float, str, int]
"""Weight, quantity (f or n) and link of a vector that a driving force is a component of."""


def _shares(model: Model) -> list[list[Share]]:
    """For each degree of freedom the vectors that its driving force is made of: its own, and those of followers."""
    shares: dict[int, list[list[Share]]] = {
        i: [[(1.0, "n" if rotates else "f", i)] for rotates in model.joints[i].type.rotations]
        for i in model.independent
    }
    for i, joint in enumerate(model.joints):
        if joint.mimic is not None:
            weight = abs(joint.mimic.multiplier)
            shares[joint.mimic.joint][0].append((weight, "n" if joint.type.rotates else "f", i))
    return [freedom for i in model.independent for freedom in shares[i]]


def _labels(model: Model) -> Iterator[tuple[str, str, str]]:
    """Quantity, place and unit of each row."""
    for joint in model.moving:
        for label, rotates in zip(joint.v_labels(), joint.type.rotations, strict=True):
            yield "tau", label, "N m" if rotates else "N"
    for quantity, unit in (("F", "N"), ("N", "N m"), ("f", "N"), ("n", "N m")):
        for name in model.link_names:
            yield quantity, name, unit
