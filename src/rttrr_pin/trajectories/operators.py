"""The fit of splines of a window as a linear operator on its rows, and the covariance that noise gives it."""

from __future__ import annotations

from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from rttrr_pin.core.arrays import Array

if TYPE_CHECKING:
    from scipy.sparse import csr_array

    Sparse: TypeAlias = csr_array

DEGREE = 5

ORDER = DEGREE + 1
"""B-splines that are not zero at a time."""

FINEST = 2.0
"""Rows between two knots, at least."""

EVEN = 1e-3
"""Of a step: times that are nearer than this to even ones are taken as even; that is noise as any other."""


class Operator:
    """The fit of splines with even knots to samples at given times, whatever the samples."""

    def __init__(self, times: Array, spans: int) -> None:
        self.times, self.spans = times, spans
        inner = np.linspace(times[0], times[-1], spans + 1)[1:-1]
        self.knots = np.concatenate([[times[0]] * ORDER, inner, [times[-1]] * ORDER])

    @property
    def apart(self) -> float:
        """The distance of knots."""
        return float(self.times[-1] - self.times[0]) / self.spans

    @property
    def parameters(self) -> int:
        """Coefficients of a spline."""
        return self.spans + DEGREE

    @cached_property
    def basis(self) -> tuple[Sparse, Sparse, Sparse]:
        """Values of B-splines and of their first two derivatives, (N, parameters) each."""
        return self._basis(0), self._basis(1), self._basis(2)

    def _basis(self, order: int) -> Sparse:
        from scipy.interpolate import BSpline  # half a second, which other features do not need
        from scipy.sparse import csr_array, diags_array

        knots, degree = self.knots[order : len(self.knots) - order], DEGREE - order
        own = csr_array(BSpline.design_matrix(self.times, knots, degree))
        for k in range(order, 0, -1):  # the derivative's coefficients are divided differences
            knots, degree = self.knots[k - 1 : len(self.knots) - k + 1], DEGREE - k + 1
            count = len(knots) - degree - 1
            weights = degree / (knots[degree + 1 : degree + count] - knots[1:count])
            own = own @ diags_array([-weights, weights], offsets=[0, 1], shape=(count - 1, count))
        return csr_array(own)

    @cached_property
    def factor(self) -> Array | None:
        """Of the normal equations, banded; None where samples are too few between some knots."""
        from scipy.linalg import cholesky_banded

        B = self._values
        normal = B.T @ B
        banded = np.zeros((ORDER, self.parameters))
        for k in range(min(ORDER, self.parameters)):
            banded[k, : self.parameters - k] = normal.diagonal(-k)
        try:
            return np.asarray(cholesky_banded(banded, lower=True))
        except np.linalg.LinAlgError:
            return None

    @cached_property
    def _values(self) -> Sparse:
        return self._basis(0)

    def solved(self, right: Array) -> Array:
        """Solutions of the normal equations."""
        from scipy.linalg import cho_solve_banded

        return np.asarray(cho_solve_banded((self.factor, True), right))

    def coefficients(self, x: Array) -> Array:
        """Of the splines nearest to signals (N, columns)."""
        return self.solved(self._values.T @ x)

    def values(self, coefficients: Array) -> Array:
        """Of splines at the times, (N, columns)."""
        return np.asarray(self._values @ coefficients)

    @cached_property
    def covariance(self) -> Array:
        """Of value, first and second derivative at each time, for noise of standard deviation 1, (N, 3, 3)."""
        inverse = self.solved(np.eye(self.parameters))
        place = np.clip(np.searchsorted(self.knots[ORDER:-ORDER], self.times, side="right"), 0, self.spans - 1)
        rows = np.zeros((len(self.times), 3, ORDER))
        for order, basis in enumerate(self.basis):
            entries = basis.tocoo()
            at = entries.col - place[entries.row]
            inside = (at >= 0) & (at < ORDER)
            rows[entries.row[inside], order, at[inside]] = entries.data[inside]
        blocks = np.stack([inverse[k : k + ORDER, k : k + ORDER] for k in range(self.spans)])
        return np.asarray(rows @ blocks[place] @ rows.transpose(0, 2, 1))


@lru_cache(maxsize=64)
def _even(count: int, spans: int) -> Operator:
    """Of times 0, 1, 2, ...: all windows of as many even rows share it."""
    return Operator(np.arange(count, dtype=np.float64), spans)


class Window:
    """Operators of a window by their number of spans; times are counted in steps."""

    def __init__(self, t: Array) -> None:
        self.count = len(t)
        self.step = float(t[-1] - t[0]) / (len(t) - 1)
        u = (t - t[0]) / self.step
        self._even = bool(np.abs(u - np.arange(len(t))).max() < EVEN)
        self._times = u
        self._own: dict[int, Operator] = {}

    def operator(self, spans: int) -> Operator:
        """The fit with so many spans."""
        if self._even:
            return _even(self.count, spans)
        if spans not in self._own:
            self._own[spans] = Operator(self._times, spans)
        return self._own[spans]

    def spans(self) -> list[int]:
        """Numbers of spans to choose from, the most first: halves of each are there too, so that knots are shared."""
        most = int((self.count - 1) / FINEST)
        return sorted((own for k in range(most.bit_length()) for own in {2**k, 3 * 2**k} if own <= most), reverse=True)

    def at_cutoff(self, cutoff: float) -> list[int]:
        """About the number of spans of a cut-off [Hz], its half and its quarter."""
        wanted = round((self.count - 1) * self.step * 2.0 * cutoff / 4)
        most = int((self.count - 1) / FINEST) // 4
        quarter = max(1, min(wanted, most))
        return [4 * quarter, 2 * quarter, quarter]
