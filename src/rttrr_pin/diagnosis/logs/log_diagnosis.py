"""A log beside the model: the residual of each joint, what explains most of it, and what is left."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from rttrr_pin.core.arguments import path_of
from rttrr_pin.core.arrays import Array
from rttrr_pin.diagnosis.engine.evidence import rms
from rttrr_pin.diagnosis.logs.log import Log, read_log
from rttrr_pin.diagnosis.logs.log_causes import Candidate, candidates
from rttrr_pin.diagnosis.logs.residual import Residuals, residuals_of
from rttrr_pin.diagnosis.logs.selection import SAME, Reduced, chosen, columns_of, fitted, reduced
from rttrr_pin.errors import InputError
from rttrr_pin.reporting.results import Summarised, finite
from rttrr_pin.robot import Robot, model_of

SEEN = 0.1
"""Of the noise of a joint: what a cause must make there, root mean square, to be named."""

LEFT = 1.15
"""Times the noise: what is left at most where nothing is left to explain."""

UNTOLD = 1e-4
"""A number of which so much lies in what motion does not tell has no value."""

Verdict = Literal["agrees", "explained", "unexplained"]


@dataclass(frozen=True, slots=True)
class JointResidual:
    """What is between measured and modelled driving force of one degree of freedom [N m or N].

    Attributes:
        rms: root mean square.
        largest: of the absolute values.
        share: rms over that of the measured tau; 0 where that is zero.
        noise: standard deviation by the noise of tau and the errors of v and a; where that cannot be told from motion,
            by what all causes together leave.
    """

    rms: float
    largest: float
    share: float
    noise: float

    @property
    def at_noise(self) -> bool:
        """Whether nothing but noise is left."""
        return not self.rms > LEFT * self.noise


@dataclass(frozen=True, slots=True)
class LogCause:
    """One of the causes that together explain most of the residual.

    Attributes:
        hypothesis: what it is called, the same for each link or joint.
        link: the link it is about, if any.
        joint: the joint it is about, if any.
        sentence: what was found, with its number and unit.
        values: the same numbers by name.
        explains: the part of the residual's sum of squares, each joint's over its noise, that is left by the causes
            before and not by this one, of that before all.
        alternatives: sentences of other causes that explain the same.
    """

    hypothesis: str
    link: str | None
    joint: str | None
    sentence: str
    values: dict[str, Any]
    explains: float
    alternatives: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LogDiagnosis(Summarised):
    """What a log says of a model.

    Attributes:
        robot: its name.
        log: the file's name.
        rows: how many were used.
        seconds: how long they last.
        verdict: "agrees": nothing but noise is between the two; "explained": so with the causes; else "unexplained".
        causes: what explains most, the largest part first.
        before: by joint, the residual as it is.
        after: by joint, what the causes leave.
        notes: how the log was read.
    """

    robot: str
    log: str
    rows: int
    seconds: float
    verdict: Verdict
    causes: tuple[LogCause, ...]
    before: dict[str, JointResidual]
    after: dict[str, JointResidual]
    notes: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether the model says what was measured, but for noise."""
        return self.verdict == "agrees"

    def summary(self) -> str:
        """The verdict, then the causes, one a line."""
        compared = f"{self.log} beside {self.robot}, {self.rows:,} rows of {self.seconds:.3g} s"
        if self.passed:
            return f"AGREES {compared}: nothing but noise is between measured and modelled tau"
        left = [name for name, own in self.after.items() if not own.at_noise]
        rest = f"more than noise is left at {', '.join(left)}" if left else "nothing but noise is left"
        count = f"{len(self.causes)} cause{'s' * (len(self.causes) != 1)}"
        head = f"{self.verdict.upper()} {compared}: {count}, {rest}"
        return "\n".join([head, *(cause.sentence for cause in self.causes)])

    def to_dict(self) -> dict[str, Any]:
        """Everything as data for JSON."""
        data = {
            "schema": 1,
            "verdict": self.verdict,
            "passed": self.passed,
            "robot": self.robot,
            "log": self.log,
            "rows": self.rows,
            "seconds": self.seconds,
            "causes": [asdict(cause) for cause in self.causes],
            "residual_before": {name: asdict(own) for name, own in self.before.items()},
            "residual_after": {name: asdict(own) for name, own in self.after.items()},
            "notes": self.notes,
        }
        return finite(data)


def diagnose_log(robot: Robot, path: str | Path) -> LogDiagnosis:
    """What a log says of a robot: read it, and explain its residual.

    Args:
        robot: the robot, as it is modelled; joint effects that it has take part.
        path: a table with `time` or `t`, `q_<joint>`, `tau_<joint>`, with or without `v_` and `a_` (docs/notation.md).

    Raises:
        InputError: the log cannot be used, or the robot has no joint that moves.
        UnknownNameError: a column is of a joint that the robot has not.
    """
    model = model_of(robot)
    if not model.nv:
        raise InputError(f"no joint of robot {model.name!r} moves: a log says nothing of it")
    return explain(robot, read_log(path_of("path", path), model))


def explain(robot: Robot, log: Log) -> LogDiagnosis:
    """What explains most of the residual of a log: forward selection among all that is linear in it.

    Of each joint viscous and Coulomb friction, armature, an offset and a factor of tau; of each link that moves its
    mass with its centre, or all ten inertial parameters; gravity; a factor of all tau. A cause is named if it gains
    more than chance would (`selection`), and makes a tenth of the noise at some joint.
    """
    residuals = residuals_of(robot, log)
    every = candidates(residuals)
    A = residuals.columns * residuals.weights[:, None]
    problem = reduced(A, residuals.means * residuals.weights, residuals.model.nv, residuals.known)
    causes, x = _seen(problem, residuals, every)
    total = sum((own.directions @ numbers for own, (numbers, _, _) in zip(causes, x, strict=True)), np.zeros(1))
    before = _of_joints(residuals, residuals.whole)
    after = _of_joints(residuals, residuals.whole - residuals.made_of(total)) if causes else before
    left = all(own.at_noise for own in after.values())
    verdict: Verdict = "unexplained" if not left else "explained" if causes else "agrees"
    told = tuple(_cause(problem, causes, k, every, x) for k in range(len(causes)))
    seconds = float(log.time[-1] - log.time[0])
    return LogDiagnosis(robot.name, log.name, len(log), seconds, verdict, told, before, after, log.notes)


def _seen(
    problem: Reduced, residuals: Residuals, every: Sequence[Candidate]
) -> tuple[list[Candidate], list[tuple[Array, Array, Array]]]:
    """The causes that gain more than chance, and make enough of a difference; with their numbers."""
    allowed = list(every)
    while True:
        causes = [allowed[k] for k in chosen(problem, [own.directions for own in allowed])]
        x = _numbers(problem, causes)
        small = [
            own
            for own, numbers in zip(causes, x, strict=True)
            if not (_size(residuals, own, numbers[0]) > SEEN * residuals.noise).any()
        ]
        if not small:
            return causes, x
        allowed = [own for own in allowed if own not in small]


def _size(residuals: Residuals, cause: Candidate, x: Array) -> Array:
    """What a cause makes of tau, root mean square, (nv,)."""
    return rms(residuals.columns @ (cause.directions @ np.nan_to_num(x)))


def _numbers(problem: Reduced, causes: Sequence[Candidate]) -> list[tuple[Array, Array, Array]]:
    """Of each cause its fitted numbers, their standard errors, and which of them motion tells."""
    if not causes:
        return []
    groups = [own.directions for own in causes]
    A, sizes = columns_of(problem, groups)
    x = fitted(problem, groups)[1]
    _, sigma, V = np.linalg.svd(A)
    kept = sigma > 1e-7 * sigma.max(initial=0.0)
    full = np.zeros(len(V), dtype=bool)
    full[: len(kept)] = kept
    error = np.sqrt(((V[full] / sigma[kept][:, None]) ** 2).sum(axis=0) * problem.scale) / sizes
    told = np.linalg.norm(V[~full], axis=0) < UNTOLD
    ends = np.cumsum([own.shape[1] for own in groups])[:-1]
    parts = (np.split(own, ends) for own in (x, error, told))
    return list(zip(*parts, strict=True))


def _of_joints(residuals: Residuals, rest: Array) -> dict[str, JointResidual]:
    names, most = residuals.model.v_names, np.abs(rest).max(axis=0, initial=0.0)
    columns = zip(*(x.tolist() for x in (rms(rest), most, residuals.size, residuals.noise)), strict=True)
    return {
        name: JointResidual(own, largest, own / size if size else 0.0, noise)
        for name, (own, largest, size, noise) in zip(names, columns, strict=True)
    }


def _cause(
    problem: Reduced,
    causes: Sequence[Candidate],
    k: int,
    every: Sequence[Candidate],
    x: Sequence[tuple[Array, Array, Array]],
) -> LogCause:
    """A cause in words, with those that explain the same."""
    own, others = causes[k], [one for one in causes if one is not causes[k]]
    whole = fitted(problem, [])[0]
    before = fitted(problem, [one.directions for one in causes[:k]])[0]
    after = fitted(problem, [one.directions for one in causes[: k + 1]])[0]
    with_all = fitted(problem, [one.directions for one in causes])[0]
    sentence, values = _told(own, x[k])
    alternatives = []
    for one in every:
        if one in causes or one.directions.shape[1] > own.directions.shape[1]:
            continue
        tried = [*others, one]
        if fitted(problem, [other.directions for other in tried])[0] < with_all + SAME:
            alternatives.append(_told(one, _numbers(problem, tried)[-1])[0])
    explains = (before - after) / whole if whole else 0.0
    return LogCause(own.hypothesis, own.link, own.joint, sentence, dict(values), explains, tuple(alternatives))


def _told(own: Candidate, numbers: tuple[Array, Array, Array]) -> tuple[str, Any]:
    x, error, told = numbers
    return own.told(np.where(told, x, np.nan), np.where(told, error, np.nan))
