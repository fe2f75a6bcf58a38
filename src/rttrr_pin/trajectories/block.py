"""What a trajectory gives: blocks of rows, and what was derived of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.payload import Load
from rttrr_pin.errors import listed


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Consecutive rows of a trajectory.

    Attributes:
        start: index of the first row among those that the trajectory gives.
        rows: line or row of each in the file, as a message names it, (N,).
        time: strictly increasing over all blocks, (N,) [s].
        q: coordinates, (N, nq) [rad or m].
        v: rates, (N, nv).
        a: accelerations, (N, nv).
        payload: wrenches (N, 3), where the file has columns of them.
        errors: (N, nv, 3, 3): the lower triangular L of the covariance L L^T of the error of (q, v, a) of each degree
            of freedom, where v or a were derived; errors of two degrees of freedom are independent. None where all
            were given.
    """

    start: int
    rows: NDArray[np.int64]
    time: Array
    q: Array
    v: Array
    a: Array
    payload: tuple[Load, ...] = ()
    errors: Array | None = None

    def __len__(self) -> int:
        return len(self.time)

    def part(self, which: slice) -> Block:
        """Some consecutive rows."""
        first = self.start + range(len(self))[which].start
        q, v, a = (x[which] for x in (self.q, self.v, self.a))
        loads = tuple(load.block(which) for load in self.payload)
        errors = None if self.errors is None else self.errors[which]
        return Block(first, self.rows[which], self.time[which], q, v, a, loads, errors)


@dataclass(frozen=True, slots=True)
class Differentiation:
    """What was derived, and how well it is known.

    Attributes:
        derived: "v, a" or "a".
        source: what it was derived from: "q" or "v".
        names: of the degrees of freedom.
        cutoff: by degree of freedom the lowest and the highest frequency that the splines let pass [Hz].
        noise: by degree of freedom the standard deviation of the noise of the source.
        error: by degree of freedom the root mean square of the standard error of a.
        chosen: whether the cut-off was chosen by the noise; else the caller named it.
        doubtful: degrees of freedom whose cut-off came out as high as rows allow, and whose a is hardly known: their
            noise is not independent from row to row, which is what the choice stands on.
    """

    derived: str
    source: str
    names: tuple[str, ...]
    cutoff: tuple[tuple[float, float], ...] = ()
    noise: tuple[float, ...] = ()
    error: tuple[float, ...] = ()
    chosen: bool = True
    doubtful: tuple[str, ...] = ()

    @property
    def knots(self) -> tuple[float, ...]:
        """By degree of freedom the smallest distance of two knots [s]."""
        return tuple(0.5 / high for _, high in self.cutoff)

    def summary(self) -> str:
        """What was derived, with cut-off, noise and error."""
        said = f"{self.derived.replace(', ', ' and ')} derived from {self.source} by quintic splines"
        if not self.cutoff:
            return said
        low, high = min(own[0] for own in self.cutoff), max(own[1] for own in self.cutoff)
        between = f"{high:.3g} Hz" if f"{low:.3g}" == f"{high:.3g}" else f"{low:.3g} to {high:.3g} Hz"
        worst = int(np.argmax(self.error))
        doubt = ""
        if self.doubtful:
            names = listed(self.doubtful)
            doubt = f"; noise of {names} is not independent from row to row, or motion too fast: name a cut-off"
        return (
            f"{said}, cut-off {between} {'chosen by the noise' if self.chosen else 'as wanted'}, noise of "
            f"{self.source} "
            f"{_span(self.noise)}, standard error of a {_span(self.error)} (the most at {self.names[worst]}){doubt}"
        )


def _span(x: Sequence[float]) -> str:
    low, high = f"{min(x):.2g}", f"{max(x):.2g}"
    return low if low == high else f"{low} to {high}"
