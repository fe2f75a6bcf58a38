"""When two numbers of two descriptions are one number: written in doubles, or with few digits."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model

DOUBLES = 1e-12
"""Relative: what is computed in another order differs by less."""

PRINTED = 5e-6
"""Relative: what is printed with six digits differs by less."""

DECIMALS = range(5, 9)
"""Places behind the point that a program writes, so that small numbers have few digits."""


class Level(NamedTuple):
    """How two numbers differ.

    Attributes:
        size: the difference, relative to what it is measured by.
        printed: whether it is more than doubles leave, and not more than digits that were printed.
        beyond: whether it is more than that.
    """

    size: float
    printed: bool
    beyond: bool

    @property
    def differs(self) -> bool:
        """Whether doubles do not explain it."""
        return self.printed or self.beyond


UNLIKE = Level(1.0, False, True)
"""Of what is no number."""


@dataclass(frozen=True, slots=True)
class Tolerance:
    """What is rounding.

    Attributes:
        size: of the robot [m].
        places: half a unit of the last place behind the point that one of the files has, or 0.
    """

    size: float
    places: float = 0.0

    @classmethod
    def of(cls, a: Model, b: Model, size: float) -> Tolerance:
        """For two models, of which one may be an export with so many places behind the point."""
        x, y = sorted((places(a), places(b)))
        return cls(size, 0.5 * 10.0**-x if x in DECIMALS and y > x else 0.0)

    def level(self, difference: float, scale: float, count: float = 1.0) -> Level:
        """Of a difference, in terms of a scale; `count` numbers with a last place of their own may add up."""
        if difference == 0.0 or not math.isfinite(difference):
            return Level(abs(difference), False, difference != 0.0)
        size = difference / scale if scale else math.inf
        printed = difference <= count * max(PRINTED * scale, self.places) * (1 + 1e-6)
        exact = difference <= DOUBLES * scale
        return Level(size, printed and not exact, not printed)

    def number(self, x: float, y: float, least: float = 0.0) -> Level:
        """Of two numbers."""
        if x == y:
            return Level(0.0, False, False)
        return self.level(abs(x - y), max(abs(x), abs(y), least))

    def length(self, x: Array, y: Array) -> Level:
        """Of two vectors [m]."""
        scale = max(float(np.linalg.norm(x)), float(np.linalg.norm(y)), 0.1 * self.size)
        return self.level(float(np.linalg.norm(x - y)), scale, 2.0)

    def tensor(self, x: Array, y: Array, masses: Iterable[float] = ()) -> Level:
        """Of two tensors about centres of mass, whose members may lie apart by the size of the robot [kg m^2]."""
        scale = max(float(np.linalg.norm(x)), float(np.linalg.norm(y)))
        difference = float(np.linalg.norm(x - y))
        lever = max((abs(m) for m in masses), default=0.0) * self.size**2
        return (
            Level(difference / scale if scale else 0.0, False, False)
            if difference <= 1e-14 * lever
            else self.level(difference, scale, 4.0)
        )

    def turn(self, x: Array, y: Array) -> Level:
        """Of two rotations [rad]."""
        return self.level(float(np.linalg.norm(x - y)) / math.sqrt(2.0), 1.0, 3.0)

    def direction(self, x: Array, y: Array) -> Level:
        """Of two axes [rad], whatever their sign."""
        return self.level(float(min(np.linalg.norm(x - y), np.linalg.norm(x + y))), 1.0, 2.0)


def places(model: Model) -> int:
    """How many places behind the point the masses, centres and positions of a model have; 17 for more than eight."""
    numbers = [x for link in model.links for x in (link.mass, *link.com)]
    numbers += [x for joint in model.joints for x in joint.p]
    return next((k for k in range(DECIMALS.stop) if all(round(x, k) == x for x in numbers)), 17)
