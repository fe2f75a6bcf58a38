"""What an unexplained difference depends on, where a program can be asked."""

from __future__ import annotations

from typing import Any

import pytest

from rttrr_pin import RandomPayload, load
from rttrr_pin.diagnosis.dependence import dependence
from rttrr_pin.diagnosis.evidence import Evidence, flat, spread
from rttrr_pin.diagnosis.states import sample_states
from rttrr_pin.implementations import default_allowance, make_implementation
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
