"""What a comparison of arrays sees is what a comparison number by number sees, however the states are cut."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rttrr_pin import Robot
from rttrr_pin.core.scalars import EPS
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.implementations import Batch, Evaluation
from rttrr_pin.implementations.protocol import shape_of
from rttrr_pin.validation.compare import Comparison
from rttrr_pin.validation.ranking import Worst
from rttrr_pin.validation.sampling import Sampler

STATES = 16

SIZES = [0.0, 1.0, 1e-17, 1e160, 1e-160, 1e300, 5e-324]

BAD = [np.nan, np.inf, -np.inf]


def by_columns(x: Any) -> Any:
    """The same numbers, consecutive states side by side in memory."""
    return np.moveaxis(np.ascontiguousarray(np.moveaxis(x, 0, -1)), -1, 0)


def some(rng: np.random.Generator, shape: tuple[int, ...], like: Any = None) -> Any:
    """Numbers of one size or of several, some of them zero or near others, few of them not finite."""
    x = rng.normal(size=shape) * rng.choice(SIZES[1:], size=shape if rng.random() < 0.3 else 1)
    if like is not None and rng.random() < 0.8:
        x = like * (1 + 1e-15 * rng.integers(-3, 4, size=shape))
    x = np.where(rng.random(shape) < rng.choice([0.0, 0.3, 1.0], p=[0.6, 0.3, 0.1]), 0.0, x)
    return np.where(rng.random(shape) < rng.choice([0.0, 0.002], p=[0.7, 0.3]), rng.choice(BAD, size=shape), x)


def sides(robot: Robot, seed: int) -> list[Evaluation]:
    """A subject and a reference."""
    rng = np.random.default_rng(seed)
    made: list[Evaluation] = []
    for _ in range(2):
        shapes = {key: (STATES, *shape_of(robot.model, key)) for key in QUANTITIES}
        values = {key: some(rng, shape, made[0].values[key] if made else None) for key, shape in shapes.items()}
        size = rng.choice([0.0, 1e-17, 1e-15, 1.0, 1e-160])
        allowance = {key: size * rng.random(shape[:2]) for key, shape in shapes.items()}
        order = by_columns if rng.random() < 0.5 else np.ascontiguousarray
        values, allowance = ({key: order(x) for key, x in own.items()} for own in (values, allowance))
        made.append(Evaluation(values, allowance, order(some(rng, shapes["tau"]))))
    return made


def part(evaluation: Evaluation, states: slice) -> Evaluation:
    """Some of the states."""
    assert evaluation.allowance is not None and evaluation.tau_joint is not None
    values, allowance = (
        {key: x[states] for key, x in own.items()} for own in (evaluation.values, evaluation.allowance)
    )
    return Evaluation(values, allowance, evaluation.tau_joint[states])


def length(vector: Any) -> float:
    """The norm, by scaling with a power of two."""
    largest = float(np.max(np.abs(vector), initial=0.0))
    exponent = int(np.frexp(largest)[1]) if np.isfinite(largest) else 0
    scaled = np.ldexp(np.ascontiguousarray(vector), -exponent)
    return float(np.ldexp(np.sqrt(np.add.reduce(scaled * scaled)), exponent))


def quotient(x: float, y: float) -> float:
    """x / y; 0 where x is 0, and infinite where it is not known."""
    if x == 0.0:
        return 0.0
    result = float(np.float64(x) / np.float64(y))
    return np.inf if np.isnan(result) else result


def numbers(robot: Robot, subject: Evaluation, reference: Evaluation, k: int) -> tuple[Any, Any]:
    """Error, relative error and error / tolerance of each row in one state, and the relative error of each quantity."""
    rows, whole = [], []
    for key in QUANTITIES:
        x, y = subject.values[key][k], reference.values[key][k]
        assert subject.allowance and reference.allowance and reference.tau_joint is not None
        allowed = subject.allowance[key][k] + reference.allowance[key][k]
        for j in range(len(x)):
            error = length(np.atleast_1d(x[j] - y[j]))
            size = length(np.atleast_1d(y[j]))
            if key == "tau":
                joint = robot.model.moving[j]
                link = robot.model.joints.index(joint)
                own = reference.values["n" if joint.type.rotates else "f"][k, link]
                size = float(abs(reference.tau_joint[k, j]) + length(own))
            error, size = error if np.isfinite(error) else np.inf, size if np.isfinite(size) else 0.0
            relative = quotient(error, size * EPS) if size > allowed[j] else 0.0
            rows.append((error, relative, quotient(error, allowed[j])))
        error, size = length((x - y).ravel()), length(y.ravel())
        error = error if np.isfinite(error) else np.inf
        whole.append(quotient(error, size * EPS) if size > length(allowed) else 0.0)
    return rows, whole


@settings(max_examples=15)
@given(seed=st.integers(0, 2**32), cuts=st.lists(st.integers(1, STATES - 1), max_size=6))
def test_arrays_are_compared_as_numbers_are(rttrr: Robot, seed: int, cuts: list[int]) -> None:
    subject, reference = sides(rttrr, seed)
    comparison = Comparison(rttrr.model)
    edges = [0, *sorted({*cuts}), STATES]
    drawn = Sampler(rttrr.model).draw(0, STATES)
    with np.errstate(all="ignore"):
        ratios = [
            comparison.add(
                Batch(rttrr.model, drawn.q[start:stop], drawn.v[start:stop], drawn.a[start:stop], first=start),
                part(subject, slice(start, stop)),
                part(reference, slice(start, stop)),
            )
            for start, stop in pairwise(edges)
        ]
        expected = [numbers(rttrr, subject, reference, k) for k in range(STATES)]
    rows = np.array([rows for rows, _ in expected])
    np.testing.assert_array_equal(np.concatenate(ratios), rows[:, :, 2].max(axis=1))
    for j, row in enumerate(comparison.rows):
        worst = [Worst(), Worst(), Worst()]
        for own, values in zip(worst, rows[:, j].T, strict=True):
            own.see(values, 0)
        assert [row.absolute, row.relative, row.of_tolerance] == worst
        assert row.failures == (rows[:, j, 2] > 1.0).sum()
    for own, values in zip(comparison.whole.values(), np.transpose([whole for _, whole in expected]), strict=True):
        wanted = Worst()
        wanted.see(values, 0)
        assert own == wanted


@pytest.mark.parametrize("order", [by_columns, np.ascontiguousarray], ids=["columns", "rows"])
def test_differences_of_rows_are_those_of_arrays(rttrr: Robot, order: Any) -> None:
    subject, reference = sides(rttrr, 1)
    batch = Sampler(rttrr.model).draw(0, STATES)
    with np.errstate(all="ignore"):
        together = Comparison(rttrr.model).differences(batch, subject, reference)
    assert together.error.shape == (len(Comparison(rttrr.model).rows), STATES)
    for k, row in enumerate(together):
        for name in ("error", "size", "tolerance", "relative", "known", "of_tolerance"):
            np.testing.assert_array_equal(getattr(row, name), getattr(together, name)[k])
