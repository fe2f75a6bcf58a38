"""The norm of vectors of any size."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rttrr_pin.core.arrays import flat, norm
from support.tolerances import EPS


@given(st.lists(st.floats(-1e308, 1e308), min_size=1, max_size=6))
def test_no_square_overflows_or_vanishes(numbers: list[float]) -> None:
    length, other = float(norm(np.array(numbers))), math.hypot(*numbers)
    assert length == other or abs(length - other) <= 4 * EPS * other + 5e-324


@given(st.lists(st.floats(-1e150, 1e150).filter(lambda x: x == 0 or abs(x) > 1e-150), min_size=3, max_size=3))
def test_bits_are_those_of_the_plain_formula(numbers: list[float]) -> None:
    assert norm(np.array([numbers]))[0] == np.linalg.norm(np.array([numbers]), axis=-1)[0]


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_stays_so(bad: float) -> None:
    lengths = norm(np.array([[1.0, bad, 2.0], [3.0, 4.0, 0.0]]))
    assert not np.isfinite(lengths[0]) and lengths[1] == 5.0


@pytest.mark.parametrize("width", [1, 2, 3, 7, 8, 15, 17, 127, 130, 300])
@pytest.mark.parametrize("scale", [1.0, 1e-170, 1e200, 1e-310, 0.0])
def test_a_vector_has_its_bits_in_any_array_and_layout(width: int, scale: float) -> None:
    """Zeros, and numbers of many sizes, are among them."""
    rng = np.random.default_rng(width)
    vectors = rng.normal(size=(9, 2, width)) * scale
    vectors[3], vectors[5, 0] = 0.0, 10.0 ** rng.integers(-300, 300, size=width)
    alone = [[norm(vector) for vector in pair] for pair in vectors]
    columns = np.moveaxis(np.ascontiguousarray(np.moveaxis(vectors, 0, -1)), -1, 0)
    components = np.moveaxis(np.ascontiguousarray(np.moveaxis(vectors, -1, 0)), 0, -1)
    for layout in (vectors, columns, components, np.asfortranarray(vectors)):
        np.testing.assert_array_equal(norm(layout), alone)


def test_of_no_numbers_it_is_zero() -> None:
    assert norm(np.zeros((4, 0))).tolist() == [0.0] * 4


@pytest.mark.parametrize("rows", [0, 1, 2, 5])
def test_flat_arrays_keep_their_layout(rows: int) -> None:
    """By rows, by columns, and by columns of a larger array, which are copied as columns."""
    x = np.arange(rows * 4 * 3.0).reshape(rows, 4, 3)
    columns = np.ascontiguousarray(np.moveaxis(x, 0, -1))
    larger = np.concatenate([columns, columns], axis=1)[:, :3]
    for own in (x, np.moveaxis(columns, -1, 0), np.moveaxis(larger, -1, 0)):
        np.testing.assert_array_equal(flat(own), x.reshape(rows, 12))
        if rows > 1:
            assert (flat(own).strides[0] == 8) == (own.strides[0] == 8)
