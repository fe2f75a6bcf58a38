"""The running error bound holds, and is not vacuous."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from rttrr_pin import Robot
from rttrr_pin.arithmetic import Load, evaluate
from rttrr_pin.certify import bounded_dynamics
from rttrr_pin.model import Model
from rttrr_pin.validate import FAMILIES, Sampler
from test_newton_euler import mp_arithmetic
from tolerances import ROUNDING


def exact_dynamics(
    model: Model, q: np.ndarray, v: np.ndarray, a: np.ndarray, loads: list[Load]
) -> dict[str, np.ndarray]:
    """The five quantities of one state in 60 digits."""
    result = evaluate(model, mp_arithmetic(), q, v, a, loads)
    out = {
        key: np.array([list(vector) for vector in getattr(result, key)], dtype=object) for key in ("F", "N", "f", "n")
    }
    return out | {"tau": np.array(result.tau, dtype=object)}


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("family", FAMILIES)
def test_no_true_error_exceeds_its_bound(robot: Robot, family: str, seed: int) -> None:
    """Against 60 digits on the same doubles, component by component."""
    states = Sampler(robot.model, family, seed, robot.link_names[-1]).draw(0, 12)
    values, bounds = bounded_dynamics(robot.model, states.q, states.v, states.a, states.loads)
    with mpmath.workdps(60):
        for k in range(12):
            part = slice(k, k + 1)
            loads = [load.block(part) for load in states.loads]
            exact = exact_dynamics(robot.model, states.q[part], states.v[part], states.a[part], loads)
            for key, truth in exact.items():
                error = np.abs(getattr(values, key)[k] - truth)
                assert (error <= getattr(bounds, key)[k]).all(), (key, k)


@pytest.mark.parametrize("seed", [0, 1])
def test_values_are_the_bits_of_inverse_dynamics(robot: Robot, seed: int) -> None:
    states = Sampler(robot.model, "mixed", seed).draw(0, 40)
    values, _ = bounded_dynamics(robot.model, states.q, states.v, states.a)
    plain = robot.inverse_dynamics(states.q, states.v, states.a)
    for key, x in values.items():
        np.testing.assert_array_equal(x, getattr(plain, key))


def test_bounds_are_of_the_size_of_rounding(rttrr: Robot) -> None:
    """A bound that allowed a wrong third digit would be no gate."""
    states = Sampler(rttrr.model, "uniform", 0).draw(0, 500)
    values, bounds = bounded_dynamics(rttrr.model, states.q, states.v, states.a)
    for key, x in values.items():
        x_, b = x.reshape(500, -1), getattr(bounds, key).reshape(500, -1)
        assert (np.linalg.norm(b, axis=1) <= ROUNDING * np.linalg.norm(x_, axis=1)).all(), key
        assert b.max() > 0.0
