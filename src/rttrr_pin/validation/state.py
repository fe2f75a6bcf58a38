"""One state in full: ours beside each oracle's."""

from __future__ import annotations

from dataclasses import dataclass

from rttrr_pin.core.inputs import whole_number
from rttrr_pin.core.wrench import LinkWrenches, Wrench
from rttrr_pin.exact import Adjudication
from rttrr_pin.robot import Robot
from rttrr_pin.validation.compare import Gap, Row
from rttrr_pin.validation.comparison_run import ComparisonRun, Oracles
from rttrr_pin.validation.states import LAST_STATE, States


@dataclass(frozen=True, slots=True)
class StateComparison:
    """What one oracle says of the state.

    Attributes:
        oracle: name and version of the other program.
        theirs: its result, a batch of one.
        rows: labels of the gaps.
        gaps: how far apart, one for each row.
        adjudicated: who is right, by balls.
    """

    oracle: str
    theirs: LinkWrenches
    rows: tuple[Row, ...]
    gaps: tuple[Gap, ...]
    adjudicated: Adjudication

    @property
    def agrees(self) -> bool:
        """Whether every row lies within the gate."""
        return all(bool(gap.share[0] <= 1.0) for gap in self.gaps)


@dataclass(frozen=True, slots=True)
class StateReport:
    """One state in full: ours beside the oracles'.

    `oracle`, `theirs`, `rows`, `gaps` and `settled` are those of the first oracle.

    Attributes:
        robot: its name.
        index: which state.
        q_names: names of the coordinates.
        v_names: names of the rates and driving forces.
        states: q, v, a and payload, batches of one.
        ours: our result, a batch of one.
        bound: the bound on our rounding.
        views: what each oracle says of it.
    """

    robot: str
    index: int
    q_names: tuple[str, ...]
    v_names: tuple[str, ...]
    states: States
    ours: LinkWrenches
    bound: LinkWrenches
    views: tuple[StateComparison, ...]

    @property
    def agrees(self) -> bool:
        """Whether every row of every oracle lies within the gate."""
        return all(view.agrees for view in self.views)

    @property
    def oracle(self) -> str:
        """Name and version of the first oracle."""
        return self.views[0].oracle

    @property
    def theirs(self) -> LinkWrenches:
        """The result of the first oracle, a batch of one."""
        return self.views[0].theirs

    @property
    def rows(self) -> tuple[Row, ...]:
        """Labels of the gaps to the first oracle."""
        return self.views[0].rows

    @property
    def gaps(self) -> tuple[Gap, ...]:
        """How far apart ours and the first oracle are, one for each row."""
        return self.views[0].gaps

    @property
    def adjudicated(self) -> Adjudication:
        """Who is right, ours or the first oracle, by balls."""
        return self.views[0].adjudicated


def compare_state(
    robot: Robot,
    index: int,
    seed: int = 0,
    sampling: str = "uniform",
    payload: Wrench | str | None = None,
    oracle: Oracles = "pinocchio",
    states: int = 10_000,
) -> StateReport:
    """One of the states that `validate` draws for the same seed, family, payload and number of states, in full.

    Raises:
        InputError: an argument cannot be used.
        OracleError: as in `validate`.
    """
    whole_number("state", index, 0, LAST_STATE, "10^15")
    run = ComparisonRun.of(robot, seed, sampling, payload, oracle, states)
    drawn = run.sampler.draw(index, 1)
    sides = run.sides(drawn)
    views = [
        StateComparison(
            reference.label,
            theirs.wrenches,
            tuple(reference.comparison.rows),
            tuple(reference.comparison.gaps(sides.ours, theirs, sides.bound)),
            adjudicated,
        )
        for reference, theirs, adjudicated in zip(
            run.references, sides.theirs, run.adjudicate_results(drawn, sides), strict=True
        )
    ]
    names = robot.model.q_names, robot.model.v_names
    return StateReport(robot.name, index, *names, drawn, sides.ours, sides.bound, tuple(views))
