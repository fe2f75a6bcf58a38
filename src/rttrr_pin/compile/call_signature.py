"""What a function is given or returns, taken apart into scalars and the structure that holds them.

A structure is nested tuples: the type of a sequence or dataclass, then its parts; `COLUMN` or `NUMBER` where a scalar
stands; anything else as it is. Structures are compared and hashed, so they tell calls of one kind from others.
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Hashable, Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any

from rttrr_pin.compile.expression import Graph, Node
from rttrr_pin.core.algebra import Vector

Leaf = Node | float
"""A scalar: a column of a batch, or a number of the robot."""

SCALAR = (Node, float)


class Mark(enum.Enum):
    """Where a scalar stands."""

    COLUMN = enum.auto()
    NUMBER = enum.auto()

    __hash__ = object.__hash__  # Enum's own is slow


NOTHING = (Vector, 0, 0, 0)
"""The structure of a vector of zeros."""


def mark(x: Leaf) -> Mark:
    """Which of the two it is."""
    return Mark.COLUMN if isinstance(x, Node) else Mark.NUMBER


def arguments(x: Any, graph: Graph) -> tuple[Hashable, list[Leaf]]:
    """The structure of arguments, and their scalars: nodes of a graph, and floats.

    What is zero, a single number or a whole vector, is part of the structure, so that nothing is computed with it.
    Single zeros in a vector or matrix are not: else there would be as many kinds of links as there are links.
    """
    leaves: list[Leaf] = []

    def number(x: Any) -> Leaf:
        return graph.value.get(x.number, x) if isinstance(x, Node) else x

    def scalar(x: Leaf) -> Hashable:
        x = number(x)
        if not isinstance(x, Node) and x == 0.0:
            return 0
        leaves.append(x)
        return mark(x)

    def vector(x: Vector) -> Hashable:
        parts = [number(part) for part in x]
        if not any(isinstance(part, Node) or part != 0 for part in parts):
            return NOTHING
        leaves.extend(part for part in parts if isinstance(part, SCALAR))
        return (Vector, *(mark(part) if isinstance(part, SCALAR) else part for part in parts))

    return _described(x, scalar, vector), leaves


def answer(x: Any, graph: Graph) -> tuple[Hashable, list[int]]:
    """The structure of what a step returns, and its nodes; constants are part of the structure, whole ones as int."""
    nodes: list[int] = []

    def scalar(x: Leaf) -> Hashable:
        value = graph.value.get(x.number) if isinstance(x, Node) else x
        if value is not None:
            return int(value) if value.is_integer() else value
        assert isinstance(x, Node)
        nodes.append(x.number)
        return Mark.COLUMN

    return _described(x, scalar, lambda x: (Vector, *(_described(part, scalar, None) for part in x))), nodes


def _described(x: Any, scalar: Callable[[Leaf], Hashable], vector: Callable[[Vector], Hashable] | None) -> Hashable:
    if isinstance(x, SCALAR):
        return scalar(x)
    if isinstance(x, Vector) and vector is not None:
        return vector(x)
    if isinstance(x, (list, tuple)):
        return (type(x), *(_described(part, scalar, vector) for part in x))
    cls: type = type(x)
    names = _names(cls)
    if names is not None:
        return (cls, *(_described(getattr(x, name), scalar, vector) for name in names))
    assert isinstance(x, Hashable)
    return x


@cache
def _names(cls: type) -> tuple[str, ...] | None:
    """The fields of a dataclass."""
    return tuple(field.name for field in fields(cls)) if is_dataclass(cls) else None


def built(structure: Hashable, scalars: Iterator[Any]) -> Any:
    """What has this structure, with these scalars."""
    if isinstance(structure, Mark):
        return next(scalars)
    if not isinstance(structure, tuple):
        return structure
    cls, *parts = structure
    values = [built(part, scalars) for part in parts]
    return cls(values) if cls in (list, tuple) else cls(*values)
