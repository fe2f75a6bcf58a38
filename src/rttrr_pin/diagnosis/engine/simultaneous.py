"""Many errors in the recursion at once: the states as often as there are errors, each in rows of its own.

Equal to one run for each error, in a fraction of the time: nearly all of such a run goes to steps without the error.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.algebra import Matrix, Vector
from rttrr_pin.core.batch import blocks
from rttrr_pin.core.dynamics import bodies
from rttrr_pin.core.joints.base import JointMotion, JointState
from rttrr_pin.core.model import Model
from rttrr_pin.core.newton_euler import LinkMotion
from rttrr_pin.core.scalars import FLOAT
from rttrr_pin.diagnosis.engine.evidence import joined
from rttrr_pin.diagnosis.variants.mutations import ALGEBRA, STEPS, JointTypes, Mutation, body_with, copied, functions
from rttrr_pin.diagnosis.variants.variant import Values, run
from rttrr_pin.implementations.protocol import Batch

ROWS = 4096
"""States of one run, about: so few that its arrays stay in the cache."""

STEP_OF = {
    **{name: name for name in (*STEPS, "joint_effects")},
    **dict.fromkeys((*ALGEBRA, "motion"), "outwards"),
    "driving_force": "inwards",
}
"""The step that a function is, or that calls it; by the name without the class."""

PASSED = {
    (operator, statement): (numbers, factor)
    for statement, numbers in (("f[parents[i]] += R_f", slice(-6, -3)), ("n[parents[i]] += R_n", slice(-3, None)))
    for operator, factor in (("drop", 0.0), ("negate", -1.0))
}
"""Errors in what the recursion passes on to the parent: which of the numbers that `inwards` returns, times what."""

Errors: TypeAlias = tuple[Mutation, ...]
Rows: TypeAlias = slice | NDArray[np.int64]


def together(
    mutations: Sequence[Mutation], model: Model, batch: Batch, base_mutations: Sequence[Mutation] = (), rows: int = ROWS
) -> Iterator[Values]:
    """What `run(model, batch, [*base_mutations, own])` gives for each mutation, bit for bit but the sign of zeros.

    Args:
        mutations: errors, each by itself.
        model: the robot.
        batch: its states.
        base_mutations: errors that all have.
        rows: how many states to compute at once, about; results do not depend on it.
    """
    base = tuple(base_mutations)
    for part in blocks(len(mutations), max(1, rows // max(1, len(batch)))):
        patches = _Patches(model, len(batch), base)
        shared = [patches.add(own) for own in mutations[part]]
        found = patches.run(batch)
        for own, among in zip(mutations[part], shared, strict=True):
            yield next(found) if among else run(model, batch, (*base, own))


class _Patches:
    """A run of the recursion for several errors, each in its own states.

    A step runs on all states without these errors. Then, for each error that its link has, it runs once more on the
    states of that error, with it, and these numbers take the place of the others: so they are those of a run with that
    error alone, also where something overflows.
    """

    def __init__(self, model: Model, states: int, base: Errors) -> None:
        self.model, self.states, self.base = model, states, base
        self.count = 0
        self.steps: dict[tuple[str, int], dict[Errors, list[int]]] = {}
        """By step and link: for which errors it runs once more, and which of the programs have them."""
        self.passed: dict[int, list[tuple[slice, float, int]]] = {}
        """By link: which of the numbers that it passes on are multiplied, by what, and in which program."""

    def add(self, own: Mutation) -> bool:
        """A program with this error; False, and none, where the error is in no step on one link."""
        step, passed = _step_of(own), PASSED.get((own.operator, own.expression))
        if step is None and (passed is None or any(one.function == own.function for one in self.base)):
            return False
        for i, joint in enumerate(self.model.joints):
            if own.link not in (None, i):
                continue
            if passed is not None:
                self.passed.setdefault(i, []).append((*passed, self.count))
            elif own.function == step or _types((own,)).of(joint.type) is not joint.type:
                errors = tuple(_at_all(x) for x in (*self.base, own) if _step_of(x) == step and x.link in (None, i))
                self.steps.setdefault((str(step), i), {}).setdefault(errors, []).append(self.count)
        self.count += 1
        return True

    def run(self, batch: Batch) -> Iterator[Values]:
        """The results of each program."""
        if not self.count:
            return
        seen, last = Counter[str](), len(self.model.links) - 1

        def call(step: Any, *arguments: Any) -> Any:
            name, k = step.__name__, seen[step.__name__]
            seen[name] += 1  # each step goes from link to link, outwards from the first, inwards from the last
            return self._patched(name, last - k if name == "inwards" else k, arguments, step(*arguments))

        values = run(self.model, joined([batch] * self.count), self.base, call)
        for k in range(self.count):
            yield {key: x[self._rows([k])] for key, x in values.items()}

    def _patched(self, step: str, link: int, arguments: Sequence[Any], result: Any) -> Any:
        """The result of a step on a link, with the numbers of each error in its states."""
        repeated = self.steps.get((step, link), {})
        passed = self.passed.get(link, []) if step == "inwards" else []
        if not repeated and not passed:
            return result
        table = np.empty((len(_numbers(result)), self.count * self.states))
        for row, x in zip(table, _numbers(result), strict=True):
            row[:] = x
        first, *inputs = arguments
        for errors, programs in repeated.items():
            rows = self._rows(programs)
            own = body_with(bodies(self.model, FLOAT)[link], _types(errors)) if step in STEPS else first
            for row, x in zip(table, _numbers(_altered(step, errors)(own, *_part(inputs, rows))), strict=True):
                row[rows] = x
        for part, factor, program in passed:
            rows = self._rows([program])
            table[part, rows] = table[part, rows] * factor if factor else 0.0  # an infinite force that is dropped too
        return _rebuilt(result, iter(table))

    def _rows(self, programs: Sequence[int]) -> Rows:
        """The states of these programs."""
        n = self.states
        if len(programs) == 1:
            return slice(programs[0] * n, (programs[0] + 1) * n)
        return (np.array(programs)[:, None] * n + np.arange(n)).ravel()


def _step_of(own: Mutation) -> str | None:
    return STEP_OF.get(own.function.rpartition(".")[2])


def _at_all(own: Mutation) -> Mutation:
    return own if own.link is None else replace(own, link=None)


@lru_cache(maxsize=4096)
def _types(errors: Errors) -> JointTypes:
    return JointTypes(errors)


@lru_cache(maxsize=4096)
def _altered(step: str, errors: Errors) -> Any:
    """A step with errors."""
    function = functions()[step]
    return copied(function, errors, function.__globals__)


def _numbers(x: Any) -> list[Any]:
    """The scalars of what steps take and return, in order; anything else is one."""
    if isinstance(x, Vector):
        return [x.x, x.y, x.z]
    if not isinstance(x, list | tuple | Matrix | LinkMotion | JointMotion | JointState):
        return [x]
    return [y for part in _parts(x) for y in _numbers(part)]


def _rebuilt(x: Any, numbers: Iterator[Any]) -> Any:
    """The same with other scalars."""
    if isinstance(x, list | tuple):
        return type(x)(_rebuilt(part, numbers) for part in x)
    if isinstance(x, Vector | Matrix | LinkMotion | JointMotion | JointState):
        return type(x)(*(_rebuilt(part, numbers) for part in _parts(x)))
    return next(numbers)


def _part(x: Any, rows: Rows) -> Any:
    """What a step takes, at some states."""
    return _rebuilt(x, (y[rows] if isinstance(y, np.ndarray) else y for y in _numbers(x)))


def _parts(x: Any) -> Sequence[Any]:
    return x if isinstance(x, list | tuple) else [getattr(x, name) for name in x.__slots__]
