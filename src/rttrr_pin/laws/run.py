"""Check the laws of mechanics on many states of a robot, without another program."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from rttrr_pin.core.arguments import names_of
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load, RandomPayload
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.exact.rounding import values_and_bounds
from rttrr_pin.implementations import Batch, Implementation, label, make_implementation
from rttrr_pin.implementations.registry import Source
from rttrr_pin.laws import balance, matrix, symmetry
from rttrr_pin.laws.case import Case
from rttrr_pin.laws.law import Law
from rttrr_pin.reporting.results import Summarised, finite
from rttrr_pin.robot import Robot
from rttrr_pin.validation.compare import ratio
from rttrr_pin.validation.ranking import Worst
from rttrr_pin.validation.sampling import Payload, Sampler
from rttrr_pin.validation.states import Progress, States, check_count, model_of

LAWS = tuple(law for module in (balance, matrix, symmetry) for law in vars(module).values() if isinstance(law, Law))
"""In the order of their ids."""

RECURSION = "recursion"
"""The subject that all laws can be checked on."""


@dataclass(slots=True)
class LawRow:
    """The outcome for one law.

    Attributes:
        law: the law.
        numbers: how many numbers of each state the law says are zero; 0 where it says nothing of this robot.
        error_over_bound: the largest |residual| / error bound, and its state.
        violations: states in which it exceeds 1.
    """

    law: Law
    numbers: int = 0
    error_over_bound: Worst = field(default_factory=Worst)
    violations: int = 0

    @property
    def passed(self) -> bool:
        """Whether no state violates the law."""
        return self.violations == 0

    def to_dict(self) -> dict[str, Any]:
        """The row as data for JSON."""
        return {
            "name": self.law.name,
            "statement": self.law.statement,
            "passed": self.passed,
            "numbers": self.numbers,
            "error_over_bound": asdict(self.error_over_bound) if self.numbers else None,
            "violations": self.violations,
        }


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LawReport(Summarised):
    """The outcome of a run.

    Attributes:
        robot: its name.
        base: "fixed" or "floating".
        subject: name and version of the program that was checked.
        n_states: how many states each law was checked on.
        sampling: how they were drawn; "table" where a table of results brought them.
        seed: of the generator.
        payload: what the robot carried, in words.
        rows: one for each law, in the order of their ids.
        seconds: wall time.
        notes: what is to be known of how the robot was read.
    """

    robot: str
    base: str
    subject: str
    n_states: int
    sampling: str
    seed: int
    payload: str
    rows: tuple[LawRow, ...]
    seconds: float
    notes: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether every law holds in every state."""
        return all(row.passed for row in self.rows)

    @property
    def violated(self) -> tuple[LawRow, ...]:
        """The laws that do not hold in every state."""
        return tuple(row for row in self.rows if not row.passed)

    @property
    def worst(self) -> LawRow:
        """The law whose residual comes closest to its bound, or lies furthest beyond."""
        return max(self.rows, key=lambda row: row.error_over_bound.value)

    def summary(self) -> str:
        """The verdict in one sentence."""
        checked = f"{self.subject} on {self.n_states:,} states of {self.robot}"
        if self.passed:
            return f"PASS {checked}: all {len(self.rows)} laws hold"
        ids = ", ".join(row.law.id for row in self.violated)
        return f"FAIL {checked}: {len(self.violated)} of {len(self.rows)} laws are violated, {ids}"

    def to_dict(self) -> dict[str, Any]:
        """Everything as data for JSON."""
        names = ("passed", "robot", "base", "subject", "n_states", "sampling", "seed", "payload", "seconds", "notes")
        laws = {row.law.id: row.to_dict() for row in self.rows}
        data = {"schema": 1, **{name: getattr(self, name) for name in names}, "laws": laws}
        return finite(data)


def check_laws(
    robot: Robot,
    subject: Source = RECURSION,
    n_states: int = 1000,
    seed: int = 0,
    sampling: str = "uniform",
    payload: Payload = RandomPayload(),  # noqa: B008 - frozen
    select: str | Iterable[str] = (),
    progress: Progress | None = None,
) -> LawReport:
    """Check the laws of mechanics on random states.

    A law holds in a state if its residual lies within its running error bound of zero. A violation means that the
    dynamics are wrong, or that the robot cannot exist (M403 finds negative masses).

    Args:
        robot: the robot.
        subject: the program that is checked. Of the reference recursion, `"recursion"`, all laws are; of any other (see
            `validate`) those that need nothing but its results, the power balance and the balances of the links.
        n_states: how many states; of a table of results all of its own.
        seed: of the generator; `validate` draws the same states for the same seed and sampling.
        sampling: how they are drawn, one of `SAMPLINGS`.
        payload: None; a wrench, the same in every state; or `RandomPayload()`: another in each state, at its link (the
            last one, if it names none) in link axes, and at a link further in, in base axes.
        select: prefixes of the ids of the laws to check, such as `"M"`; none for all.
        progress: called after each block with the number of states done.

    Returns:
        For each law the largest error / bound, the state, and how many states violate it.

    Raises:
        InputError: an argument cannot be used, or no law can be checked.
        ImplementationError: the subject is missing, refuses the robot, or dies.
        UnknownNameError: there is no such sampling or law.
    """
    laws = _chosen(select)
    n_states = check_count(n_states)
    model = model_of(robot, "no law says anything of it")
    start = time.perf_counter()
    program = make_implementation(subject, model)
    whole = isinstance(subject, str) and subject == RECURSION
    rows = tuple(LawRow(law) for law in (laws if whole else _checkable(laws, program)))
    acting = payload
    if isinstance(payload, RandomPayload) and payload.link is None:
        acting = replace(payload, link=model.link_names[-1])  # which every robot has, and only one of
    states = States(Sampler(model, sampling, seed, acting), [program])
    for batch in states.blocks(n_states, progress):
        if isinstance(payload, RandomPayload):
            batch = replace(batch, loads=(*batch.loads, _in_base_axes(model, batch.loads[0])))
        with np.errstate(all="ignore"):  # what overflows is not zero, and counts as a violation
            _check(rows, Case.of(batch, None if whole else program), batch)
    return LawReport(
        robot=robot.name,
        base="floating" if model.floating else "fixed",
        subject=label(program),
        n_states=states.count(n_states),
        sampling=states.sampling,
        seed=states.sampler.seed,
        payload=states.described(payload),
        rows=rows,
        seconds=time.perf_counter() - start,
        notes=tuple(note.text for note in model.notes),
    )


def error_over_bound(law: Law, case: Case, count: int) -> Array:
    """|residual| / error bound of each number, (N, numbers); infinite where one is not finite."""
    values, bounds = values_and_bounds(list(law.residual(case)), count)
    ratios = ratio(np.abs(values), bounds)
    ratios[~np.isfinite(bounds)] = np.inf
    return ratios


def _check(rows: Iterable[LawRow], case: Case, batch: Batch) -> None:
    """Take in consecutive states."""
    for row in rows:
        ratios = error_over_bound(row.law, case, len(batch))
        row.numbers = ratios.shape[1]
        if row.numbers:
            largest = ratios.max(axis=1)
            row.error_over_bound.see(largest, batch.first)
            row.violations += int((largest > 1.0).sum())


def _checkable(laws: Iterable[Law], program: Implementation) -> list[Law]:
    """The laws that need nothing of a program but what it gives."""
    checkable = [law for law in laws if law.reads and set(law.reads) <= set(program.quantities)]
    if not checkable:
        raise InputError(
            f"none of these laws can be checked on {program.name}, which gives {', '.join(program.quantities)}: "
            "select E or B, or check the recursion"
        )
    return checkable


def _in_base_axes(model: Model, load: Load) -> Load:
    """Another random load, at a link further in."""
    return Load(len(model.links) // 2, load.f[:, ::-1], load.n[:, ::-1], in_base=True)


def _chosen(select: str | Iterable[str]) -> list[Law]:
    """The laws whose ids begin with one of the prefixes; all laws without a prefix."""
    prefixes = names_of("select", select)
    for prefix in prefixes:
        if not prefix or not any(law.id.startswith(prefix) for law in LAWS):
            raise UnknownNameError("law", prefix, [law.id for law in LAWS])
    return [law for law in LAWS if not prefixes or law.id.startswith(prefixes)]
