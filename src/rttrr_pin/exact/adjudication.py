"""Who is right in one state, ours or the oracle's: each is held against the enclosures of the true values.

The recursion is walked as it runs, outward (F, N of link 1, 2, ...), then inward (n-th link to first: f, n, tau). The
first quantity on this walk that a program has wrong is the one to look at; what is wrong behind it follows from it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import LINK_QUANTITIES, LinkWrenches
from rttrr_pin.exact.enclosures import Enclosures


@dataclass(frozen=True, slots=True)
class Deviation:
    """How far one program is off the true value of one quantity at one place.

    Attributes:
        quantity: tau, F, N, f or n.
        at: name of the link (of the joint for tau).
        eps: distance to the enclosure in eps of the norm of the true vector, which for tau is the n of its joint (the
            f, where it slides); 0 within the enclosure.
        share: the same as a share of what its rounding can explain; it has left its gate where this exceeds 1.
    """

    quantity: str
    at: str
    eps: float
    share: float

    @property
    def wrong(self) -> bool:
        """Whether rounding cannot explain it."""
        return self.share > 1.0

    @property
    def place(self) -> str:
        """Where it is, in words."""
        return f"{self.quantity} of {self.at}"


@dataclass(frozen=True, slots=True)
class Assessment:
    """One program in one state.

    Attributes:
        name: of the program.
        offs: each quantity at each place, in the order of the walk.
    """

    name: str
    deviations: tuple[Deviation, ...]

    @property
    def first(self) -> Deviation | None:
        """Where it is wrong first; None where it is right."""
        return next((off for off in self.deviations if off.wrong), None)

    @property
    def farthest(self) -> Deviation:
        """Where it is off by most eps; the first of equals."""
        return max(self.deviations, key=lambda off: off.eps)

    @property
    def error(self) -> str:
        """How far off it is, in words: where it is wrong first, or by most if it is right."""
        told = self.first or self.farthest
        return f"{format_eps(told.eps)}, first in {told.place}" if self.first else format_eps(told.eps)


@dataclass(frozen=True, slots=True)
class Adjudication:
    """Who is right in one state.

    Attributes:
        state: its index.
        bits: precision of the balls that settled it.
        ours: our recursion in floats.
        theirs: the oracle.
    """

    state: int
    bits: int
    ours: Assessment
    theirs: Assessment

    @property
    def right(self) -> tuple[bool, bool]:
        """Whether ours is, whether the oracle is, within what rounding can explain."""
        return self.ours.first is None, self.theirs.first is None

    @property
    def verdict(self) -> str:
        """Who is right, and where the other is wrong first."""
        sides = (self.ours, self.theirs)
        if all(self.right):
            ours, theirs = (f"by {side.error} ({side.farthest.place})" for side in sides)
            return f"both are right to rounding: {self.ours.name} is off {ours}, {self.theirs.name} {theirs}"
        if not any(self.right):
            ours, theirs = (f"{side.name} by {side.error}" for side in sides)
            return f"both are off: {ours}; {theirs}"
        right, wrong = sides if self.right[0] else sides[::-1]
        return f"{right.name} is right to {right.error}; {wrong.name} is off by {wrong.error}"


def verdict_of(adjudicated: Sequence[Adjudication]) -> str:
    """Who is right in one state that was settled against several oracles, and where the others are wrong first."""
    if len(adjudicated) == 1:
        return adjudicated[0].verdict
    ours = max((one.ours for one in adjudicated), key=lambda side: (side.first is not None, len(side.deviations)))
    sides = [ours, *(one.theirs for one in adjudicated)]
    right, wrong = ([side for side in sides if (side.first is None) == wanted] for wanted in (True, False))
    off = "; ".join(f"{side.name} is off by {side.error}" for side in wrong)
    if not right:
        return f"none is right: {off}"
    if not wrong:
        by = ", ".join(f"{side.name} by {side.error} ({side.farthest.place})" for side in right)
        return f"all are right to rounding: off are {by}"
    *first, last = (side.name for side in right)
    names = f"{', '.join(first)} and {last} are" if first else f"{last} is"
    return f"{names} right to rounding; {off}"


def format_eps(eps: float) -> str:
    """A number of eps, short."""
    return f"{eps:.1f} eps" if eps < 1e4 else f"{eps:.1e} eps"


def nearest(enclosures: Enclosures, computed: LinkWrenches) -> LinkWrenches:
    """Of each enclosure the value that is nearest to a computed one; its middle where there is none."""
    parts = {}
    for key, enclosure in enclosures.items():
        x = enclosure.mid if key in LINK_QUANTITIES and not computed.links else getattr(computed, key)
        parts[key] = np.where(np.isnan(x), enclosure.mid, np.clip(x, enclosure.lower, enclosure.upper))
    return LinkWrenches.of(parts | {"tau_joint": computed.tau_joint}, enclosures.links, computed.joints)


def walk(model: Model) -> Iterator[tuple[str, int]]:
    """Quantities and their places, link or column of tau, in the order in which the recursion completes them.

    A driving force comes with the last of the links that it is made of: its own joint's, and those that follow it.
    """
    for i in range(len(model.links)):
        yield from (("F", i), ("N", i))
    completed: list[list[int]] = [[] for _ in model.links]
    column = 0
    for i in model.independent:
        followers = (k for k, joint in enumerate(model.joints) if joint.mimic is not None and joint.mimic.joint == i)
        completed[min((i, *followers))] += range(column, column + model.joints[i].nv)
        column += model.joints[i].nv
    for i in reversed(range(len(model.links))):
        yield from (("f", i), ("n", i), *(("tau", k) for k in completed[i]))


def in_order(model: Model, deviations: Sequence[Deviation]) -> tuple[Deviation, ...]:
    """From the order of reports (tau, then F, N, f, n, each link by link, or tau alone) to that of the walk."""
    links = len(model.links)
    first = {"tau": 0} | {key: model.nv + k * links for k, key in enumerate(LINK_QUANTITIES)}
    return tuple(deviations[at] for quantity, place in walk(model) if (at := first[quantity] + place) < len(deviations))
