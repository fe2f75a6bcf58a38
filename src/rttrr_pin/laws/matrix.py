"""Laws of the mass matrix, whose columns the recursion gives, and of the kinetic energy."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from rttrr_pin.core.algebra import ZERO, Scalar
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.dual import Dual, part_of
from rttrr_pin.core.dynamics import dynamics, joint_states
from rttrr_pin.core.energy import gyroscopic
from rttrr_pin.core.scalars import UNIT_ROUNDOFF
from rttrr_pin.exact.rounding import Bounded, values_and_bounds
from rttrr_pin.laws.case import Case, Rows

EIGENVALUES = 32
"""Backward error of symmetric eigenvalues in units of n u |M| (LAPACK Users' Guide, section 4.7: a modest p(n))."""


def symmetric(case: Case) -> Iterator[Scalar]:
    """M_ij - M_ji."""
    M = case.mass_matrix
    for i in range(len(M)):
        for j in range(i):
            yield M[i][j] - M[j][i]


def of_kinetic_energy(case: Case) -> Iterator[Scalar]:
    """M_ij - d^2 T / dv_i dv_j."""
    for row, expected in zip(case.mass_matrix, case.kinetic_matrix, strict=True):
        yield from (x - y for x, y in zip(row, expected, strict=True))


def positive_definite(case: Case) -> Iterator[Scalar]:
    """The smallest eigenvalue of M, where it is negative.

    Eigenvalues change by at most the norm of the error of M (Weyl), and by the rounding of their computation. Links
    without mass make M semidefinite, so zero passes.
    """
    if not case.model.nv:
        return
    M, error = _matrix(case.mass_matrix, len(_rows(case)))
    if not np.isfinite(M).all():
        yield Bounded(np.full(len(M), np.nan), 0.0)
        return
    yield Bounded(np.minimum(np.linalg.eigvalsh(_mean(M))[:, 0], 0.0), _eigenvalue_error(M, error))


def skew(case: Case) -> Iterator[Scalar]:
    """S_ij + S_ji of S = M' - 2 C, with C the Coriolis matrix of the connection without torsion.

    The velocity forces c(q, v), a quadratic form in v, fix its symmetric part: C v = c and 2 C = dc/dv - M A, where A
    is zero for rates that are derivatives of coordinates and A^T p the gyroscopic forces of the momenta p of twists
    (`energy.gyroscopic`). Errors in C are errors in c = tau(q, v, 0) without gravity.
    """
    n = range(case.model.nv)
    model = case.model.without_joint_effects()
    v = [Dual(x, {j: 1}) for j, x in enumerate(case.v)]
    c = dynamics(model, case.duals, case.q, v, case.at_rest, (), case.links, ZERO).tau
    S = []
    for i in n:
        turning = gyroscopic(model, case.v, case.mass_matrix[i])
        S.append([case.mass_matrix_rate[i][j] - part_of(c[i], j) + turning[j] for j in n])
    for i in n:
        yield from (S[i][j] + S[j][i] for j in range(i + 1))


def forward(case: Case) -> Iterator[Scalar]:
    """M^-1 (tau - tau(q, v, 0)) - a, with M from the kinetic energy and the armatures, where M can be inverted.

    For M x = r with an error of at most E in M and e in r, and the residual rho of the computed x:
    |x - a| <= |M^-1| (E |a| + e + |rho|), which is doubled, since the inverse is rounded too.
    """
    if not case.model.nv:
        return
    still = case.forces(a=case.at_rest).tau
    inertial = [x - y for x, y in zip(case.result.tau, still, strict=True)]
    rows = len(_rows(case))
    r, e = values_and_bounds(inertial, rows)
    a, _ = values_and_bounds(case.a, rows)
    M, E = _matrix(_with_armature(case), rows)
    if not (np.isfinite(M).all() and np.isfinite(r).all()):
        yield Bounded(np.full(rows, np.nan), 0.0)
        return
    regular = np.linalg.eigvalsh(_mean(M))[:, 0] > _eigenvalue_error(M, E)
    M = np.where(regular[:, None, None], M, np.eye(case.model.nv))
    inverse = np.asarray(np.linalg.inv(M), dtype=np.float64)
    x = _times(inverse, r)
    rounded = (case.model.nv + 2) * UNIT_ROUNDOFF * (_times(abs(M), abs(x)) + abs(r))
    off = _times(E, abs(a)) + e + abs(r - _times(M, x)) + rounded
    difference, bound = x - a, 2.0 * _times(abs(inverse), off) + 2 * UNIT_ROUNDOFF * abs(a)
    for j in range(case.model.nv):
        yield Bounded(np.where(regular, difference[:, j], 0.0), bound[:, j])


def _with_armature(case: Case) -> Rows:
    """The matrix of the kinetic energy with the armatures."""
    n = range(case.model.nv)
    rates = [Dual(0, {j: 1}) for j in n]
    states = joint_states(case.model, case.duals, case.q, rates, case.at_rest)
    M = [list(row) for row in case.kinetic_matrix]
    for joint, state in zip(case.model.joints, states, strict=True):
        if joint.effects.armature:
            armature = case.arithmetic.number(joint.effects.armature, 0.0)
            rate: Any  # a dual
            for rate in state.v:
                for i in rate.parts:
                    for j in rate.parts:
                        M[i][j] = rate.parts[i] * rate.parts[j] * armature + M[i][j]
    return M


def _rows(case: Case) -> Array:
    """An array with the batch's number of states."""
    rate: Any = case.v[0]
    return np.atleast_1d(rate.value)


def _matrix(rows: Rows, count: int) -> tuple[Array, Array]:
    """Values and bounds, (N, n, n)."""
    flat: Sequence[Scalar] = [x for row in rows for x in row]
    values, bounds = values_and_bounds(flat, count)
    n = len(rows)
    return values.reshape(count, n, n), bounds.reshape(count, n, n)


def _mean(M: Array) -> Array:
    return (M + M.swapaxes(1, 2)) / 2


def _eigenvalue_error(M: Array, error: Array) -> Array:
    """A bound on the error of computed eigenvalues, (N,)."""
    rounded = EIGENVALUES * M.shape[-1] * UNIT_ROUNDOFF * np.linalg.norm(M, axis=(1, 2))
    total: Array = np.linalg.norm(error, axis=(1, 2)) + rounded
    return total


def _times(M: Array, x: Array) -> Array:
    product: Array = np.einsum("kij,kj->ki", M, x)
    return product
