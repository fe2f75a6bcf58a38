"""What bounds any kernel: the memory it streams through, the operations it needs, and the memory there is."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.compile.emit import emitter
from rttrr_pin.compile.emit.llvm_angles import polynomials
from rttrr_pin.compile.emit.llvm_vectors import Lines
from rttrr_pin.compile.expression import LEAVES, Graph, Op
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.program import Program
from rttrr_pin.compile.summation import order_sums

Array = NDArray[np.float64]

ARRAYS = 30
"""Arrays of (N, nv) doubles that a run holds at its peak: states, their making, both layouts, Pinocchio's, results."""


def copy(q: Array, v: Array, a: Array, threads: int) -> Callable[[], object]:
    """A function that reads q, v, a and writes as much as tau once, and computes next to nothing."""
    tau = np.zeros_like(v)
    pieces = [tuple(part) for part in zip(*(np.array_split(x, threads) for x in (q, v, a, tau)), strict=True)]

    def piece(q: Array, v: Array, a: Array, tau: Array) -> None:
        np.add(q, v, out=tau)
        a.sum()

    if threads == 1:
        return lambda: piece(*pieces[0])
    pool = ThreadPoolExecutor(threads)
    return lambda: [done.result() for done in [pool.submit(piece, *part) for part in pieces]]


def available_states(wanted: int, nv: int) -> int:
    """As many states as wanted, or as half of the free memory holds."""
    info = Path("/proc/meminfo")
    free = [line.split()[1] for line in info.read_text().splitlines() if line.startswith("MemAvailable")]
    return min(wanted, int(free[0]) * 1024 // 2 // (8 * nv * ARRAYS)) if free else wanted


def operations(program: Program) -> int:
    """Instructions that one state needs, with products fused into sums, sines and cosines by their polynomials."""
    lines = Lines(1)
    polynomials(lines, "%q")
    fused = order_sums(program, fused=True)
    ops = [fused.graph.op[x] for x in fused.order]
    arithmetic = [op for op in ops if op not in LEAVES and op not in (Op.SIN, Op.COS)]
    return len(arithmetic) + lines.count * program.operations.sincos


def peak(chains: int = 10, length: int = 400, states: int = 2048, repeats: int = 30) -> float:
    """Fused multiply-adds that one core completes in a nanosecond, with nothing to load or store: measured."""
    graph = Graph()
    values = [graph.input(k) for k in range(chains)]
    factor, term = graph.input(chains), graph.input(chains + 1)
    for _ in range(length):
        values = [graph.apply(Op.FMA, (x, factor, term)) for x in values]
    program = Program(graph, (Field("x", (chains + 2,)),), (Field("y", (chains,)),), tuple(values))
    machine = emitter("llvm")
    executable = machine.load(machine.emit(program), program.inputs, program.outputs)
    task = executable.bind([np.full((states, chains + 2), 0.5)], [np.empty((states, chains))])
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        task(0, states)
        times.append(time.perf_counter() - start)
    return chains * length * states / min(times) / 1e9
