"""Who is right in a state: each program against enclosures of the true values, within its own allowance.

The tolerance is the sum of the allowances, so where a state is beyond it, at least one program is beyond its own.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError
from rttrr_pin.exact.adjudication import Adjudication, Assessment, Deviation, in_order, nearest
from rttrr_pin.exact.enclosures import Enclosures, enclose
from rttrr_pin.exact.parameters import Parameters, exact_parameters
from rttrr_pin.implementations import Batch, Evaluation
from rttrr_pin.validation.compare import Comparison, ratio


def adjudicate(batch: Batch, results: Sequence[tuple[str, Evaluation]]) -> Adjudication:
    """Each program in one state, the subject first.

    Args:
        batch: the state, a batch of one.
        results: by name, what each program gave.
    """
    enclosures = enclose(batch.model, batch.q, batch.v, batch.a, batch.loads, true_parameters(batch.model))
    assessments = tuple(assess(batch, enclosures, name, evaluation) for name, evaluation in results)
    return Adjudication(batch.first, int(np.max(enclosures.bits)), assessments)


def assess(batch: Batch, enclosures: Enclosures, name: str, evaluation: Evaluation) -> Assessment:
    """How far one program is off the true values of one state, quantity by quantity, in the order of the recursion."""
    comparison = Comparison(batch.model, tuple(evaluation.values))
    truth = Evaluation(nearest(enclosures, evaluation.values), {}, evaluation.tau_joint)
    truth = Evaluation(truth.values, {key: np.zeros(x.shape[:2]) for key, x in truth.values.items()}, truth.tau_joint)
    rows = zip(comparison.rows, comparison.differences(batch, evaluation, truth), strict=True)
    deviations = [
        Deviation(row.quantity, row.at, float(x.relative[0]), float(ratio(x.error, x.of_subject)[0])) for row, x in rows
    ]
    return Assessment(name, in_order(batch.model, deviations))


def true_parameters(model: Model) -> Parameters:
    """Whose numbers decide who is right: the file's, as any program reads them; without a file, the model's own."""
    try:
        exact_parameters(model, "read")
    except InputError:
        return "doubles"
    return "read"
