"""Can a rigid body have this inertia? Decided in rationals, so that flat plates and thin rods are decided too.

A body of density rho has the second moments Sigma = integral of rho r r^T about its centre of mass, and
I = trace(Sigma) 1 - Sigma, that is Sigma = trace(I)/2 1 - I. Some density exists if and only if Sigma is positive
semidefinite (Wensing, Kim, Slotine, *Linear Matrix Inequalities for Physically Consistent Inertial Parameter
Identification*, 2018). The eigenvalues of Sigma are (I2 + I3 - I1)/2 and so on in a circle: Sigma is positive
semidefinite exactly where the principal moments fulfil the triangle inequality, which in turn makes them non-negative.
The 4x4 pseudo-inertia [[Sigma + m c c^T, m c], [m c^T, m]] has the Schur complement Sigma with respect to m: for m > 0
it is positive semidefinite exactly where Sigma is, wherever the centre of mass c lies. Turning the axes changes none of
this, so the file's own axes do, and no sine is ever rounded.
"""

from __future__ import annotations

import enum
from collections.abc import Iterator
from fractions import Fraction
from functools import lru_cache
from itertools import combinations

import numpy as np

from rttrr_pin.urdf.inertial import ENTRIES, UrdfInertial, symmetric

Matrix = tuple[tuple[Fraction, ...], ...]

DIAGONAL = ("ixx", "iyy", "izz")

STEPS = (Fraction(9, 10), Fraction(1, 2), Fraction(1, 4), Fraction(1))
"""How far of its half unit each entry is moved in search of a tensor that a body can have."""

SEARCHES, REPORTED, SOFTNESS, MOST = 200, (0, 1, 4, 19, 69, 199), 0.1, 3.5
"""Steps of the search, those after which it is looked at exactly, the soft minimum's width in half units, and what
moving all entries by one can raise an eigenvalue of Sigma by (1.5 on the diagonal, two products beside it)."""

COARSE, DOUBLE = Fraction(1, 1000), Fraction(1, 10**15)
"""Shares of the trace. A half unit above the first is none: 0.1 does not mean 0.1 +- 0.05, it is short for the double
0.1. What was computed in double precision errs by a few units of 2e-16, the second, however many digits are written."""


class Shape(enum.StrEnum):
    """What a body with such an inertia looks like."""

    SOLID = "solid"
    PLATE = "plate"
    ROD = "rod"
    POINT = "point"
    FRAME = "frame"
    IMPOSSIBLE = "impossible"


def second_moments(inertia: Matrix) -> Matrix:
    """Sigma = trace(I)/2 1 - I."""
    half = (inertia[0][0] + inertia[1][1] + inertia[2][2]) / 2
    return tuple(tuple(half * (i == j) - inertia[i][j] for j in range(3)) for i in range(3))


def determinant(matrix: Matrix) -> Fraction:
    """By expansion along the first row."""
    if len(matrix) == 1:
        return matrix[0][0]
    minors = (tuple(row[:j] + row[j + 1 :] for row in matrix[1:]) for j in range(len(matrix)))
    return sum(((-1) ** j * matrix[0][j] * determinant(minor) for j, minor in enumerate(minors)), Fraction(0))


def rank_if_positive(matrix: Matrix) -> int | None:
    """The rank of a positive semidefinite matrix; None where it is not one.

    A symmetric matrix is positive semidefinite if and only if all its principal minors (not only the leading ones) are
    non-negative; its rank is then the size of the largest that is positive.
    """
    rank, size = 0, len(matrix)
    for order in range(1, size + 1):
        for kept in combinations(range(size), order):
            minor = determinant(tuple(tuple(matrix[i][j] for j in kept) for i in kept))
            if minor < 0:
                return None
            if minor > 0:
                rank = order
    return rank


def shape_of(mass: Fraction, rank: int | None) -> Shape:
    """What body has this mass, and second moments of this rank about its centre of mass.

    Args:
        mass: [kg], exact.
        rank: of Sigma; None where it is not positive semidefinite.
    """
    if mass < 0 or rank is None or (mass == 0 and rank > 0):
        return Shape.IMPOSSIBLE
    if mass == 0:
        return Shape.FRAME
    return (Shape.POINT, Shape.ROD, Shape.PLATE, Shape.SOLID)[rank]


def shape(inertial: UrdfInertial) -> Shape:
    """What body has this mass and inertia."""
    return shape_of(inertial.mass.exact, rank(inertial))


@lru_cache(maxsize=4096)
def rank(inertial: UrdfInertial) -> int | None:
    """The rank of the second moments about the centre of mass; None where they are not positive semidefinite."""
    return rank_if_positive(second_moments(_tensor(inertial)))


@lru_cache(maxsize=4096)
def is_positive(inertial: UrdfInertial) -> bool:
    """Whether the tensor is positive semidefinite."""
    return rank_if_positive(_tensor(inertial)) is not None


def _tensor(inertial: UrdfInertial) -> Matrix:
    return inertial.tensor_of(lambda number: number.exact)


@lru_cache(maxsize=4096)
def nearest_possible(inertial: UrdfInertial, coarse: bool = False) -> dict[str, Fraction] | None:
    """The entries of a tensor that a body can have and that rounds to the numbers written; None where none was found.

    Each entry may move by half a unit of its last digit, or by the rounding of double precision. The search is in
    floating point; what it finds is checked exactly. With `coarse`, half units above `COARSE` count, too.
    """
    written = {name: number.exact for name, number in inertial.entries.items()}
    trace = sum((abs(written[name]) for name in DIAGONAL), Fraction(0))
    if any(abs(value) > trace for value in written.values()):
        return None
    coarsest = trace if coarse else COARSE * trace
    may = {
        name: number.half if DOUBLE * trace < number.half <= coarsest else DOUBLE * trace * bool(number.exact)
        for name, number in inertial.entries.items()
    }
    for shares in _searched(written, may):
        for step in STEPS:
            share = {name: round(step * shares[name], 3) for name in written}  # so that it has a decimal text
            moved = {name: written[name] + share[name] * may[name] for name in written}
            if rank_if_positive(second_moments(symmetric(moved))) is not None:
                return moved
    return None


def _searched(written: dict[str, Fraction], may: dict[str, Fraction]) -> Iterator[dict[str, Fraction]]:
    """Shares, -1 to 1, of what each entry may move by, that raise the smallest eigenvalue of Sigma.

    First all moments up, which adds the same to all eigenvalues. Then the Frank-Wolfe method on a soft minimum of the
    eigenvalues: for an eigenvector v, v^T Sigma v = sum of slope x entry; each entry moves as the slope's sign says.
    """
    yield {name: Fraction(name in DIAGONAL) for name in written}
    unit = max(may.values())
    if not unit:
        return
    sigma = second_moments(symmetric(written))
    start = np.array([[float(x / unit) for x in row] for row in sigma])
    size = np.array([float(may[name] / unit) for name in written])
    if np.linalg.eigvalsh(start)[0] < -MOST:
        return
    shares = np.zeros(len(size))
    for k in range(SEARCHES):
        tensor = np.array(symmetric(dict(zip(written, shares * size, strict=True))))
        values, vectors = np.linalg.eigh(start + np.trace(tensor) / 2.0 * np.eye(3) - tensor)
        weights = np.exp((values[0] - values) / SOFTNESS)
        outer = (vectors * (weights / weights.sum())) @ vectors.T
        raised = 0.5 * np.eye(3) - outer  # what a unit of each moment adds; a product stands twice in the tensor
        # Of the box of all moves, the corner that raises the soft minimum fastest, by steps that become shorter.
        shares += (np.sign([raised[ENTRIES[name]] for name in written]) - shares) * (2.0 / (k + 2.0))
        if k in REPORTED:
            yield {name: Fraction(float(share)) for name, share in zip(written, shares, strict=True)}
