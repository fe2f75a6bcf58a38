"""The one ladder of tolerances; each rung has its measured reason. No other tolerance stands in a test.

Comparisons are of norms: |x - y| <= rung * |y|, per force, moment or vector of torques. Componentwise relative errors
and ULPs are no measure, since cancellation makes them meaningless.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

EPS = float(np.finfo(float).eps)

ROUNDING = 500 * EPS
"""Two correct programs, normwise. Measured over 1e6 states of RTTRR: see benchmarks/results."""

MODEL = 64 * EPS
"""Numbers of a model after a few rotations and parallel-axis shifts."""

URDF_DIGITS = 1e-5
"""The bundled URDFs are written with six significant digits: half a unit of the sixth, 5e-6, and a margin of two."""

NINE_DIGITS = 5e-9
"""Arrays published as NumPy prints them, to nine or more significant digits: half a unit of the ninth."""

CONSUMER = 1e-9
"""What another program made of a file's masses and inertias: MuJoCo stops diagonalising at 4e-12, and what it or Drake
alters, it alters by a percent or more."""

CONSUMER_AXES = 2e-6
"""Of the trace: a tensor of MuJoCo's in the link's axes. Before version 3.14 it stops diagonalising at rotations of 1.4e-6
(measured: 4e-7 where ten links are merged). Our rules count a turn by a rounded pi (4e-8 at seven digits) for none."""

DIAGONALISED = 4e-12
"""Of all terms of a wrench: where MuJoCo stops diagonalising tensors."""

SINGLE = 6e-5
"""Of all terms of a wrench, in a program that computes in float32 (eps 1.2e-7) and steps by 1e-4 s (measured: PhysX 2.2e-5). With
other axes, another point or sign it is off by a percent or more."""

SOFT = 1e-4
"""How far a follower of MuJoCo's is off at least, in rad or m, after 0.4 s under 10 N or N m (measured in 3.13 and 4.0:
2.1e-4 to 1.0e-3; before, without a constraint, 0.25 and more). A rigid one would be off by rounding."""

SINCOS_ULPS = 1.0
"""Sine and cosine of compiled code against the true value, in units in the last place of it, as the docstring of
`kernel.sincos` promises (measured at random angles: 0.87; of the C library beyond the polynomials, 0.55). Here ULPs
are a measure: one function of one exact argument, in which nothing cancels."""

WELL_BELOW = 0.5
"""Share of the gate that right results keep to against MuJoCo. Measured: 0.16 over 200,000 states of the bundled arms, 0.25
over random trees, 0.26 over the files of example-robot-data; a wrong number is beyond 1."""

DIFFERENCES = 1e-6
"""Central differences with steps of 6e-6, the cube root of eps: good to 6e-11 (measured), a wrong term is off by a
percent or more. A check of sanity, apart from Pinocchio; the exact comparison is with that."""

SIXTY_DIGITS = 1e-50
"""Of the largest number of a quantity: what arithmetic in 60 digits itself may be off, after some 1e3 operations whose terms
cancel by some 1e5; a double has 16 digits."""

EXACT = 0.0
"""The same operations in the same order: the same bits."""


def norm_error(x: ArrayLike, y: ArrayLike) -> float:
    """|x - y| / |y| over all entries; 0 where both are 0."""
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    assert x.shape == y.shape, (x.shape, y.shape)
    difference, size = float(np.linalg.norm(x - y)), float(np.linalg.norm(y))
    if difference == 0.0:
        return 0.0
    return difference / size if size else float("inf")
