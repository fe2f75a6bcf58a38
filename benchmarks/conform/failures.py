"""A failure as a maintainer can look at it: one state, what the library gives, and proven bounds of the true value."""

from __future__ import annotations

from typing import Any

import numpy as np

from rttrr_pin.conformance import Case, LevelResult
from rttrr_pin.conformance.judging import truth
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.errors import RttrrError
from rttrr_pin.implementations import make_implementation
from rttrr_pin.implementations.protocol import Batch, evaluated


def failure(result: LevelResult, case: Case, source: Any) -> dict[str, Any]:
    """The number that is farthest beyond rounding, asked once more, in its state alone."""
    assert result.worst is not None
    quantity, worst = result.worst
    batch, k = case.batch, worst.state
    loads = tuple(Load(x.link, at(x.f, k), at(x.n, k), x.in_base) for x in batch.loads)
    one = Batch(batch.model, batch.q[k : k + 1], batch.v[k : k + 1], batch.a[k : k + 1], loads)
    enclosure = getattr(truth(case), quantity)
    names = batch.model.link_names if quantity in LINK_QUANTITIES else batch.model.v_names
    place = names.index(worst.at)
    try:
        given = np.atleast_1d(evaluated(make_implementation(source, batch.model), one).values[quantity][0, place])
    except RttrrError:
        given = np.array([np.nan])
    lower, upper = (np.atleast_1d(x[k, place]) for x in (enclosure.lower, enclosure.upper))
    state: dict[str, Any] = {key: getattr(one, key)[0].tolist() for key in ("q", "v", "a")}
    if loads:
        state["payload"] = [
            {"link": batch.model.link_names[x.link], "f": np.ravel(x.f).tolist(), "n": np.ravel(x.n).tolist()}
            for x in loads
        ]
    return {
        "id": result.id,
        "quantity": quantity,
        "at": worst.at,
        "unit": worst.unit,
        "beyond": sum(own.failures for own in result.quantities),
        "count": sum(own.count for own in result.quantities),
        "state": {key: repr(x) for key, x in state.items()},  # as text: every digit
        "given": repr(given.tolist()),
        "lower": repr(lower.tolist()),
        "upper": repr(upper.tolist()),
        "cause": result.cause or "not looked for",
    }


def at(x: Any, k: int) -> Any:
    """The row of a state, of what may be the same in all."""
    return x if x.ndim == 1 else x[k : k + 1]
