"""Run a validation: block by block, ours against the oracles'."""

from __future__ import annotations

import platform
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from importlib import metadata

import numpy as np

from rttrr_pin.core.batch import blocks
from rttrr_pin.core.inputs import whole_number
from rttrr_pin.core.joint import JointEffects
from rttrr_pin.core.wrench import Wrench
from rttrr_pin.exact import Adjudication
from rttrr_pin.implementations import Oracle
from rttrr_pin.robot import Robot
from rttrr_pin.validation.compare import Row, Worst
from rttrr_pin.validation.comparison_run import ComparisonRun, Oracles, Reference
from rttrr_pin.validation.states import LAST_STATE

BLOCK = 1024
"""States compared at a time; the memory of a run is that of one block, whatever the number of states."""

Progress = Callable[[int], None]
"""Called with the number of states done so far."""


@dataclass(frozen=True, slots=True)
class ReferenceSummary:
    """What was seen of one oracle.

    Attributes:
        name: of the other program.
        version: of it.
        rows: what was seen of each quantity at each link or joint.
        whole: by quantity, the largest error in eps, in the norm over all links or joints.
    """

    name: str
    version: str
    rows: tuple[Row, ...]
    whole: dict[str, Worst]

    @classmethod
    def of(cls, reference: Reference) -> ReferenceSummary:
        """What an opponent's comparison has gathered."""
        oracle, comparison = reference.oracle, reference.comparison
        return cls(oracle.name, oracle.version, tuple(comparison.rows), comparison.whole)

    @property
    def agrees(self) -> bool:
        """Whether there was something to compare, and every state of every row lies within the gate."""
        return bool(self.rows) and all(row.passed for row in self.rows)

    @property
    def worst(self) -> Row:
        """The row that comes closest to its gate, or lies furthest beyond."""
        return max(self.rows, key=lambda row: row.share.value)


@dataclass(frozen=True, slots=True)
class Validation:
    """The outcome of a run.

    Attributes:
        robot: its name.
        base: "fixed" or "floating".
        gravity: the field in the base frame [m/s^2].
        effects: by joint, what joints take themselves; those that take nothing are left out.
        against: the other programs, and what was seen of each.
        n_states: how many states were compared.
        sampling: how they were drawn.
        seed: of the generator.
        payload: what the robot carried, in words.
        ours: which program stood on our side, in words.
        seconds: wall time.
        versions: of what took part.
        failing: how many states lie outside the gate of any oracle.
        adjudicated: who is right, by balls: in the worst failing states, worst first, then in the worst passing one; of
            several oracles one settlement each, in their order, for every such state.
    """

    robot: str
    base: str
    gravity: tuple[float, ...]
    effects: dict[str, JointEffects]
    against: tuple[ReferenceSummary, ...]
    n_states: int
    sampling: str
    seed: int
    payload: str
    ours: str
    seconds: float
    versions: dict[str, str] = field(default_factory=dict)
    failing: int = 0
    adjudicated: tuple[Adjudication, ...] = ()

    @property
    def oracle(self) -> str:
        """Names and versions of the other programs."""
        return ", ".join(f"{other.name} {other.version}" for other in self.against)

    @property
    def rows(self) -> tuple[Row, ...]:
        """What was seen of each quantity at each link or joint, oracle by oracle."""
        return tuple(row for other in self.against for row in other.rows)

    @property
    def whole(self) -> dict[str, Worst]:
        """By quantity, the largest error in eps against any oracle, in the norm over all links or joints."""
        found: dict[str, Worst] = {}
        for other in self.against:
            for quantity, worst in other.whole.items():
                found[quantity] = max(worst, found.get(quantity, worst), key=lambda seen: seen.value)
        return found

    @property
    def agrees(self) -> bool:
        """Whether every state of every row of every oracle lies within the gate."""
        return all(other.agrees for other in self.against)

    @property
    def worst(self) -> Row | None:
        """The row that comes closest to its gate, or lies furthest beyond; None for a robot without joints."""
        return max(self.rows, key=lambda row: row.share.value, default=None)

    @property
    def adjudicated_states(self) -> list[tuple[Adjudication, ...]]:
        """The settlements state by state, one for each oracle."""
        count = len(self.against)
        return [self.adjudicated[k : k + count] for k in range(0, len(self.adjudicated), count)]


def validate(
    robot: Robot,
    states: int = 10_000,
    seed: int = 0,
    sampling: str = "uniform",
    payload: Wrench | str | None = None,
    oracle: Oracles = "pinocchio",
    progress: Progress | None = None,
) -> Validation:
    """Compare our recursion with one or several oracles on many states.

    Args:
        robot: the robot.
        states: how many.
        seed: of the generator; the same seed gives the same states.
        sampling: how they are drawn, one of `SAMPLINGS`.
        payload: None; a wrench, the same in every state; or `"random"`, another in each state.
        oracle: one of `oracles.ORACLES`, or several: all see the same states.
        progress: called after each block with the number of states done.

    Returns:
        The worst of each quantity at each link, and the verdict.

    Raises:
        InputError: an argument cannot be used.
        OracleError: an oracle is missing, refuses the robot, or built another model than the file describes.
    """
    whole_number("states", states, 1, LAST_STATE, "10^15, since none would prove nothing")
    start = time.perf_counter()
    run = ComparisonRun.of(robot, seed, sampling, payload, oracle, states)
    for part in blocks(states, BLOCK):
        run.add(run.sampler.draw(part.start, part.stop - part.start))
        if progress is not None:
            progress(part.stop)
    adjudicated = [run.adjudicated(run.sampler.draw(state, 1)) for state in run.ranking.chosen()]
    return Validation(
        robot=robot.name,
        base="floating" if robot.model.floating else "fixed",
        gravity=tuple(robot.model.gravity.tolist()),
        effects={joint.name: joint.effects for joint in robot.model.joints if joint.effects != JointEffects()},
        against=tuple(ReferenceSummary.of(reference) for reference in run.references),
        n_states=states,
        sampling=sampling,
        seed=seed,
        payload=in_words(payload),
        ours=run.ours.name,
        seconds=time.perf_counter() - start,
        versions=versions([reference.oracle for reference in run.references]),
        failing=run.ranking.failing,
        adjudicated=tuple(one for of_state in adjudicated for one in of_state),
    )


def versions(oracles: Sequence[Oracle]) -> dict[str, str]:
    """What took part, so that a result can be had again."""
    return {
        "rttrr-pin": metadata.version("rttrr-pin"),
        **{oracle.name: oracle.version for oracle in oracles},
        "numpy": np.__version__,
        "python": platform.python_version(),
        "machine": platform.machine(),
    }


def in_words(payload: Wrench | str | None) -> str:
    """A payload as reports name it."""
    if isinstance(payload, Wrench):
        axes = "base axes" if payload.expressed_in == "base" else "link axes"
        f, n = (np.asarray(x, dtype=float).tolist() for x in (payload.force, payload.moment))
        return f"force {f} N, moment {n} N m at {payload.link or 'the tool'}, {axes}"
    return payload or "none"
