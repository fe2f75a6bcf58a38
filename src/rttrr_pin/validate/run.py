"""Run a validation: block by block, ours against an oracle's."""

from __future__ import annotations

import platform
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib import metadata

import numpy as np

from rttrr_pin.arithmetic import Load
from rttrr_pin.batch import blocks
from rttrr_pin.certify import Settlement
from rttrr_pin.errors import InputError
from rttrr_pin.model import Drive, LinkWrenches, Wrench
from rttrr_pin.model.inputs import whole_number
from rttrr_pin.oracles import Evaluation, Oracle, make_oracle
from rttrr_pin.robot import Robot
from rttrr_pin.validate.compare import Comparison, Gap, Row, Worst
from rttrr_pin.validate.ours import Ours
from rttrr_pin.validate.settle import settle_state
from rttrr_pin.validate.states import LAST_STATE, Sampler, States

BLOCK = 1024
"""States compared at a time; the memory of a run is that of one block, whatever the number of states."""

HUGE = 1e140
"""Numbers whose squares, times anything that occurs, stay within float64."""

Progress = Callable[[int], None]
"""Called with the number of states done so far."""


@dataclass(frozen=True, slots=True)
class Validation:
    """The outcome of a run.

    Attributes:
        robot: its name.
        base: "fixed" or "floating".
        gravity: the field in the base frame [m/s^2].
        drives: by joint, what joints take themselves; those that take nothing are left out.
        oracle: name and version of the other program.
        n_states: how many states were compared.
        family: how they were drawn.
        seed: of the generator.
        payload: what the robot carried, in words.
        rows: what was seen of each quantity at each link or joint.
        whole: by quantity, the largest error in eps, in the norm over all links or joints.
        seconds: wall time.
        versions: of what took part.
        failing: how many states lie outside the gate.
        settled: who is right, by balls: in the worst failing states, worst first, then in the worst passing one.
    """

    robot: str
    base: str
    gravity: tuple[float, ...]
    drives: dict[str, Drive]
    oracle: str
    n_states: int
    family: str
    seed: int
    payload: str
    rows: tuple[Row, ...]
    whole: dict[str, Worst]
    seconds: float
    versions: dict[str, str] = field(default_factory=dict)
    failing: int = 0
    settled: tuple[Settlement, ...] = ()

    @property
    def agrees(self) -> bool:
        """Whether there was something to compare, and every state of every row lies within the gate."""
        return bool(self.rows) and all(row.passed for row in self.rows)

    @property
    def worst(self) -> Row | None:
        """The row that comes closest to its gate, or lies furthest beyond; None for a robot without joints."""
        return max(self.rows, key=lambda row: row.share.value, default=None)


@dataclass(frozen=True, slots=True)
class StateReport:
    """One state in full: ours beside the oracle's.

    Attributes:
        robot: its name.
        oracle: name and version of the other program.
        index: which state.
        q_names: names of the coordinates.
        v_names: names of the rates and driving forces.
        states: q, v, a and payload, batches of one.
        ours: our result, a batch of one.
        theirs: the oracle's.
        bound: the bound on our rounding.
        rows: labels of the gaps.
        gaps: how far apart, one for each row.
        settled: who is right, by balls.
    """

    robot: str
    oracle: str
    index: int
    q_names: tuple[str, ...]
    v_names: tuple[str, ...]
    states: States
    ours: LinkWrenches
    theirs: LinkWrenches
    bound: LinkWrenches
    rows: tuple[Row, ...]
    gaps: tuple[Gap, ...]
    settled: Settlement

    @property
    def agrees(self) -> bool:
        """Whether every row lies within the gate."""
        return all(bool(gap.share[0] <= 1.0) for gap in self.gaps)


@dataclass(frozen=True, slots=True)
class Contest:
    """Two programs on the states of a robot.

    Attributes:
        robot: the robot.
        sampler: draws the states.
        ours: our side.
        oracle: the other.
        comparison: gathers what is seen.
    """

    robot: Robot
    sampler: Sampler
    ours: Ours
    oracle: Oracle
    comparison: Comparison

    @classmethod
    def of(
        cls, robot: Robot, seed: int, family: str, payload: Wrench | str | None, oracle: str, states: int
    ) -> Contest:
        """Prepare to compare so many states.

        Raises:
            InputError: an argument cannot be used.
            OracleError: the oracle is missing, refuses the robot, or built another model than the file describes.
        """
        if not isinstance(robot, Robot):
            raise InputError(f"robot is a {type(robot).__name__}: pass a Robot, such as rttrr_pin.load({robot!r})")
        if not robot.model.links:
            raise InputError(f"robot {robot.name!r} has no joint, so that there is nothing to compare")
        sampler = Sampler(robot.model, family, seed, _payload(robot, payload))
        other = make_oracle(oracle, robot.model)
        return cls(robot, sampler, Ours(robot, states), other, Comparison(robot.model, other.quantities))

    def both(self, drawn: States) -> tuple[LinkWrenches, Evaluation, LinkWrenches]:
        """Ours, the oracle's, and the bound on ours."""
        with np.errstate(over="ignore", invalid="ignore"):  # what overflows is shown as a failure, with its state
            ours, bound = self.ours(drawn)
            _check_size(ours, drawn.first)
            theirs = self.oracle.evaluate(drawn.q, drawn.v, drawn.a, drawn.loads)
        return ours, theirs, bound

    def gaps(self, drawn: States) -> list[Gap]:
        """How far apart the two are, one for each row of the comparison."""
        return list(self.comparison.gaps(*self.both(drawn)))

    def settled(self, drawn: States) -> Settlement:
        """Who is right in one state."""
        return settle_state(self.robot.model, drawn, *self.both(drawn), self.oracle.name)


def validate(
    robot: Robot,
    states: int = 10_000,
    seed: int = 0,
    family: str = "uniform",
    payload: Wrench | str | None = None,
    oracle: str = "pinocchio",
    progress: Progress | None = None,
) -> Validation:
    """Compare our recursion with an oracle on many states.

    Args:
        robot: the robot.
        states: how many.
        seed: of the generator; the same seed gives the same states.
        family: how they are drawn, one of `FAMILIES`.
        payload: None; a wrench, the same in every state; or `"random"`, another in each state.
        oracle: one of `oracles.ORACLES`.
        progress: called after each block with the number of states done.

    Returns:
        The worst of each quantity at each link, and the verdict.

    Raises:
        InputError: an argument cannot be used.
        OracleError: the oracle is missing, refuses the robot, or built another model than the file describes.
    """
    whole_number("states", states, 1, LAST_STATE, "10^15, since none would prove nothing")
    start = time.perf_counter()
    contest = Contest.of(robot, seed, family, payload, oracle, states)
    other, comparison = contest.oracle, contest.comparison
    for part in blocks(states, BLOCK):
        drawn = contest.sampler.draw(part.start, part.stop - part.start)
        comparison.add(drawn.first, *contest.both(drawn))
        if progress is not None:
            progress(part.stop)
    settled = tuple(contest.settled(contest.sampler.draw(state, 1)) for state in comparison.ranking.chosen())
    return Validation(
        robot=robot.name,
        base="floating" if robot.model.floating else "fixed",
        gravity=tuple(robot.model.gravity.tolist()),
        drives={joint.name: joint.drive for joint in robot.model.joints if joint.drive != Drive()},
        oracle=f"{other.name} {other.version}",
        n_states=states,
        family=family,
        seed=seed,
        payload=in_words(payload),
        rows=tuple(comparison.rows),
        whole=comparison.whole,
        seconds=time.perf_counter() - start,
        versions=versions(other),
        failing=comparison.ranking.failing,
        settled=settled,
    )


def compare_state(
    robot: Robot,
    index: int,
    seed: int = 0,
    family: str = "uniform",
    payload: Wrench | str | None = None,
    oracle: str = "pinocchio",
    states: int = 10_000,
) -> StateReport:
    """One of the states that `validate` draws for the same seed, family, payload and number of states, in full.

    Raises:
        InputError: an argument cannot be used.
        OracleError: as in `validate`.
    """
    whole_number("state", index, 0, LAST_STATE, "10^15")
    contest = Contest.of(robot, seed, family, payload, oracle, states)
    other, comparison = contest.oracle, contest.comparison
    drawn = contest.sampler.draw(index, 1)
    ours, theirs, bound = contest.both(drawn)
    gaps = tuple(comparison.gaps(ours, theirs, bound))
    label = f"{other.name} {other.version}"
    rows = tuple(comparison.rows)
    return StateReport(
        robot.name,
        label,
        index,
        robot.model.q_names,
        robot.model.v_names,
        drawn,
        ours,
        theirs.wrenches,
        bound,
        rows,
        gaps,
        settle_state(robot.model, drawn, ours, theirs, bound, other.name),
    )


def versions(oracle: Oracle) -> dict[str, str]:
    """What took part, so that a result can be had again."""
    return {
        "rttrr-pin": metadata.version("rttrr-pin"),
        oracle.name: oracle.version,
        "numpy": np.__version__,
        "python": platform.python_version(),
        "machine": platform.machine(),
    }


def _payload(robot: Robot, payload: Wrench | str | None) -> Load | str | None:
    """For the sampler: a load, or the name of the link that gets a random one."""
    if payload is None:
        return None
    if isinstance(payload, str):
        if payload != "random":
            raise InputError(f"payload is {payload!r}: expected 'random' or a Wrench")
        return robot.link_names[robot.payload_link(None)]
    load = robot.load_of(payload)
    if load.f.ndim > 1 or load.n.ndim > 1:
        raise InputError("the payload of a validation has a batch axis: pass one force and one moment of 3 numbers")
    return load


def in_words(payload: Wrench | str | None) -> str:
    """A payload as reports name it."""
    if isinstance(payload, Wrench):
        axes = "base axes" if payload.expressed_in == "base" else "link axes"
        f, n = (np.asarray(x, dtype=float).tolist() for x in (payload.force, payload.moment))
        return f"force {f} N, moment {n} N m at {payload.link or 'the tool'}, {axes}"
    return payload or "none"


def _check_size(ours: LinkWrenches, first: int) -> None:
    """Norms square what they are of: numbers whose squares overflow cannot be compared."""
    for key, x in ours.items():
        sizes = np.abs(x).reshape(len(x), -1).max(axis=1, initial=0.0)
        if not (sizes <= HUGE).all():
            row = int(np.argmax(~(sizes <= HUGE)))
            raise InputError(
                f"{key} reaches {sizes[row]:.1e} in state {first + row}, beyond {HUGE:.0e}, which no norm can hold: "
                "pass gravity, payload and masses of a size that a robot can have"
            )
