"""Settle states by the gate: ours and the oracle's, each against the true values and within its own half of the gate.

The two halves are `compare`'s: ours may be off by the running error bound, the oracle by its allowance. So where a
state is outside the gate, at least one of the two is outside its half.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import LINK_QUANTITIES, LinkWrenches
from rttrr_pin.errors import InputError
from rttrr_pin.exact.adjudication import Adjudication, Assessment, Deviation, in_order, nearest
from rttrr_pin.exact.enclosures import Enclosures, enclose
from rttrr_pin.exact.parameters import Parameters, exact_parameters
from rttrr_pin.implementations import Evaluation
from rttrr_pin.validation.compare import Comparison, Gap, ratio
from rttrr_pin.validation.states import States


def adjudicate_state(
    model: Model, drawn: States, ours: LinkWrenches, bound: LinkWrenches, others: Sequence[tuple[str, Evaluation]]
) -> tuple[Adjudication, ...]:
    """Who is right in one state, ours or each of the others; the truth is the same for all.

    Args:
        model: the robot.
        drawn: the state, (1, ...).
        ours: our result, (1, ...).
        bound: running error bound of ours.
        others: by name, an oracle's result, and what it rounds beyond ours.
    """
    enclosures = enclose(model, drawn.q, drawn.v, drawn.a, drawn.loads, true_numbers(model))
    adjudicated = (adjudicate(model, enclosures, ours, theirs, bound, name, drawn.first) for name, theirs in others)
    return tuple(adjudicated)


def adjudicate(
    model: Model,
    enclosures: Enclosures,
    ours: LinkWrenches,
    theirs: Evaluation,
    bound: LinkWrenches,
    oracle: str,
    state: int = 0,
) -> Adjudication:
    """Who is right, by enclosures of the true values of one state, (1, ...) each.

    Args:
        model: the robot.
        enclosures: the true values.
        ours: our result.
        theirs: the oracle's, and what it rounds beyond ours.
        bound: running error bound of ours.
        oracle: its name.
        state: its index, for the report.
    """
    given = LINK_QUANTITIES if theirs.wrenches.links else ()
    nothing = {key: np.zeros((1, len(model.links))) for key in LINK_QUANTITIES}
    sides = []
    for name, computed, known, rounding in (
        ("ours", ours, LINK_QUANTITIES, nothing),
        (oracle, theirs.wrenches, given, theirs.rounding),
    ):
        comparison = Comparison(model, ("tau", *known))
        truth = Evaluation(nearest(enclosures, computed), rounding)
        rows = zip(comparison.rows, comparison.gaps(computed, truth, bound), strict=True)
        deviations = [
            Deviation(row.quantity, row.at, float(gap.relative[0]), _share(gap, name == "ours")) for row, gap in rows
        ]
        sides.append(Assessment(name, in_order(model, deviations)))
    return Adjudication(state, int(np.max(enclosures.bits)), *sides)


def _share(gap: Gap, of_ours: bool) -> float:
    """|computed - true| as a share of one half of the gate."""
    return float(ratio(gap.difference, gap.own if of_ours else gap.allowance)[0])


def true_numbers(model: Model) -> Parameters:
    """Whose numbers decide who is right: the file's, as any program reads them; without a file, the model's own."""
    try:
        exact_parameters(model, "read")
    except InputError:
        return "doubles"
    return "read"
