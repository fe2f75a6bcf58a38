"""The states of a run: of a table of results among the programs, or drawn; one block after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rttrr_pin.core.arguments import whole_number
from rttrr_pin.core.batch import blocks, keep_memory
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load, RandomPayload, same_loads
from rttrr_pin.errors import InputError
from rttrr_pin.implementations import Batch, Implementation
from rttrr_pin.robot import Robot
from rttrr_pin.robot import model_of as robot_model
from rttrr_pin.validation.sampling import LAST_STATE, Payload, Sampler

BLOCK = 4096
"""States taken at a time, at most: the memory of a run is that of one block, whatever the number of states."""

NUMBERS = 2**20
"""Results of a program in a block, at most: larger robots take fewer states at a time."""

Progress = Callable[[int], None]
"""Called with the number of states done so far."""


class States:
    """The states of a run.

    Attributes:
        sampler: draws them.
        table: those that a table of results brings with it; None where they are drawn.
        sampling: how they are drawn; "table" where they are not.
        compiled: whether rounding bounds are to be compiled (`Batch.compiled`).
    """

    def __init__(self, sampler: Sampler, programs: Sequence[Implementation], compiled: bool = False) -> None:
        """Look for a table among the programs.

        Raises:
            InputError: there are two of different states, or the payload is another in each state.
        """
        self.sampler, self.compiled = sampler, compiled
        self.table = table_of(programs, sampler.payload)
        self.sampling = sampler.sampling if self.table is None else "table"

    def described(self, payload: Payload) -> str:
        """The payload as reports name it: what was passed, or that of the table."""
        own = () if payload is not None or self.table is None else self.table.loads
        names = dict.fromkeys(self.sampler.model.link_names[load.link] for load in own)
        return f"the table's, at {', '.join(names)}" if names else described(payload)

    def count(self, n_states: int) -> int:
        """How many states a run has that would draw so many."""
        return n_states if self.table is None else len(self.table)

    def batch(self, first: int, count: int) -> Batch:
        """Consecutive states."""
        if self.table is None:
            return replace(self.sampler.draw(first, count), compiled=self.compiled)
        part = slice(first, first + count)
        q, v, a = (getattr(self.table, name)[part] for name in "qva")
        loads = tuple(load.block(part) for load in self.table.loads)
        return Batch(self.sampler.model, q, v, a, loads, first, self.compiled)

    def blocks(self, n_states: int, progress: Progress | None) -> Iterator[Batch]:
        """All states, some at a time; progress is called with the number done after each."""
        keep_memory()
        model = self.sampler.model
        size = max(1, min(BLOCK, NUMBERS // (model.nv + 12 * len(model.links))))
        for part in blocks(self.count(n_states), size):
            yield self.batch(part.start, part.stop - part.start)
            if progress is not None:
                progress(part.stop)


def table_of(programs: Sequence[Implementation], payload: Load | RandomPayload | None) -> Batch | None:
    """The states of the table among the programs, with the payload that its results were computed with.

    Raises:
        InputError: there are two of different states, or a payload is passed that is not that of the table.
    """
    tables: list[tuple[str, Batch]] = [(one.name, one.states()) for one in programs if hasattr(one, "states")]
    if not tables:
        return None
    (name, table), *others = tables
    for other, batch in others:
        if not all(np.array_equal(getattr(table, x), getattr(batch, x)) for x in "qva"):
            raise InputError(f"{name} and {other} are of different states: compare them one by one")
        if not same_loads(table.loads, batch.loads):
            raise InputError(f"{name} and {other} have different payloads: compare them one by one")
    if table.loads:
        _check_no_other(name, table, payload)
        return table
    if isinstance(payload, RandomPayload):
        raise InputError(f"{name} has its own states, and no random payload: pass the wrench it was made with, or none")
    return replace(table, loads=() if payload is None else (payload,))


def _check_no_other(name: str, table: Batch, payload: Load | RandomPayload | None) -> None:
    """A table with a payload of its own takes no other."""
    if payload is not None:
        link = table.model.link_names[table.loads[0].link]
        other = "a random payload" if isinstance(payload, RandomPayload) else "a payload"
        raise InputError(
            f"{name} has its own payload at {link}, in columns such as payload_f_{link}_x, and {other} is passed too: "
            "expected one of the two; pass none, or take the columns out"
        )


def described(payload: Payload) -> str:
    """A payload as reports name it."""
    if payload is None:
        return "none"
    if isinstance(payload, RandomPayload):
        return "random" + (f" at {payload.link}" if payload.link else "")
    axes = "base axes" if payload.expressed_in == "base" else "link axes"
    f, n = (np.asarray(x, dtype=float).tolist() for x in (payload.force, payload.moment))
    return f"force {f} N, moment {n} N m at {payload.link or 'the tool'}, {axes}"


def payload_data(batch: Batch) -> list[dict[str, Any]]:
    """The payload of a batch of one as data for JSON."""
    return [
        {
            "link": batch.model.link_names[load.link],
            "force": load.f.ravel().tolist(),
            "moment": load.n.ravel().tolist(),
            "expressed_in": "base" if load.in_base else "link",
        }
        for load in batch.loads
    ]


def check_count(n_states: int) -> int:
    """A run has at least one state: none would prove nothing."""
    return whole_number("n_states", n_states, 1, LAST_STATE, "10^15, since none would prove nothing", "--states")


def model_of(robot: Robot, otherwise: str) -> Model:
    """The model of what is a robot and has a joint; `otherwise` says what follows from having none."""
    model = robot_model(robot)
    if not model.links:
        raise InputError(f"robot {model.name!r} has no joint, so that {otherwise}")
    return model
