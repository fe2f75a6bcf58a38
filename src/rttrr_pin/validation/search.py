"""Looks for the worst case: states at which the difference is the largest share of what rounding can explain.

Random states seldom meet the worst. Differential evolution (Storn and Price, "Differential evolution", 1997; SciPy's)
does: it needs no derivatives, which rounding errors do not have, and takes whole populations of states at once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import differential_evolution

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.inputs import whole_number
from rttrr_pin.core.wrench import Wrench
from rttrr_pin.robot import Robot
from rttrr_pin.validation.comparison_run import ComparisonRun, Oracles
from rttrr_pin.validation.states import States

POPULATION = 256
"""States in one generation."""

FEWEST, MOST = 2 * POPULATION, 10**9
"""States that a search can be told to look at: two generations, and more than anyone has time for."""


@dataclass(frozen=True, slots=True)
class WorstCase:
    """The worst case that a search found.

    Attributes:
        quantity: tau, F, N, f or n.
        at: name of the link (of the joint for tau).
        oracle: the program that ours differs from there.
        share: |ours - oracle| as a share of what the gate allows.
        random: the largest share among the random states that the search started from.
        evaluations: how many states were looked at.
        seed: of the search; the same seed finds the same state.
        states: the state, a batch of one.
    """

    quantity: str
    at: str
    oracle: str
    share: float
    random: float
    evaluations: int
    seed: int
    states: States

    @property
    def agrees(self) -> bool:
        """Whether even this state lies within the gate."""
        return self.share <= 1.0


def search(
    robot: Robot,
    evaluations: int = 20_000,
    seed: int = 0,
    payload: Wrench | str | None = None,
    oracle: Oracles = "pinocchio",
    progress: Callable[[int], None] = lambda done: None,
) -> WorstCase:
    """Look for the state at which ours and an oracle differ most, as a share of what rounding can explain.

    Args:
        robot: the robot.
        evaluations: about how many states to look at, at least 512.
        seed: of the search.
        payload: as in `validate`; a random one is varied too.
        oracle: one of `oracles.ORACLES`, or several: what is looked for is the largest share against any of them.
        progress: called with the number of states done.

    Returns:
        The worst state within the ranges of `validate`'s uniform states, and the row that it is worst in.

    Raises:
        InputError: an argument cannot be used.
        OracleError: as in `validate`.
    """
    whole_number("evaluations", evaluations, FEWEST, MOST, "10^9")
    run = ComparisonRun.of(robot, seed, "uniform", payload, oracle, evaluations)
    sampler = run.sampler
    generations = evaluations // POPULATION - 1
    rng = np.random.default_rng(seed)
    start = rng.random((POPULATION, sampler.numbers))
    done = 0

    def closeness(columns: Array) -> Array:
        nonlocal done
        unit = np.atleast_2d(columns.T)
        worst: Array = np.max([gap.share for gap in run.gaps(sampler.made_of(unit))], axis=0)
        done += len(unit)
        progress(min(done, evaluations))
        return -worst

    random = float(-closeness(start.T).min())
    found = differential_evolution(
        closeness,
        [(0.0, 1.0)] * sampler.numbers,
        init=start,
        maxiter=generations,
        tol=0.0,
        atol=0.0,
        polish=False,
        vectorized=True,
        updating="deferred",
        rng=rng,
    )
    state = sampler.made_of(np.atleast_2d(found.x))
    gaps = run.gaps(state)
    k = int(np.argmax([gap.share[0] for gap in gaps]))
    reference, row = run.rows[k]
    return WorstCase(row.quantity, row.at, reference.oracle.name, float(gaps[k].share[0]), random, done, seed, state)
