"""Any function over scalars, compiled as robots are: columns of numbers in, columns of numbers out.

What a run needs beside the dynamics, such as how far rounding may take each result, is a formula of a few hundred
operations for each state. Written over scalars, the same lines run on arrays and on nodes of a graph.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.compile import cache, threads
from rttrr_pin.compile.emit import emitter
from rttrr_pin.compile.expression import Graph, GraphFullError, Node, Op
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.program import Program
from rttrr_pin.compile.trace import TRACING
from rttrr_pin.compile.variant import Variant
from rttrr_pin.core.algebra import Scalar
from rttrr_pin.core.arrays import Array, norm
from rttrr_pin.core.scalars import FLOAT, Arithmetic

LARGEST = 40_000
"""Nodes up to which a formula is compiled, in some seconds; a longer one runs on arrays."""

Norm = Callable[[Iterable[Scalar]], Scalar]


@dataclass(frozen=True, slots=True)
class Sizes:
    """What formulas of sizes are written in.

    Attributes:
        arithmetic: that of the dynamics.
        norm: the Euclidean norm of up to three scalars.
        size: the absolute value.
    """

    arithmetic: Arithmetic
    norm: Norm
    size: Callable[[Any], Any]


Function = Callable[[Sizes, Mapping[str, Sequence[Scalar]]], Mapping[str, Sequence[Scalar]]]
"""From scalars of each input to those of each output."""


class Formula:
    """A function over scalars, ready to run on any number of states."""

    def __init__(
        self, function: Function, inputs: Mapping[str, int], outputs: Mapping[str, int], identity: str | None
    ) -> None:
        """Compile, or read what another process has compiled before.

        Args:
            function: from the scalars of each input, by name, to those of each output.
            inputs: how many numbers each has in one state.
            outputs: likewise.
            identity: tells all numbers that the function depends on, so that compiled code is known again; None where
                it is not worth compiling, and runs on arrays.
        """
        self._function = function
        self._inputs, self._outputs = (
            tuple(Field(name, (width,)) for name, width in x.items()) for x in (inputs, outputs)
        )
        self._variant = None if identity is None else self._compiled(identity)

    def __call__(self, rows: int, arrays: Mapping[str, NDArray[Any]]) -> dict[str, Array]:
        """The outputs at so many states.

        Args:
            rows: how many.
            arrays: of each input (N, width), or (1, width) where it is the same in every state.

        Returns:
            Of each output (width, N), each number of consecutive states side by side. What overflows is infinite.
        """
        inputs = [np.broadcast_to(arrays[own.name], (rows, own.width)) for own in self._inputs]
        results = {own.name: np.empty((own.width, rows)) for own in self._outputs}
        if self._variant is None:
            self._on_arrays(inputs, results)
        elif rows:
            inputs = [x.astype(float, copy=False) for x in inputs]
            task = self._variant.task(inputs, [x.T for x in results.values()], (rows,))
            threads.run(task, rows, threads.count(None, rows * (self._variant.width_in + self._variant.width_out)))
        return results

    def _compiled(self, identity: str) -> Variant | None:
        """The function, compiled; None where it is too long for that."""
        own = emitter()
        name = cache.key(own.identity, "formula", repr((self._inputs, self._outputs)), identity)
        code = cache.read(name)
        if code is None:
            try:
                program = self._traced()
            except GraphFullError:
                return None
            with threads.COMPILING:
                code = own.emit(program)
            cache.write(name, code)
        return Variant(self._inputs, self._outputs, own.load(code, self._inputs, self._outputs))

    def _traced(self) -> Program:
        graph = Graph(most=LARGEST)
        columns = iter([Node(graph, graph.input(k)) for k in range(sum(own.width for own in self._inputs))])
        scalars = {own.name: [next(columns) for _ in range(own.width)] for own in self._inputs}
        results = self._function(TRACED, scalars)
        ordered: list[Any] = [x for own in self._outputs for x in results[own.name]]
        numbers = [x.number if isinstance(x, Node) else graph.constant(float(x)) for x in ordered]
        return Program(graph, self._inputs, self._outputs, tuple(numbers), quickly=True)

    def _on_arrays(self, inputs: Sequence[Array], results: Mapping[str, Array]) -> None:
        scalars: dict[str, list[Any]] = {own.name: list(x.T) for own, x in zip(self._inputs, inputs, strict=True)}
        columns = self._function(ON_ARRAYS, scalars)
        for name, out in results.items():
            for row, x in zip(out, columns[name], strict=True):
                row[:] = x


def _norm_of_nodes(parts: Iterable[Any]) -> Scalar:
    scalars = [*parts]
    nodes = [x for x in scalars if isinstance(x, Node)]
    if not nodes:
        return float(norm(np.array(scalars, dtype=float)))
    graph = nodes[0].graph
    numbers = [x.number if isinstance(x, Node) else graph.constant(float(x)) for x in scalars]
    return Node(graph, graph.norm(*numbers, *[graph.constant(0.0)] * (3 - len(numbers))))


def _size_of_node(x: Any) -> Scalar:
    return x.function(Op.ABS) if isinstance(x, Node) else abs(x)


TRACED = Sizes(TRACING, _norm_of_nodes, _size_of_node)


def _norm_of_arrays(parts: Iterable[Any]) -> Any:
    return norm(np.stack(np.broadcast_arrays(*parts), axis=-1))


ON_ARRAYS = Sizes(FLOAT, _norm_of_arrays, np.abs)
