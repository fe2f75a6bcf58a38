"""Functions over scalars, compiled: the numbers of the same lines on arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rttrr_pin.compile import formula
from rttrr_pin.compile.emit import emitter
from rttrr_pin.compile.formula import Formula, Sizes
from rttrr_pin.core.arrays import norm

EDGES = [
    0.0,
    -0.0,
    1.0,
    -3.0,
    5e-324,
    1e-310,
    2.0**-501,
    2.0**-500,
    2.0**-499,
    2.0**499,
    2.0**500,
    2.0**501,
    1.7e308,
    np.inf,
]


def norms(sizes: Sizes, x: Mapping[str, Sequence[Any]]) -> dict[str, list[Any]]:
    a, b, c = x["x"]
    return {
        "of_three": [sizes.norm((a, b, c))],
        "of_two": [sizes.norm((a, -c))],
        "of_one": [sizes.norm([b])],
        "of_none": [sizes.norm((0.0, 3.0, 4.0))],
    }


OUTPUTS = {"of_three": 1, "of_two": 1, "of_one": 1, "of_none": 1}


@pytest.mark.parametrize("name", ["llvm", "numpy"])
def test_a_norm_has_the_bits_of_the_package_s_norm(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of numbers whose squares float64 does not hold, of infinities, and beside NaN."""
    monkeypatch.setattr(formula, "emitter", lambda: emitter(name))
    rng = np.random.default_rng(0)
    grid = np.stack(np.meshgrid(EDGES, EDGES, EDGES), axis=-1).reshape(-1, 3)
    spread = rng.normal(size=(5000, 3)) * 2.0 ** rng.integers(-1000, 1000, (5000, 3))
    with np.errstate(all="ignore"):
        x = np.concatenate([grid, spread, [[np.nan, 1.0, 1.0]]])
        result = Formula(norms, {"x": 3}, OUTPUTS, "norms")(len(x), {"x": x})
        assert np.array_equal(result["of_three"][0], norm(x), equal_nan=True)
        assert np.array_equal(result["of_two"][0], norm(x[:, [0, 2]]), equal_nan=True)
    assert np.array_equal(result["of_one"][0], np.abs(x[:, 1]), equal_nan=True)
    assert (result["of_none"] == 5.0).all()


@given(st.integers(1, 200), st.integers(0, 2**32 - 1))
def test_compiled_or_on_arrays_a_formula_has_the_same_bits(rows: int, seed: int) -> None:
    """Of any number of states, whatever the layout; an input may be the same in every state."""

    def function(sizes: Sizes, x: Mapping[str, Sequence[Any]]) -> dict[str, list[Any]]:
        (a, b), (c,) = x["pair"], x["same"]
        return {"out": [a * b - c, sizes.size(a) + sizes.norm((a, b, c)) * 3.0, 7.0]}

    rng = np.random.default_rng(seed)
    pair, same = rng.normal(size=(2, rows)).T, rng.normal(size=(1, 1))
    compiled, on_arrays = (Formula(function, {"pair": 2, "same": 1}, {"out": 3}, own) for own in ("a test", None))
    results = [one(rows, {"pair": pair, "same": same})["out"] for one in (compiled, on_arrays)]
    assert results[0].shape == (3, rows) and np.array_equal(*results)


def test_what_is_too_long_to_compile_runs_on_arrays(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(formula, "LARGEST", 3)
    x = np.random.default_rng(2).normal(size=(5, 3))
    long = Formula(norms, {"x": 3}, OUTPUTS, "too long")
    assert long._variant is None and np.array_equal(long(5, {"x": x})["of_three"][0], norm(x))


def test_compiled_code_is_known_again_without_tracing(monkeypatch: pytest.MonkeyPatch) -> None:
    Formula(norms, {"x": 3}, OUTPUTS, "known again")
    monkeypatch.setattr(Formula, "_traced", None)
    Formula(norms, {"x": 3}, OUTPUTS, "known again")
    with pytest.raises(TypeError):
        Formula(norms, {"x": 3}, OUTPUTS, "another")
