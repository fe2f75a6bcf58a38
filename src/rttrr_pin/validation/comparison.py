"""A subject and its references on the states of one robot."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load, RandomPayload
from rttrr_pin.core.wrench import Wrench
from rttrr_pin.errors import InputError
from rttrr_pin.exact import Adjudication
from rttrr_pin.implementations import Batch, Evaluation, Implementation, make_implementation, make_references
from rttrr_pin.implementations.registry import Source
from rttrr_pin.robot import Robot
from rttrr_pin.validation.adjudicate import adjudicate
from rttrr_pin.validation.compare import Comparison, Difference, Ranking, Row
from rttrr_pin.validation.states import Sampler

HUGE = 1e140
"""Numbers whose squares, times anything that occurs, stay within float64."""

Payload = Wrench | RandomPayload | None
"""None; a wrench, the same in every state; or a random one in each."""

References = Source | list[Source] | tuple[Source, ...]
"""One reference or several."""


@dataclass(frozen=True, slots=True)
class Run:
    """What is compared with what, and what was seen.

    Attributes:
        model: the robot.
        sampler: draws the states.
        subject: the program that is judged.
        references: those that it is compared with.
        comparisons: gather the differences, one for each reference.
        table: the states that the subject or a reference brings with it; None where they are drawn.
        ranking: the states to look at again, by the largest error / tolerance against any reference.
    """

    model: Model
    sampler: Sampler
    subject: Implementation
    references: tuple[Implementation, ...]
    comparisons: tuple[Comparison, ...]
    table: Batch | None = None
    ranking: Ranking = field(default_factory=Ranking)

    @classmethod
    def of(
        cls, robot: Robot, subject: Source, reference: References, seed: int, sampling: str, payload: Payload
    ) -> Run:
        """Prepare to compare.

        Raises:
            InputError: an argument cannot be used, or the programs have no quantity in common.
            ImplementationError: a program is missing, refuses the robot, or built another model than the file says.
        """
        if not isinstance(robot, Robot):
            raise InputError(f"robot is a {type(robot).__name__}: pass a Robot, such as rttrr_pin.load({robot!r})")
        if not robot.model.links:
            raise InputError(f"robot {robot.name!r} has no joint, so that there is nothing to compare")
        model = robot.model
        load = resolved(robot, payload)
        sampler = Sampler(model, sampling, seed, load)
        judged = make_implementation(subject, model)
        others = tuple(make_references(reference, model))
        comparisons = []
        for other in others:
            common = [key for key in judged.quantities if key in other.quantities]
            if not common:
                raise InputError(
                    f"{judged.name} gives {', '.join(judged.quantities)}, and {other.name} gives "
                    f"{', '.join(other.quantities)}: there is nothing to compare"
                )
            comparisons.append(Comparison(model, common))
        return cls(model, sampler, judged, others, tuple(comparisons), table_of([judged, *others], load))

    @property
    def rows(self) -> list[tuple[Implementation, Row]]:
        """What was seen of each quantity at each place, reference by reference."""
        pairs = zip(self.references, self.comparisons, strict=True)
        return [(reference, row) for reference, comparison in pairs for row in comparison.rows]

    def states(self, first: int, count: int) -> Batch:
        """States of the table, or drawn ones."""
        compiled = any(program.name == "kernel" for program in (self.subject, *self.references))
        if self.table is None:
            return replace(self.sampler.draw(first, count), compiled=compiled)
        part = slice(first, first + count)
        loads = tuple(load.block(part) for load in self.table.loads)
        table = self.table
        return Batch(self.model, table.q[part], table.v[part], table.a[part], loads, first, compiled)

    def evaluate(self, batch: Batch) -> list[Evaluation]:
        """What each program makes of a batch, the subject first; what overflows is shown later, with its state."""
        with np.errstate(over="ignore", invalid="ignore"):
            results = [program.evaluate(batch) for program in (self.subject, *self.references)]
            _check_size(batch, results[0])
        return results

    def add(self, batch: Batch) -> None:
        """Take in some states."""
        subject, *others = self.evaluate(batch)
        with np.errstate(over="ignore", invalid="ignore"):
            ratios = [
                comparison.add(batch, subject, other)
                for comparison, other in zip(self.comparisons, others, strict=True)
            ]
        self.ranking.see(np.max(ratios, axis=0), batch.first)

    def differences(self, batch: Batch, results: list[Evaluation]) -> list[list[Difference]]:
        """How far the subject is from each reference, row by row."""
        subject, *others = results
        pairs = zip(self.comparisons, others, strict=True)
        with np.errstate(over="ignore", invalid="ignore"):
            return [list(comparison.differences(batch, subject, other)) for comparison, other in pairs]

    def adjudicate(self, batch: Batch, results: list[Evaluation]) -> Adjudication:
        """Who is right in one state, by the exact reference."""
        names = [program.name for program in (self.subject, *self.references)]
        with np.errstate(over="ignore", invalid="ignore"):
            return adjudicate(batch, list(zip(names, results, strict=True)))


def table_of(programs: list[Implementation], load: Load | RandomPayload | None) -> Batch | None:
    """The states of the table among the programs, with the payload that its results were computed with."""
    tables = [program for program in programs if hasattr(program, "states")]
    if not tables:
        return None
    first, *others = (table.states() for table in tables)
    for table, states in zip(tables[1:], others, strict=True):
        same = all(np.array_equal(getattr(first, x), getattr(states, x)) for x in "qva")
        if not same:
            raise InputError(f"{tables[0].name} and {table.name} are of different states: compare them one by one")
    if isinstance(load, RandomPayload):
        raise InputError(
            f"{tables[0].name} has its own states, and no random payload: pass the wrench it was made with, or none"
        )
    whole: Batch = replace(first, loads=() if load is None else (load,))
    return whole


def resolved(robot: Robot, payload: Payload) -> Load | RandomPayload | None:
    """For the sampler: the load, or the random one at a link that has a name."""
    if payload is None:
        return None
    if isinstance(payload, RandomPayload):
        link = robot.link_names[robot.payload_link(payload.link)]
        return RandomPayload(link, payload.force, payload.moment)
    if not isinstance(payload, Wrench):
        raise InputError(f"payload is {payload!r}: expected None, a Wrench or a RandomPayload()")
    load = robot.load_of(payload)
    if load.f.ndim > 1 or load.n.ndim > 1:
        raise InputError("the payload of a validation has a batch axis: pass one force and one moment of 3 numbers")
    return load


def described(payload: Payload) -> str:
    """A payload as reports name it."""
    if payload is None:
        return "none"
    if isinstance(payload, RandomPayload):
        return "random"
    axes = "base axes" if payload.expressed_in == "base" else "link axes"
    f, n = (np.asarray(x, dtype=float).tolist() for x in (payload.force, payload.moment))
    return f"force {f} N, moment {n} N m at {payload.link or 'the tool'}, {axes}"


def _check_size(batch: Batch, subject: Evaluation) -> None:
    """Norms square what they are of: numbers whose squares overflow cannot be compared.

    What the subject alone has beyond any size is its error; what the reference recursion has so too is the input's.
    """
    for key, x in subject.values.items():
        large = ~(_sizes(x) <= HUGE)
        if large.any():
            sizes = _sizes(getattr(batch.recursion[0], key))
            large &= ~(sizes <= HUGE)
        if large.any():
            row = int(np.argmax(large))
            raise InputError(
                f"{key} reaches {sizes[row]:.1e} in state {batch.first + row}, beyond {HUGE:.0e}, which no norm can "
                "hold: pass gravity, payload and masses of a size that a robot can have"
            )


def _sizes(x: Array) -> Array:
    """The largest absolute value of each state, (N,)."""
    largest: Array = np.abs(x).reshape(len(x), -1).max(axis=1, initial=0.0)
    return largest
