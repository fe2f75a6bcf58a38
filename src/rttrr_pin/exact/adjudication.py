"""Who is right in one state: each program is compared with enclosures of the true values.

The recursion is walked as it runs, outward (F, N of link 1, 2, ...), then inward (n-th link to first: f, n, tau). The
first quantity on this walk that a program has wrong is the one to look at; what is wrong behind it follows from it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.scalars import EPS
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.exact.enclosures import Enclosures


@dataclass(frozen=True, slots=True)
class Deviation:
    """How far one program is off the true value of one quantity at one place.

    Attributes:
        quantity: tau, F, N, f or n.
        at: name of the link (of the joint for tau).
        eps: distance to the enclosure in eps of the norm of the true vector, which for tau is the n of its joint (the
            f, where it slides); 0 within the enclosure.
        of_allowance: the same as a part of what the program's rounding can explain.
        error: the same in the unit of the quantity.
        unit: N or N m.
    """

    quantity: str
    at: str
    eps: float
    of_allowance: float
    error: float
    unit: str

    @property
    def relative(self) -> bool:
        """Whether eps mean anything: not where the true vector is shorter than what rounding can add to it."""
        return self.eps * EPS < self.of_allowance or not 0.0 < self.error < math.inf

    @property
    def wrong(self) -> bool:
        """Whether rounding cannot explain it."""
        return self.of_allowance > 1.0


@dataclass(frozen=True, slots=True)
class Assessment:
    """One program in one state.

    Attributes:
        name: of the program.
        deviations: each quantity at each place, in the order of the recursion.
    """

    name: str
    deviations: tuple[Deviation, ...]

    @property
    def first_wrong(self) -> Deviation | None:
        """Where it is wrong first on the way of the recursion; None where it is right."""
        return next((deviation for deviation in self.deviations if deviation.wrong), None)

    @property
    def right(self) -> bool:
        """Whether rounding can explain all of it."""
        return self.first_wrong is None

    @property
    def farthest(self) -> Deviation:
        """Where it is off by most eps, of where these mean anything; the first of equals."""
        return max(self.deviations, key=lambda deviation: (deviation.relative, deviation.eps))


@dataclass(frozen=True, slots=True)
class Adjudication:
    """Who is right in one state.

    Attributes:
        state: its index.
        bits: precision of the intervals that decided it.
        assessments: each program, the subject first.
    """

    state: int
    bits: int
    assessments: tuple[Assessment, ...]

    @property
    def right(self) -> tuple[Assessment, ...]:
        """The programs that are within their rounding."""
        return tuple(one for one in self.assessments if one.right)

    @property
    def wrong(self) -> tuple[Assessment, ...]:
        """The programs that are not."""
        return tuple(one for one in self.assessments if not one.right)


def nearest(enclosures: Enclosures, computed: Mapping[str, Array]) -> dict[str, Array]:
    """Of each enclosure of a computed quantity the value that is nearest to what was computed; its middle for NaN."""
    pairs = {key: (computed[key], enclosure) for key, enclosure in enclosures.items() if key in computed}
    return {key: np.where(np.isnan(x), own.mid, np.clip(x, own.lower, own.upper)) for key, (x, own) in pairs.items()}


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
    """Deviations by quantity and place, in the order in which the recursion completes them."""
    names = {"tau": model.v_names} | dict.fromkeys(LINK_QUANTITIES, model.link_names)
    order = {(quantity, names[quantity][index]): k for k, (quantity, index) in enumerate(walk(model))}
    return tuple(sorted(deviations, key=lambda one: order[one.quantity, one.at]))
