"""What every registered implementation promises."""

from __future__ import annotations

import numpy as np
import pytest

from rttrr_pin import RandomPayload, Robot, load, validate
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.exact import enclose
from rttrr_pin.exact.adjudication import nearest
from rttrr_pin.implementations import Batch, Implementation, default_allowance, make_implementation, names
from rttrr_pin.validation.sampling import Sampler


@pytest.fixture(scope="module")
def robot() -> Robot:
    return load("rttrr")


@pytest.fixture(params=names())
def implementation(request: pytest.FixtureRequest, robot: Robot) -> Implementation:
    return make_implementation(request.param, robot.model)


def test_it_says_what_it_is(implementation: Implementation) -> None:
    assert isinstance(implementation, Implementation)
    assert implementation.name in names() and implementation.version
    assert implementation.quantities == tuple(key for key in QUANTITIES if key in implementation.quantities) != ()


@pytest.mark.parametrize("payload", [None, RandomPayload()])
def test_it_agrees_with_the_recursion_within_their_allowances(
    implementation: Implementation, robot: Robot, payload: RandomPayload | None
) -> None:
    assert validate(robot, implementation, "recursion", n_states=100, payload=payload).passed


def test_shapes_and_allowances(implementation: Implementation, robot: Robot) -> None:
    batch = Sampler(robot.model, "uniform", 1).draw(0, 7)
    result = implementation.evaluate(batch)
    allowance = result.allowance or default_allowance(batch)
    assert set(result.values) >= set(implementation.quantities)
    for key in implementation.quantities:
        shape = (7, 5) if key == "tau" else (7, len(robot.model.links), 3)
        assert result.values[key].shape == shape and np.isfinite(result.values[key]).all()
        assert np.broadcast_shapes(allowance[key].shape, shape[:2]) == shape[:2] and (allowance[key] >= 0).all()


def test_a_state_has_the_same_bits_alone_and_in_a_batch(implementation: Implementation, robot: Robot) -> None:
    batch = Sampler(robot.model, "uniform", 1).draw(0, 40)
    together = implementation.evaluate(batch)
    for k in (0, 17, 39):
        part = slice(k, k + 1)
        alone = implementation.evaluate(Batch(robot.model, batch.q[part], batch.v[part], batch.a[part], first=k))
        for key in implementation.quantities:
            assert np.array_equal(alone.values[key][0], together.values[key][k]), key


@pytest.mark.parametrize("state", [78_951, 12_954, 73_719])  # at the first the kernel is beyond the recursion's bound
def test_true_values_lie_within_the_allowance(implementation: Implementation, robot: Robot, state: int) -> None:
    batch = Sampler(robot.model, payload=RandomPayload(robot.link_names[-1])).draw(state, 1)
    enclosures = enclose(robot.model, batch.q, batch.v, batch.a, batch.loads, "doubles")
    result = implementation.evaluate(batch)
    allowance = result.allowance or default_allowance(batch)
    for key, true in nearest(enclosures, result.values).items():
        error = result.values[key] - true
        size = np.abs(error) if key == "tau" else np.linalg.norm(error, axis=-1)
        assert (size <= allowance[key]).all(), key


@pytest.mark.parametrize("name", names())
def test_a_robot_of_one_link_that_stands_still_has_nothing_to_give(name: str) -> None:
    model = load('<robot name="stone"><link name="a"/></robot>').model
    result = make_implementation(name, model).evaluate(Batch(model, *np.zeros((3, 2, 0))))
    for key, values in result.values.items():
        assert values.shape == ((2, 0) if key == "tau" else (2, 0, 3)), key
