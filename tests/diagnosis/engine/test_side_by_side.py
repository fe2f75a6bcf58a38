"""Programs evaluated together give the bits that they give alone."""

from __future__ import annotations

import numpy as np
import pytest

from rttrr_pin.diagnosis.catalogue.whole import hypotheses_of
from rttrr_pin.diagnosis.engine import predictions
from rttrr_pin.diagnosis.engine.predictions import parameter_columns
from rttrr_pin.diagnosis.engine.side_by_side import evaluate_all, run_all
from rttrr_pin.diagnosis.states import sample_states
from rttrr_pin.diagnosis.variants.variant import Variant
from support.faults import Bench, bench_robot


@pytest.mark.one_in(2)
@pytest.mark.parametrize("seed", range(4))
def test_many_programs_at_once_give_what_each_gives_alone(seed: int) -> None:
    robot = bench_robot(seed)
    batch, base = sample_states(robot, 7, seed).states, Variant(robot.model)
    hypotheses = [own for own in hypotheses_of(robot.model) if own.mutation is None][::5]
    variants = [own.apply(base, own.start) for own in hypotheses]
    for own, together in zip(variants, evaluate_all(variants, batch), strict=True):
        alone = own.evaluate(batch)
        assert all(np.array_equal(together[key], x, equal_nan=True) for key, x in alone.items())


def test_the_number_of_rows_changes_no_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = bench_robot(1)
    batch, base = sample_states(robot, 5).states, Variant(robot.model)
    variants = [own.apply(base, own.start) for own in hypotheses_of(robot.model)[:40] if own.mutation is None]
    wide = evaluate_all(variants, batch)
    monkeypatch.setattr(run_all, "__defaults__", (1,))
    narrow = evaluate_all(variants, batch)
    assert all(np.array_equal(x[key], y[key]) for x, y in zip(wide, narrow, strict=True) for key in x)


@pytest.mark.one_in(3)
@pytest.mark.parametrize("seed", [0, 2, 3])
def test_columns_of_parameters_are_those_of_the_regressor(seed: int) -> None:
    robot = bench_robot(seed)
    bench = Bench(robot, states=9)
    columns = parameter_columns([Variant(robot.model)], bench.evidence(bench.expected))[0]
    Y = robot.regressor(bench.batch.q, bench.batch.v, bench.batch.a)
    scale = np.maximum(np.abs(Y).max(axis=(0, 1)), 1e-300)[:, None]
    np.testing.assert_allclose(columns / scale, Y.reshape(-1, len(columns)).T / scale, rtol=0, atol=1e-12)


def test_columns_go_through_what_a_program_makes_of_its_results() -> None:
    bench = Bench(bench_robot(3), states=9)
    evidence = bench.evidence(bench.expected)
    base = Variant(bench.model)
    negative = base.with_output(lambda batch, values: values | {"tau": 3.0 - values["tau"]})
    plain, turned = parameter_columns([base, negative], evidence)
    np.testing.assert_allclose(turned, -plain, rtol=0, atol=1e-9 * np.abs(plain).max())
    assert predictions.UNITS[0][0] == 1.0
