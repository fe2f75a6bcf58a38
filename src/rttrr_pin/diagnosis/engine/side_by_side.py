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
from rttrr_pin.core.batch import blocks
from rttrr_pin.core.dynamics import bodies, body_of
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.model import Model
from rttrr_pin.core.scalars import FLOAT
from rttrr_pin.diagnosis.engine.evidence import joined, shape_of_loads
from rttrr_pin.diagnosis.engine.simultaneous import ROWS
from rttrr_pin.diagnosis.variants.mutations import Mutation
from rttrr_pin.diagnosis.variants.variant import Values, Variant, run
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
        programs.append(Program(own.model, links, own.given(batch), own.mutations))
    results = run_all(programs)
    return [own.shown(batch, values) for own, values in zip(variants, results, strict=True)]


def run_all(programs: Sequence[Program], rows: int = ROWS) -> list[Values]:
    """The results of programs with as many states each; about so many rows at a time, which changes no result."""
    found: list[Values] = [{}] * len(programs)
    groups: dict[Hashable, list[int]] = {}
    for k, own in enumerate(programs):
        groups.setdefault(own.kind, []).append(k)
    for members in groups.values():
        for part in blocks(len(members), max(1, rows // max(1, len(programs[0].batch)))):
            for k, values in zip(members[part], _run([programs[k] for k in members[part]]), strict=True):
                found[k] = values
    return found


def _run(programs: Sequence[Program]) -> Iterator[Values]:
    """Programs of one kind in one run."""
    first = programs[0]
    rows = len(first.batch)
    links = [_side_by_side(own, rows) for own in zip(*(own.links for own in programs), strict=True)]
    gravity = Vector(*_columns(np.array([own.model.gravity for own in programs]), rows))
    batch = joined([own.batch for own in programs])
    values = run(first.model, batch, first.mutations, links=links, gravity=gravity)
    for part in blocks(len(batch), rows):
        yield {key: x[part] for key, x in values.items()}


def _side_by_side(own: Sequence[Body], rows: int) -> Body:
    """One body, with columns where those of the programs differ."""
    first = own[0]
    if all(body is first for body in own):
        return first
    numbers = _columns(np.array([_numbers(body) for body in own]), rows)
    axis, p, r_C = (Vector(*numbers[k : k + 3]) for k in (0, 3, 6))
    R, tensor = (Matrix(tuple(Vector(*numbers[j : j + 3]) for j in (k, k + 3, k + 6))) for k in (9, 18))  # type: ignore[arg-type]
    return replace(first, axis=axis, R=R, p=p, M=numbers[27], r_C=r_C, I=tensor, parameters=tuple(numbers[28:]))


def _numbers(body: Body) -> list[Any]:
    rows = [x for matrix in (body.R, body.I) for row in matrix.rows for x in row]
    return [*body.axis, *body.p, *body.r_C, *rows, body.M, *body.parameters]


def _columns(numbers: Array, rows: int) -> list[Any]:
    """Numbers of programs, (programs, n), as n scalars for all of their rows: one number where they are equal."""
    return [float(x[0]) if (x == x[0]).all() else np.repeat(x, rows) for x in numbers.T]
