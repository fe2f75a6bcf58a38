"""Try the laws of mechanics on many states of a robot: no other program is asked."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.batch import blocks
from rttrr_pin.core.inputs import whole_number
from rttrr_pin.core.payload import Load, RandomPayload
from rttrr_pin.core.wrench import Wrench
from rttrr_pin.errors import InputError
from rttrr_pin.exact.rounding import values_and_bounds
from rttrr_pin.implementations import Batch
from rttrr_pin.laws.case import Case
from rttrr_pin.laws.table import Law, chosen
from rttrr_pin.robot import Robot
from rttrr_pin.validation.compare import Worst
from rttrr_pin.validation.comparison import described
from rttrr_pin.validation.states import LAST_STATE, Sampler

BLOCK = 1024
"""States tried at a time; the memory of a run is that of one block. With fewer, calls cost more than arithmetic."""


@dataclass(slots=True)
class LawRow:
    """What was seen of one law.

    Attributes:
        law: which.
        numbers: how many numbers of each state the law says are zero; none where it says nothing of this robot.
        share: the largest of them as a share of what rounding can have made of zero, and its state.
        violations: states in which one is beyond.
    """

    law: Law
    numbers: int = 0
    share: Worst = field(default_factory=Worst)
    violations: int = 0

    @property
    def holds(self) -> bool:
        """Whether no state violates it."""
        return self.violations == 0


@dataclass(frozen=True, slots=True)
class LawReport:
    """The outcome of a run.

    Attributes:
        robot: its name.
        base: "fixed" or "floating".
        n_states: how many states each law was tried on.
        sampling: how they were drawn.
        seed: of the generator.
        payload: what the robot carried, in words.
        rows: one for each law, in the order of their ids.
        seconds: wall time.
    """

    robot: str
    base: str
    n_states: int
    sampling: str
    seed: int
    payload: str
    rows: tuple[LawRow, ...]
    seconds: float

    @property
    def holds(self) -> bool:
        """Whether every law holds in every state."""
        return all(row.holds for row in self.rows)

    @property
    def worst(self) -> LawRow:
        """The law that comes closest to its bound, or lies furthest beyond."""
        return max(self.rows, key=lambda row: row.share.value)


def check_laws(
    robot: Robot,
    states: int = 1000,
    seed: int = 0,
    sampling: str = "uniform",
    payload: Wrench | None = None,
    select: Iterable[str] = (),
    progress: Callable[[int], None] | None = None,
) -> LawReport:
    """Try the laws of mechanics on random states.

    A law holds in a state where what it says is zero lies within its running error bound of zero; no tolerance is
    chosen. A violation means that the dynamics are wrong, or that the robot cannot exist (M403 finds negative masses).

    Args:
        robot: the robot.
        states: how many.
        seed: of the generator; the states are those that `validate` draws for the same seed and family.
        sampling: how they are drawn, one of `SAMPLINGS`.
        payload: None for a random one in each state, at the last link in its axes and at another in base axes; or a
            wrench, the same in every state.
        select: prefixes of the ids of the laws to try, such as `"M"`; none means all.
        progress: called after each block with the number of states done.

    Returns:
        For each law the worst share of its bound, the state, and how many states violate it.

    Raises:
        InputError: an argument cannot be used, or the robot has no joint.
        UnknownNameError: no family is called so, or a prefix fits no law.
    """
    laws = chosen(select)
    whole_number("states", states, 1, LAST_STATE, "10^15, since none would prove nothing")
    if not isinstance(robot, Robot):
        raise InputError(f"robot is a {type(robot).__name__}: pass a Robot, such as rttrr_pin.load({robot!r})")
    if not robot.model.links:
        raise InputError(f"robot {robot.name!r} has no joint, so that no law says anything of it")
    start = time.perf_counter()
    load = RandomPayload(robot.link_names[-1]) if payload is None else robot.load_of(payload)
    sampler = Sampler(robot.model, sampling, seed, load)
    rows = tuple(LawRow(law) for law in laws)
    for part in blocks(states, BLOCK):
        drawn = sampler.draw(part.start, part.stop - part.start)
        loads = _loads(robot, drawn) if payload is None else drawn.loads
        with np.errstate(all="ignore"):  # what overflows is no zero, and is counted as a violation
            _try(rows, Case.bounded(robot.model, drawn.q, drawn.v, drawn.a, loads), drawn.first, len(drawn.q))
        if progress is not None:
            progress(part.stop)
    return LawReport(
        robot=robot.name,
        base="floating" if robot.model.floating else "fixed",
        n_states=states,
        sampling=sampling,
        seed=seed,
        payload=described(payload or RandomPayload()),
        rows=rows,
        seconds=time.perf_counter() - start,
    )


def _loads(robot: Robot, drawn: Batch) -> Sequence[Load]:
    """The random load of each state, and another in base axes at a link further in."""
    (load,) = drawn.loads
    return load, Load(len(robot.link_names) // 2, load.f[:, ::-1], load.n[:, ::-1], in_base=True)


def _try(rows: Iterable[LawRow], case: Case, first: int, count: int) -> None:
    """Every law on consecutive states."""
    for row in rows:
        ratios = error_over_bound(row.law, case, count)
        row.numbers = ratios.shape[1]
        if row.numbers:
            row.share.see(ratios.max(axis=1), first)
            row.violations += int((ratios.max(axis=1) > 1.0).sum())


def error_over_bound(law: Law, case: Case, count: int) -> Array:
    """What the law says is zero, over its error bound, (N, numbers); infinite where it is not finite."""
    values, bounds = values_and_bounds(list(law.residual(case)), count)
    with np.errstate(all="ignore"):
        ratios = np.where(values == 0.0, 0.0, np.abs(values) / bounds)
    ratios[np.isnan(ratios) | ~np.isfinite(bounds)] = np.inf
    return ratios
