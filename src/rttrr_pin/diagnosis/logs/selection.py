"""Forward selection of groups of columns by the Bayesian information criterion, with a step back after each.

Source: Schwarz, "Estimating the dimension of a model", Annals of Statistics 6(2), 1978.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rttrr_pin.core.arrays import Array

CERTAIN = 10.0
"""What a group must gain beyond the criterion and the number of groups: as of 4.5 standard deviations."""

DEPENDENT = 1e-7
"""Relative: columns that are no farther from others say nothing of their own."""

SAME = 3.0
"""Groups whose sums of squares differ by less are not told apart."""

ZERO = 1e-9
"""Relative to the longest: a column that is shorter is zero but for rounding."""

MOST = 40
"""Groups that are chosen, at most."""


@dataclass(frozen=True, slots=True, eq=False)
class Reduced:
    """A least-squares problem, reduced by orthogonal transformations.

    Attributes:
        A: columns in units of the noise, each of length 1, triangular.
        y: right-hand side, likewise.
        lengths: what the columns were divided by.
        rows: independent ones before.
        scale: variance of what all columns leave, at least 1; times how many rows are as one.
    """

    A: Array
    y: Array
    lengths: Array
    rows: float
    scale: float


def reduced(A: Array, y: Array, series: int, known: bool) -> Reduced:
    """Reduce a problem whose rows are `series` series in time, one behind the other in each: (M, series, columns).

    Args:
        A: columns over the noise.
        y: right-hand side over the noise, (M, series).
        series: their number.
        known: whether the noise is; else its size is that of what all columns leave.
    """
    flat = A.reshape(-1, A.shape[-1])
    lengths = np.linalg.norm(flat, axis=0)
    shows = lengths > ZERO * lengths.max(initial=0.0)
    flat, lengths = flat * shows, np.where(shows, lengths, 1.0)
    R: Array = np.asarray(np.linalg.qr(np.hstack([flat / lengths, y.reshape(-1, 1)]), mode="r"))
    columns, right = R[:, :-1], R[:, -1]
    x = _solved(columns, right)
    left = (y.reshape(-1) - flat / lengths @ x).reshape(-1, series)
    rank = np.linalg.matrix_rank(columns, tol=DEPENDENT)
    variance = float((left**2).sum() / max(left.size - rank, 1))
    together = _correlated(left)
    scale = (max(variance, 1.0) if known else variance) * together
    return Reduced(columns, right, lengths, left.size / together, scale)


def _correlated(left: Array) -> float:
    """How many consecutive rows are as one, by their correlation (Sokal's window)."""
    z = left - left.mean(axis=0)
    spectrum = np.abs(np.fft.rfft(z, 2 * len(z), axis=0)) ** 2
    sums = np.fft.irfft(spectrum, axis=0)[: len(z)].sum(axis=1)
    if not sums[0] > 0.0:
        return 1.0
    total = 1.0
    for lag in range(1, len(z)):
        total += 2.0 * float(sums[lag] / sums[0])
        if lag >= 5.0 * total:
            break
    return max(total, 1.0)


def _solved(A: Array, y: Array) -> Array:
    return np.asarray(np.linalg.lstsq(A, y, rcond=DEPENDENT)[0])


def fitted(problem: Reduced, groups: Sequence[Array]) -> tuple[float, Array]:
    """Sum of squares that groups leave, over the scale; their numbers, one behind the other.

    Args:
        problem: the problem.
        groups: by group, the directions (columns, numbers) of its numbers.
    """
    if not groups:
        return float(problem.y @ problem.y) / problem.scale, np.zeros(0)
    A, sizes = columns_of(problem, groups)
    x = _solved(A, problem.y)
    left = problem.y - A @ x
    return float(left @ left) / problem.scale, x / sizes


def columns_of(problem: Reduced, groups: Sequence[Array]) -> tuple[Array, Array]:
    """Columns of one or more groups, each of length 1, and what they were divided by."""
    A = problem.A @ (problem.lengths[:, None] * np.hstack(groups))
    sizes = np.linalg.norm(A, axis=0)
    sizes[sizes == 0.0] = 1.0
    return A / sizes, sizes


def chosen(problem: Reduced, groups: Sequence[Array]) -> list[int]:
    """The groups that are needed, in the order in which each gains most; of equal ones the first in the list.

    Args:
        problem: the problem.
        groups: as in `fitted`.
    """
    search = _Search(problem, [columns_of(problem, [own])[0] for own in groups])
    own = search.forward([])
    while True:  # what was chosen first, before the others were known, may be better said otherwise
        tries = [search.forward([i for i in own if i != k], without=k) for k in own]
        better = min(tries, key=search.cost, default=own)
        if search.cost(better) >= search.cost(own) - SAME:
            return own
        own = better


@dataclass(frozen=True, slots=True, eq=False)
class _Search:
    """Groups of columns and the price of each choice."""

    problem: Reduced
    groups: list[Array]

    @property
    def each(self) -> float:
        """What a number must gain."""
        return math.log(max(self.problem.rows, 2.0))

    @property
    def price(self) -> float:
        """What a group must gain besides."""
        return CERTAIN + 2.0 * math.log(max(len(self.groups), 1))

    def cost(self, own: Sequence[int]) -> float:
        """Sum of squares that are left, and what the groups cost."""
        Q = self._basis(own)
        left = self.problem.y - Q @ (Q.T @ self.problem.y)
        return float(float(left @ left) / self.problem.scale + Q.shape[1] * self.each + len(own) * self.price)

    def forward(self, own: list[int], without: int = -1) -> list[int]:
        """More groups, as long as one gains; those that it makes needless go."""
        while len(own) < MOST:
            gains = self._gains(own, without)
            most = max(gains.values(), default=0.0)
            if most <= 0.0:
                break
            own = self._without_needless([*own, next(k for k, gain in gains.items() if gain >= most - SAME)])
        return own

    def _gains(self, own: Sequence[int], without: int) -> dict[int, float]:
        """What each other group gains beyond its price."""
        Q = self._basis(own)
        y = self.problem.y - Q @ (Q.T @ self.problem.y)
        gains = {}
        for k, group in enumerate(self.groups):
            if k not in own and k != without:
                U = _span(group - Q @ (Q.T @ group))
                gains[k] = float(((U.T @ y) ** 2).sum()) / self.problem.scale - U.shape[1] * self.each - self.price
        return gains

    def _without_needless(self, own: list[int]) -> list[int]:
        while len(own) > 1:
            costs = {k: self.cost([i for i in own if i != k]) for k in own[:-1]}
            k = min(costs, key=costs.__getitem__)
            if costs[k] > self.cost(own):
                break
            own = [i for i in own if i != k]
        return own

    def _basis(self, own: Sequence[int]) -> Array:
        return _span(np.hstack([np.zeros((len(self.problem.y), 0)), *(self.groups[k] for k in own)]))


def _span(A: Array) -> Array:
    """An orthonormal basis of columns of length 1 or less."""
    if A.shape[1] == 1:  # most groups, and a decomposition costs milliseconds
        size = float(np.linalg.norm(A))
        return np.asarray(A / size if size > DEPENDENT else A[:, :0])
    U, sigma, _ = np.linalg.svd(A, full_matrices=False)
    return np.asarray(U[:, sigma > DEPENDENT])
