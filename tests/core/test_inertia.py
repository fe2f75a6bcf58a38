"""Spatial inertias over fractions: every identity is exact."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rttrr_pin.core.algebra import IDENTITY, Matrix, Scalar, Vector
from rttrr_pin.core.inertia import SpatialInertia

fractions = st.sampled_from([Fraction(k, 4) for k in range(-12, 13)])
vectors = st.builds(Vector, fractions, fractions, fractions)


@st.composite
def inertias(draw: st.DrawFn) -> SpatialInertia:
    xx, xy, yy, xz, yz, zz = (draw(fractions) for _ in range(6))
    tensor = Matrix((Vector(xx, xy, xz), Vector(xy, yy, yz), Vector(xz, yz, zz)))
    return SpatialInertia.of(draw(fractions), draw(vectors), tensor)


@st.composite
def rotations(draw: st.DrawFn) -> Matrix:
    """By rational quaternions."""
    w, x, y, z = (draw(fractions) for _ in range(4))
    u, s = Vector(x, y, z), w * w + x * x + y * y + z * z
    if not s:
        return IDENTITY
    return IDENTITY * (1 - 2 * u.dot(u) / s) + Matrix.outer(u, u) * (2 / s) + Matrix.skew(u) * (2 * w / s)


def numbers(inertia: SpatialInertia) -> list[Scalar]:
    return [inertia.m, *inertia.h, *(x for row in inertia.J.rows for x in row)]


@given(inertias(), inertias(), rotations(), vectors)
def test_sums_move_as_their_parts(a: SpatialInertia, b: SpatialInertia, R: Matrix, p: Vector) -> None:
    assert numbers((a + b).moved(R, p)) == numbers(a.moved(R, p) + b.moved(R, p))
    assert numbers(a + b - b) == numbers(a)


@given(inertias(), rotations(), vectors)
def test_moving_there_and_back_changes_nothing(a: SpatialInertia, R: Matrix, p: Vector) -> None:
    assert numbers(a.moved(R, p).moved(R.T, -(R.T @ p))) == numbers(a)


@given(inertias(), rotations(), vectors)
def test_the_tensor_about_the_centre_of_mass_turns_and_does_not_move(a: SpatialInertia, R: Matrix, p: Vector) -> None:
    if a.m == 0:
        return
    (com, tensor), (moved_com, moved_tensor) = a.about_com(), a.moved(R, p).about_com()
    assert [*moved_com] == [*(p + R @ com)]
    assert [[*row] for row in moved_tensor.rows] == [[*row] for row in (R @ tensor @ R.T).rows]
    assert numbers(SpatialInertia.of(a.m, com, tensor)) == numbers(a)


@pytest.mark.parametrize("mass", [Fraction(3), Fraction(-3)])
def test_a_point_mass_has_the_tensor_of_its_distance(mass: Fraction) -> None:
    point = SpatialInertia.of(mass, Vector(0, 0, 2), Matrix((Vector(0, 0, 0),) * 3))
    assert numbers(point) == [mass, 0, 0, 2 * mass, 4 * mass, 0, 0, 0, 4 * mass, 0, 0, 0, 0]
