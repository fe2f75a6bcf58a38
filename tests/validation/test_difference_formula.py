"""Compiled, a comparison has the bits that it has on arrays."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.implementations import Batch, Evaluation, make_implementation
from rttrr_pin.validation import Sampler, compare
from rttrr_pin.validation.compare import Comparison, Difference
from support.trees import random_tree


@cache
def results() -> tuple[Batch, Evaluation, Evaluation]:
    """The kernel and Pinocchio on some states of a tree."""
    model = rttrr_pin.load(random_tree(200, 6)).model
    batch = replace(Sampler(model, "mixed").draw(0, 70), compiled=True)
    x, y = (make_implementation(name, model).evaluate(batch) for name in ("kernel", "pinocchio"))
    return batch, x, y


def compared(quantities: tuple[str, ...], spoil: float | None = None) -> list[Difference]:
    """The two, compiled and on arrays."""
    batch, x, y = results()
    if spoil is not None:
        for k, key in enumerate(quantities):
            values = np.array(x.values[key])
            values.reshape(70, -1)[k, 0] = spoil
            x = Evaluation({**x.values, key: values}, x.allowance, x.tau_joint)
    found = []
    for states in (0, 10**6):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(compare, "COMPILED_FROM", states)
            comparison = Comparison(batch.model, quantities)
            found.append(comparison.differences(batch, x, y))
        assert (comparison._formula is not None) == (states == 0)
    return found


@pytest.mark.parametrize("quantities", [QUANTITIES, ("tau",), ("F", "n")], ids=str)
def test_errors_sizes_and_tolerances_have_the_same_bits(quantities: tuple[str, ...]) -> None:
    """With followers, whose joint's driving force is a component of several vectors."""
    compiled, on_arrays = compared(quantities)
    for name in ("error", "size", "tolerance"):
        assert np.array_equal(getattr(compiled, name), getattr(on_arrays, name)), name
    assert (compiled.size > 0).any()


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e300])
def test_what_is_not_finite_is_as_far_off_as_can_be(value: float) -> None:
    compiled, on_arrays = compared(QUANTITIES, value)
    for name in ("error", "size", "tolerance"):
        assert np.array_equal(getattr(compiled, name), getattr(on_arrays, name)), name
    assert np.isinf(compiled.error).any() == (not np.isfinite(value))
