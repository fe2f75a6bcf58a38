"""One state in full: the subject beside each reference."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from rttrr_pin.core.arguments import whole_number
from rttrr_pin.exact import Adjudication
from rttrr_pin.implementations import Batch, Evaluation, label
from rttrr_pin.implementations.registry import Source
from rttrr_pin.reporting.results import Summarised, finite
from rttrr_pin.robot import Robot
from rttrr_pin.validation.compare import Difference, Row
from rttrr_pin.validation.comparison import References, Run
from rttrr_pin.validation.run import TOLERANCE, adjudication_dict
from rttrr_pin.validation.sampling import LAST_STATE, Payload
from rttrr_pin.validation.states import payload_data


@dataclass(frozen=True, slots=True, eq=False)
class StateComparison:
    """What one reference says of the state.

    Attributes:
        reference: name and version of the program.
        result: what it gave, a batch of one.
        rows: quantity, place and unit of each difference.
        differences: how far apart, one for each row.
    """

    reference: str
    result: Evaluation
    rows: tuple[Row, ...]
    differences: tuple[Difference, ...]

    @property
    def passed(self) -> bool:
        """Whether every row lies within the tolerance."""
        return all(bool(difference.of_tolerance[0] <= 1.0) for difference in self.differences)

    def to_dict(self) -> dict[str, Any]:
        """Everything as data for JSON."""
        pairs = zip(self.rows, self.differences, strict=True)
        return {
            "reference": self.reference,
            "passed": self.passed,
            "values": {key: x[0].tolist() for key, x in self.result.values.items()},
            "differences": [
                {
                    **{name: getattr(row, name) for name in ("quantity", "at", "unit")},
                    "error": float(one.error[0]),
                    "relative_eps": float(one.relative[0]),
                    "of_tolerance": float(one.of_tolerance[0]),
                }
                for row, one in pairs
            ],
        }


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class StateReport(Summarised):
    """One state in full.

    Attributes:
        robot: its name.
        index: which state.
        q_names: names of the coordinates.
        v_names: names of the rates and driving forces.
        links: names of the links.
        batch: q, v, a and payload, a batch of one.
        subject: name and version of the program that is judged.
        result: what it gave, a batch of one.
        comparisons: what each reference says of the state.
        adjudication: who is right, by the exact reference.
        notes: what a reader of the verdict must know, as in `Validation`.
    """

    robot: str
    index: int
    q_names: tuple[str, ...]
    v_names: tuple[str, ...]
    links: tuple[str, ...]
    batch: Batch
    subject: str
    result: Evaluation
    comparisons: tuple[StateComparison, ...]
    adjudication: Adjudication
    notes: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether every row of every reference lies within the tolerance."""
        return all(one.passed for one in self.comparisons)

    def summary(self) -> str:
        """The verdict in one sentence."""
        verdict = "PASS" if self.passed else "FAIL"
        others = ", ".join(one.reference for one in self.comparisons)
        return f"{verdict} {self.subject} against {others} at state {self.index} of {self.robot}"

    def to_dict(self) -> dict[str, Any]:
        """Everything as data for JSON."""
        data = {
            "schema": 1,
            "passed": self.passed,
            "robot": self.robot,
            "state": self.index,
            "q_names": self.q_names,
            "v_names": self.v_names,
            "links": self.links,
            **{name: getattr(self.batch, name)[0].tolist() for name in "qva"},
            "payload": payload_data(self.batch),
            "subject": self.subject,
            "values": {key: x[0].tolist() for key, x in self.result.values.items()},
            "tolerance": TOLERANCE,
            "references": [one.to_dict() for one in self.comparisons],
            "adjudication": adjudication_dict(self.adjudication),
            "notes": self.notes,
        }
        return finite(data)


def compare_state(
    robot: Robot,
    index: int,
    subject: Source = "kernel",
    reference: References = "pinocchio",
    seed: int = 0,
    sampling: str = "uniform",
    payload: Payload = None,
) -> StateReport:
    """One of the states that `validate` compares for the same subject, references, seed, sampling and payload.

    `index` says which of them; of a table it is the row, counted from 0. All else is as in `validate`.

    Raises:
        InputError: an argument cannot be used.
        ImplementationError: as in `validate`.
    """
    index = whole_number("state", index, 0, LAST_STATE, "10^15", "--index")
    run = Run.of(robot, subject, reference, seed, sampling, payload)
    if run.states.table is not None:
        whole_number("state", index, 0, len(run.states.table) - 1, option="--index")
    batch = run.states.batch(index, 1)
    results = run.evaluate(batch)
    seen = zip(run.references, results[1:], run.comparisons, run.differences(batch, results), strict=True)
    model = robot.model
    return StateReport(
        robot=robot.name,
        index=index,
        q_names=model.q_names,
        v_names=model.v_names,
        links=model.link_names,
        batch=batch,
        subject=label(run.subject),
        result=results[0],
        comparisons=tuple(
            StateComparison(label(program), result, comparison.rows, tuple(differences))
            for program, result, comparison, differences in seen
        ),
        adjudication=run.adjudicate(batch, results),
        notes=run.notes,
    )
