"""Looks for the state at which a subject and its references differ most, in parts of what rounding can explain.

Random states seldom meet the worst. Differential evolution (Storn and Price, "Differential evolution", 1997; SciPy's)
does: it needs no derivatives, which rounding errors do not have, and takes whole populations of states at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import differential_evolution

from rttrr_pin.core.arguments import whole_number
from rttrr_pin.core.arrays import Array
from rttrr_pin.errors import InputError
from rttrr_pin.implementations import Batch, label
from rttrr_pin.implementations.registry import Source
from rttrr_pin.reporting.results import Summarised, finite
from rttrr_pin.robot import Robot
from rttrr_pin.validation.comparison import References, Run
from rttrr_pin.validation.sampling import Payload
from rttrr_pin.validation.states import Progress, payload_data

POPULATION = 256
"""States in one generation."""

FEWEST, MOST = 2 * POPULATION, 10**9
"""States that a search can be told to look at: two generations, and more than anyone has time for."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class WorstCase(Summarised):
    """The worst state that a search came to.

    Attributes:
        subject: name and version of the program that is judged.
        reference: the program that it differs from there.
        quantity: tau, F, N, f or n.
        at: name of the link (of the joint for tau).
        of_tolerance: error / tolerance.
        random: the largest error / tolerance among the random states that the search started from.
        evaluations: how many states were looked at.
        seed: of the search; the same seed comes to the same state.
        batch: the state, a batch of one.
        notes: what a reader of the verdict must know, as in `Validation`.
    """

    subject: str
    reference: str
    quantity: str
    at: str
    of_tolerance: float
    random: float
    evaluations: int
    seed: int
    batch: Batch
    notes: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether even this state lies within the tolerance."""
        return self.of_tolerance <= 1.0

    def summary(self) -> str:
        """The verdict in one sentence."""
        return (
            f"{'PASS' if self.passed else 'FAIL'} {self.subject} against {self.reference}: worst of "
            f"{self.evaluations:,} states searched, seed {self.seed}: error / tolerance {self.of_tolerance:.3f} in "
            f"{self.quantity} at {self.at}, where random states had {self.random:.3f}"
        )

    def to_dict(self) -> dict[str, Any]:
        """Everything as data for JSON, with the state."""
        names = ("subject", "reference", "quantity", "at", "of_tolerance", "random", "evaluations", "seed")
        state = {name: getattr(self.batch, name)[0].tolist() for name in "qva"} | {"payload": payload_data(self.batch)}
        own = {name: getattr(self, name) for name in names}
        data = {"schema": 1, "passed": self.passed, **own, **state, "notes": self.notes}
        return finite(data)


def search_worst_state(
    robot: Robot,
    subject: Source = "kernel",
    reference: References = "pinocchio",
    evaluations: int = 20_000,
    seed: int = 0,
    payload: Payload = None,
    progress: Progress | None = None,
) -> WorstCase:
    """Look for the state at which a subject and its references differ most, as error / tolerance.

    It looks at about `evaluations` states, at least 512, within the ranges of `validate`'s uniform states; a random
    payload is varied too. Of several references the largest error / tolerance against any of them counts. All else is
    as in `validate`.

    Raises:
        InputError: an argument cannot be used.
        ImplementationError: as in `validate`.
    """
    evaluations = whole_number("evaluations", evaluations, FEWEST, MOST, "10^9", "--evaluations")
    run = Run.of(robot, subject, reference, seed, "uniform", payload)
    if run.states.table is not None:
        raise InputError("a table of results has its own states, and a search makes new ones: name a program")
    sampler = run.states.sampler
    rng = np.random.default_rng(sampler.seed)
    start = rng.random((POPULATION, sampler.numbers))
    done = 0

    def ratios(batch: Batch) -> Array:
        """Error / tolerance, (rows, N)."""
        differences = run.differences(batch, run.evaluate(batch))
        return np.concatenate([of_reference.of_tolerance for of_reference in differences])

    def closeness(columns: Array) -> Array:
        """What is minimised: minus the largest error / tolerance of each state."""
        nonlocal done
        unit = np.atleast_2d(columns.T)
        worst: Array = ratios(sampler.made_of(unit)).max(axis=0)
        done += len(unit)
        if progress is not None:
            progress(min(done, evaluations))
        return -worst

    random = float(-closeness(start.T).min())
    optimum = differential_evolution(
        closeness,
        [(0.0, 1.0)] * sampler.numbers,
        init=start,
        maxiter=evaluations // POPULATION - 1,
        tol=0.0,  # with atol: no stop before the last generation, since equal ratios are no convergence
        atol=0.0,
        polish=False,  # rounding errors have no gradient
        vectorized=True,
        updating="deferred",
        rng=rng,
    )
    run.check_compared()
    batch = sampler.made_of(np.atleast_2d(optimum.x))
    reached = ratios(batch)[:, 0]
    pairs = zip(run.references, run.comparisons, strict=True)
    rows = [(label(reference), row.quantity, row.at) for reference, comparison in pairs for row in comparison.rows]
    worst = int(np.argmax(reached))
    return WorstCase(
        label(run.subject), *rows[worst], float(reached[worst]), random, done, sampler.seed, batch, run.notes
    )
