"""Compare a subject with its references on many states, block by block."""

from __future__ import annotations

import platform
import time
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from rttrr_pin.core.joint import JointEffects
from rttrr_pin.exact import Adjudication
from rttrr_pin.implementations import Implementation, label
from rttrr_pin.implementations.registry import Source
from rttrr_pin.reporting.results import Summarised, finite
from rttrr_pin.robot import Robot
from rttrr_pin.validation.compare import Comparison, Row, farthest_of
from rttrr_pin.validation.comparison import References, Run
from rttrr_pin.validation.ranking import Worst
from rttrr_pin.validation.sampling import Payload
from rttrr_pin.validation.states import Progress, check_count
from rttrr_pin.version import __version__

TOLERANCE = "|subject - reference| <= allowance of the subject + allowance of the reference (docs/tolerance.md)"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Validation(Summarised):
    """The outcome of a run.

    Attributes:
        robot: its name.
        base: "fixed" or "floating".
        gravity: the field in the base frame [m/s^2].
        effects: by joint, armature, damping and friction; joints that have none are left out.
        subject: name and version of the program that is judged.
        references: those that it was compared with, and what was seen of each.
        n_states: how many states were compared.
        sampling: how they were drawn; "table" where a table of results brought them.
        seed: of the generator.
        payload: what the robot carried, in words.
        notes: what a reader of the verdict must know, such as the digits that a table is judged at, or numbers that a
            library took other than the file has them.
        seconds: wall time.
        versions: of what took part.
        failing: how many states lie beyond the tolerance of any reference.
        adjudications: who is right, by the exact reference: in the worst failing states, worst first, then in the worst
            passing one.
    """

    robot: str
    base: str
    gravity: tuple[float, ...]
    effects: dict[str, JointEffects]
    subject: str
    references: tuple[Comparison, ...]
    n_states: int
    sampling: str
    seed: int
    payload: str
    notes: tuple[str, ...]
    seconds: float
    versions: dict[str, str] = field(default_factory=dict)
    failing: int = 0
    adjudications: tuple[Adjudication, ...] = ()

    @property
    def reference(self) -> str:
        """Names and versions of the references."""
        return ", ".join(f"{other.name} {other.version}".rstrip() for other in self.references)

    @property
    def rows(self) -> tuple[Row, ...]:
        """What was seen of each quantity at each link or joint, reference by reference."""
        return tuple(row for other in self.references for row in other.rows)

    @property
    def whole(self) -> dict[str, Worst]:
        """By quantity, the largest relative error in eps against any reference, over all links or joints."""
        largest: dict[str, Worst] = {}
        for other in self.references:
            for quantity, worst in other.whole.items():
                largest[quantity] = max(worst, largest.get(quantity, worst), key=lambda seen: seen.value)
        return largest

    @property
    def passed(self) -> bool:
        """Whether every state of every row of every reference lies within the tolerance."""
        return all(other.passed for other in self.references)

    @property
    def worst(self) -> Row:
        """The row that comes closest to its tolerance, or lies furthest beyond."""
        return farthest_of(self.rows)

    def summary(self) -> str:
        """The verdict in one sentence."""
        compared = f"{self.subject} against {self.reference} on {self.n_states:,} states of {self.robot}"
        if self.passed:
            return f"PASS {compared}: all within rounding"
        first = next(row for row in self.rows if not row.passed)
        return f"FAIL {compared}: {self.failing:,} states beyond rounding, first {first.quantity} at {first.at}"

    def to_dict(self) -> dict[str, Any]:
        """Everything as data for JSON."""
        data = {
            "schema": 1,
            "passed": self.passed,
            "robot": self.robot,
            "base": self.base,
            "gravity": self.gravity,
            "joint_effects": {name: asdict(effects) for name, effects in self.effects.items()},
            "subject": self.subject,
            "references": [other.to_dict() for other in self.references],
            "n_states": self.n_states,
            "sampling": self.sampling,
            "seed": self.seed,
            "payload": self.payload,
            "notes": self.notes,
            "tolerance": TOLERANCE,
            "failing_states": self.failing,
            "adjudications": [adjudication_dict(one) for one in self.adjudications],
            "versions": self.versions,
            "seconds": self.seconds,
        }
        return finite(data)


def adjudication_dict(adjudication: Adjudication) -> dict[str, Any]:
    """Who is right in one state, as data."""
    programs = [
        {
            "program": one.name,
            "right": one.right,
            "first_wrong": None if one.first_wrong is None else asdict(one.first_wrong),
            "farthest": asdict(one.farthest),
        }
        for one in adjudication.assessments
    ]
    return {"state": adjudication.state, "bits": adjudication.bits, "programs": programs}


def validate(
    robot: Robot,
    subject: Source = "kernel",
    reference: References = "pinocchio",
    n_states: int = 10_000,
    seed: int = 0,
    sampling: str = "uniform",
    payload: Payload = None,
    progress: Progress | None = None,
) -> Validation:
    """Judge one program by one or several others on many states.

    Args:
        robot: the robot.
        subject: the program that is judged: a name (`"kernel"`, `"recursion"`, `"pinocchio"`, `"mujoco"`,
            `"lagrange"`), an `Implementation`, a function f(q, v, a) of one state or a batch, a class or a function of
            one argument, the `Model`, that makes either, the path of a table of results, or the command line of a
            program.
        reference: what it is compared with, likewise; several in a list.
        n_states: how many states; of a table all of its own.
        seed: of the generator; the same seed gives the same states.
        sampling: how they are drawn, one of `SAMPLINGS`.
        payload: None; a wrench, the same in every state; or `RandomPayload()`, another in each state.
        progress: called after each block with the number of states done.

    Returns:
        The worst of each quantity at each link, and the verdict.

    Raises:
        InputError: an argument cannot be used.
        ImplementationError: a program is missing, refuses the robot, dies, or built another model than the file says.
    """
    n_states = check_count(n_states)
    start = time.perf_counter()
    run = Run.of(robot, subject, reference, seed, sampling, payload)
    for batch in run.states.blocks(n_states, progress):
        run.add(batch)
    run.check_compared()
    chosen = (run.states.batch(state, 1) for state in run.ranking.chosen())
    adjudications = tuple(run.adjudicate(batch, run.evaluate(batch)) for batch in chosen)
    return Validation(
        robot=robot.name,
        base="floating" if robot.model.floating else "fixed",
        gravity=tuple(robot.model.gravity.tolist()),
        effects={joint.name: joint.effects for joint in robot.model.joints if joint.effects != JointEffects()},
        subject=label(run.subject),
        references=run.comparisons,
        n_states=run.states.count(n_states),
        sampling=run.states.sampling,
        seed=run.states.sampler.seed,
        payload=run.states.described(payload),
        notes=run.notes,
        seconds=time.perf_counter() - start,
        versions=versions(run.programs),
        failing=run.ranking.failing,
        adjudications=adjudications,
    )


def versions(programs: Iterable[Implementation]) -> dict[str, str]:
    """What took part, so that a result can be had again."""
    return {
        "rttrr-pin": __version__,
        **{program.name: program.version for program in programs if program.version},
        "numpy": np.__version__,
        "python": platform.python_version(),
        "machine": platform.machine(),
    }
