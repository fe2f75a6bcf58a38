"""The largest value seen, and the states to look at again, of any number of states."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from rttrr_pin.core.arrays import Array


@dataclass(slots=True)
class Worst:
    """The largest value seen, and the state it was seen in."""

    value: float = 0.0
    state: int = -1

    def see(self, values: Array, first: int) -> None:
        """Take in the values of consecutive states; the earliest of equals stays."""
        if len(values):
            k = int(np.argmax(values))
            self.take(float(values[k]), first + k)

    def take(self, value: float, state: int) -> None:
        """Take in the value of one state."""
        if value > self.value or self.state < 0:
            self.value, self.state = value, state


ADJUDICATED = 10
"""Failing states that the exact reference decides, the worst."""


@dataclass(slots=True)
class Ranking:
    """Which states to look at again.

    Attributes:
        failing: how many lie beyond the tolerance.
        worst: those that lie farthest beyond, worst first, at most `ADJUDICATED`: error / tolerance and state.
        passing: the state within the tolerance that comes closest to it.
    """

    failing: int = 0
    worst: list[tuple[float, int]] = field(default_factory=list)
    passing: Worst = field(default_factory=Worst)

    def see(self, ratios: Array, first: int) -> None:
        """Take in the largest error / tolerance of each of consecutive states."""
        beyond = np.flatnonzero(ratios > 1.0)
        self.failing += len(beyond)
        states = self.worst + [(float(ratios[k]), first + int(k)) for k in beyond]
        self.worst = sorted(states, key=lambda pair: (-pair[0], pair[1]))[:ADJUDICATED]
        if len(beyond) < len(ratios):
            k = int(np.argmax(np.where(ratios > 1.0, -1.0, ratios)))
            self.passing.see(ratios[k : k + 1], first + k)

    def chosen(self) -> list[int]:
        """The worst failing states, then the worst passing one."""
        return [state for _, state in self.worst] + [self.passing.state] * (self.passing.state >= 0)
