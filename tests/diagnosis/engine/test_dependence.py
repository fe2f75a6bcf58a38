"""What an unexplained difference depends on, where a program can be asked."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rttrr_pin import RandomPayload, load
from rttrr_pin.diagnosis.engine.dependence import dependence
from rttrr_pin.diagnosis.engine.evidence import Evidence, flat, results, spread
from rttrr_pin.diagnosis.states import sample_states
from rttrr_pin.implementations import Batch, default_allowance, make_implementation
from support.implementations import Altered


def _with_payload(values: dict[str, Any], batch: Any) -> None:
    for own in batch.loads:
        values["tau"] += 0.1 * (own.f[..., :1] ** 2).reshape(-1, 1)


def _without(values: dict[str, Any], batch: Any) -> None:
    values["tau"] += 0.1


@pytest.mark.parametrize(
    ("spoil", "line"),
    [(_with_payload, "it changes with the payload"), (_without, "the payload does not change it")],
)
def test_it_is_told_whether_the_payload_matters(spoil: Any, line: str) -> None:
    """The first states of a sample have none."""
    model = load("trr").model
    batch = sample_states(load("trr"), 40, 0, RandomPayload()).states
    assert not batch.loads[0].f[0].any()
    reference = make_implementation("recursion", model)
    subject = Altered(reference, spoil)
    values, expected = (flat(dict(one.evaluate(batch).values), ("tau",)) for one in (subject, reference))
    allowed = spread(default_allowance(batch), ("tau",))
    evidence = Evidence(batch, ("tau",), values, expected, allowed, allowed)
    assert line in dependence([subject, reference], evidence)


def test_a_program_that_is_not_deterministic_is_called_so() -> None:
    """And no law of rates and accelerations is told of noise."""
    rng = np.random.default_rng(0)

    def noisy(values: dict[str, Any], batch: Any) -> None:
        values["tau"] += 0.01 * rng.standard_normal(values["tau"].shape)

    _, *lines = _told(noisy)
    assert len(lines) == 1 and "not deterministic" in lines[0]


def test_a_program_without_a_number_somewhere_is_not_asked_on() -> None:
    """NaN is beyond no bound: it was said that rates do not change the difference."""

    def silent(values: dict[str, Any], batch: Any) -> None:
        values["tau"][(batch.v != 0.0).all(axis=1)] = np.nan
        values["tau"] += 0.1

    _, *lines = _told(silent, 6)
    assert len(lines) == 1 and "no number" in lines[0]


def _told(spoil: Any, n: int = 40) -> tuple[str, ...]:
    model = load("trr").model
    batch = sample_states(load("trr"), n, 0, None).states
    programs = [Altered(make_implementation("recursion", model), spoil), make_implementation("recursion", model)]
    values, expected = (np.nan_to_num(flat(dict(one.evaluate(batch).values), ("tau",))) for one in programs)
    allowed = spread(default_allowance(batch), ("tau",))
    return dependence(programs, Evidence(batch, ("tau",), values, expected, allowed, allowed))


def test_too_few_results_are_said_to_be_too_few() -> None:
    """A near miss of 100 percent beside "no hypothesis explains it" was a riddle."""
    where, *_ = _told(_without, 3)  # of three joints
    assert "9 results are too few for a cause with more than 3 fitted numbers" in where
    assert "too few" not in _told(_without)[0]


def test_a_state_that_is_there_five_times_is_one_state() -> None:
    """Ten numbers fitted to one pose that was told six times were an explanation; what is zero anyway is no result."""
    model = load("trr").model
    states = sample_states(load("trr"), 12, 0, None).states
    rows = np.array([3] * 5 + [7])
    batch = Batch(model, states.q[rows], states.v[rows], states.a[rows])
    seen = np.ones((6, 3)) * [1.0, 1e-20, -2.0]
    evidence = Evidence(batch, ("tau",), seen, 0.0 * seen, 0.0 * seen + 1e-15, 0.0 * seen)
    assert results(evidence) == 2 * 2
