"""Many programs at once that differ in numbers and states: the rows of all, one below the other, in one run.

Equal to one run for each, bit for bit: where the numbers of a body differ they become columns, and nothing in the
recursion asks whether a scalar is one number or a column. Nearly all of a run's time goes to calls, and few to rows.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rttrr_pin.core.algebra import Matrix, Vector
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.batch import split_columns
from rttrr_pin.core.dynamics import bodies, body_of
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import payloads_of
from rttrr_pin.core.scalars import FLOAT, columns
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.diagnosis.evidence import joined, shape_of_loads
from rttrr_pin.diagnosis.mutations import Mutation, mutated
from rttrr_pin.diagnosis.simultaneous import ROWS
from rttrr_pin.diagnosis.variant import Values, Variant
from rttrr_pin.implementations.protocol import Batch


@dataclass(frozen=True, slots=True, eq=False)
class Program:
    """The recursion with numbers of its own on states of its own.

    Attributes:
        model: how links hang together; effects of the joints, and gravity.
        links: the bodies, in floats.
        batch: the states.
        mutations: errors.
    """

    model: Model
    links: Sequence[Body]
    batch: Batch
    mutations: tuple[Mutation, ...] = ()

    @property
    def kind(self) -> Hashable:
        """What programs of one run have in common."""
        joints = tuple((own.parent, own.mimic, own.effects, id(own.lock)) for own in self.model.joints)
        return joints, tuple(body.type for body in self.links), self.mutations, shape_of_loads(self.batch)


def evaluate_all(variants: Sequence[Variant], batch: Batch) -> list[Values]:
    """What each program computes at states of the robot, as its `evaluate` does."""
    known: dict[tuple[int, int], Body] = {}
    given: dict[int, Batch] = {}
    programs = []
    for own in variants:
        pairs = zip(own.model.joints, own.model.links, strict=True)
        if any(joint.lock for joint in own.model.joints):
            links: Sequence[Body] = bodies(own.model, FLOAT)
        else:  # nearly all are those of another program
            links = [
                known.get((id(joint), id(link))) or known.setdefault((id(joint), id(link)), body_of(joint, link, FLOAT))
                for joint, link in pairs
            ]
        states = own.given(batch) if own.inputs else given.setdefault(0, batch)
        programs.append(Program(own.model, links, states, own.mutations))
    results = run_all(programs)
    return [own.shown(batch, values) for own, values in zip(variants, results, strict=True)]


def run_all(programs: Sequence[Program], rows: int = ROWS) -> list[Values]:
    """The results of each program; some rows at a time, whose number changes no result."""
    found: list[Values] = [{}] * len(programs)
    groups: dict[Hashable, list[int]] = {}
    for k, own in enumerate(programs):
        groups.setdefault(own.kind, []).append(k)
    for members in groups.values():
        for part in _parts(members, [len(programs[k].batch) for k in members], rows):
            for k, values in zip(part, _run([programs[k] for k in part]), strict=True):
                found[k] = values
    return found


def _parts(members: Sequence[int], sizes: Sequence[int], rows: int) -> Iterator[list[int]]:
    """Programs of so many rows at most; one at least."""
    part: list[int] = []
    total = 0
    for k, size in zip(members, sizes, strict=True):
        if part and total + size > rows:
            yield part
            part, total = [], 0
        part.append(k)
        total += size
    if part:
        yield part


def _run(programs: Sequence[Program]) -> Iterator[Values]:
    """Programs of one kind in one run."""
    first = programs[0]
    sizes = [len(own.batch) for own in programs]
    batch = joined([own.batch for own in programs]) if len(programs) > 1 else first.batch
    links = [_side_by_side(own, sizes) for own in zip(*(own.links for own in programs), strict=True)]
    gravity = Vector(*_columns(np.array([own.model.gravity for own in programs]), sizes))
    q, v, a = (columns(x) for x in (batch.q, batch.v, batch.a))
    with np.errstate(all="ignore"):
        compute = mutated(first.mutations)
        result = compute(first.model, FLOAT, q, v, a, payloads_of(batch.loads, FLOAT), links, gravity)
        numbers: list[Any] = result.scalars()
        table = np.empty((len(batch), len(numbers)))
        for column, x in zip(table.T, numbers, strict=True):
            column[:] = x
    ends = np.cumsum(sizes)
    for begin, end in zip((ends - sizes).tolist(), ends.tolist(), strict=True):
        yield split_columns(first.model, table[begin:end], QUANTITIES)


def _side_by_side(own: Sequence[Body], sizes: Sequence[int]) -> Body:
    """One body, with columns where those of the programs differ."""
    first = own[0]
    if all(body is first for body in own):
        return first
    numbers = _columns(np.array([_numbers(body) for body in own]), sizes)
    axis, p, r_C = (Vector(*numbers[k : k + 3]) for k in (0, 3, 6))
    R, tensor = (Matrix(tuple(Vector(*numbers[j : j + 3]) for j in (k, k + 3, k + 6))) for k in (9, 18))  # type: ignore[arg-type]
    return replace(first, axis=axis, R=R, p=p, M=numbers[27], r_C=r_C, I=tensor, parameters=tuple(numbers[28:]))


def _numbers(body: Body) -> list[Any]:
    rows = [x for matrix in (body.R, body.I) for row in matrix.rows for x in row]
    return [*body.axis, *body.p, *body.r_C, *rows, body.M, *body.parameters]


def _columns(numbers: Array, sizes: Sequence[int]) -> list[Any]:
    """Numbers of programs, (programs, n), as n scalars for all of their rows: one number where they are equal."""
    return [float(x[0]) if (x == x[0]).all() else np.repeat(x, sizes) for x in numbers.T]
