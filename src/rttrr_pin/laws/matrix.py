"""Laws of the mass matrix, whose columns the recursion gives, and of the kinetic energy."""

from __future__ import annotations

from collections.abc import Iterator
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
from rttrr_pin.laws.law import law

EIGENVALUES = 32
"""Backward error of symmetric eigenvalues in units of n u |M| (LAPACK Users' Guide, section 4.7: a modest p(n))."""


@law("M401", "symmetric")
def symmetric(case: Case) -> Iterator[Scalar]:
    """The forces of unit accelerations make a symmetric mass matrix: M_ij = M_ji."""
    M = case.mass_matrix
    for i in range(len(M)):
        for j in range(i):
            yield M[i][j] - M[j][i]


@law("M402", "kinetic energy")
def of_kinetic_energy(case: Case) -> Iterator[Scalar]:
    """The mass matrix is the second derivative of the kinetic energy: M_ij = d^2 T / dv_i dv_j."""
    for row, expected in zip(case.mass_matrix, case.kinetic_matrix, strict=True):
        yield from (x - y for x, y in zip(row, expected, strict=True))


@law("M403", "positive definite")
def positive_definite(case: Case) -> Iterator[Scalar]:
    """No motion has a negative kinetic energy: the smallest eigenvalue of M is not below zero.

    Eigenvalues change by at most the norm of the error of M (Weyl), and by the rounding of their computation. Links
    without mass make M semidefinite, so zero passes.
    """
    if not case.model.nv:
        return
    M, error = _matrix(case.mass_matrix, _states(case))
    if np.isfinite(M).all():
        yield Bounded(np.minimum(_smallest_eigenvalue(M), 0.0), _eigenvalue_error(M, error))
    else:
        yield Bounded(np.full(len(M), np.nan), 0.0)


@law("M404", "skew")
def skew(case: Case) -> Iterator[Scalar]:
    """M' - 2 C is skew, for the C without torsion with C v = tau(q, v, 0) without gravity.

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


@law("M405", "forward of inverse")
def forward(case: Case) -> Iterator[Scalar]:
    """Forward dynamics undo inverse dynamics: M^-1 (tau - tau(q, v, 0)) = a, with M of the kinetic energy.

    For M x = r with an error of at most E in M and e in r, and the residual rho of the computed x:
    |x - a| <= |M^-1| (E |a| + e + |rho|), which is doubled, since the inverse is rounded too.
    """
    if not case.model.nv:
        return
    still = case.forces(a=case.at_rest).tau
    inertial = [x - y for x, y in zip(case.result.tau, still, strict=True)]
    n, rows = case.model.nv, _states(case)
    r, e = values_and_bounds(inertial, rows)
    a, _ = values_and_bounds(case.a, rows)
    M, E = _matrix(_with_armature(case), rows)
    if not (np.isfinite(M).all() and np.isfinite(r).all()):
        yield Bounded(np.full(rows, np.nan), 0.0)
        return
    # Where M may be singular the law says nothing; the identity in its place lets the rest of the batch be inverted.
    regular = _smallest_eigenvalue(M) > _eigenvalue_error(M, E)
    M = np.where(regular[:, None, None], M, np.eye(n))
    inverse = np.asarray(np.linalg.inv(M), dtype=np.float64)
    x = _times(inverse, r)
    rounded = (n + 2) * UNIT_ROUNDOFF * (_times(abs(M), abs(x)) + abs(r))
    off = _times(E, abs(a)) + e + abs(r - _times(M, x)) + rounded
    difference, bound = x - a, 2.0 * _times(abs(inverse), off) + 2 * UNIT_ROUNDOFF * abs(a)
    for j in range(n):
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


def _states(case: Case) -> int:
    """How many states a batch of scalars (value, bound) has."""
    rate: Any = case.v[0]
    return int(np.size(rate.value))


def _matrix(rows: Rows, count: int) -> tuple[Array, Array]:
    """Values and bounds, (N, n, n)."""
    n = len(rows)
    values, bounds = values_and_bounds([x for row in rows for x in row], count)
    return values.reshape(count, n, n), bounds.reshape(count, n, n)


def _smallest_eigenvalue(M: Array) -> Array:
    """That of the symmetric part, (N,)."""
    return np.asarray(np.linalg.eigvalsh((M + M.swapaxes(1, 2)) / 2)[:, 0], dtype=np.float64)


def _eigenvalue_error(M: Array, error: Array) -> Array:
    """A bound on the error of computed eigenvalues, (N,)."""
    rounded = EIGENVALUES * M.shape[-1] * UNIT_ROUNDOFF * np.linalg.norm(M, axis=(1, 2))
    total: Array = np.linalg.norm(error, axis=(1, 2)) + rounded
    return total


def _times(M: Array, x: Array) -> Array:
    product: Array = np.einsum("kij,kj->ki", M, x)
    return product
