"""What compiled code reads and writes lies as it may: any width, length, stride and type gives the same numbers."""

from __future__ import annotations

import struct
from collections.abc import Callable
from functools import cache

import llvmlite.binding as binding
import numpy as np
import pytest

from rttrr_pin import Robot
from rttrr_pin.compile.build import build
from rttrr_pin.compile.emit import Executable, llvm, llvm_body
from rttrr_pin.compile.emit.llvm import OPTIMISATION, emitter
from rttrr_pin.compile.emit.llvm_module import module
from rttrr_pin.compile.expression import Graph
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.program import Program

WIDTHS = (1, 2, 3, 4, 5, 7, 8, 38)
LANES = (2, 4, 8)
"""Whatever this processor has: LLVM makes shorter vectors of longer ones."""

SHORT = {2, 9, 10, 11, 26, 41, 42}
"""Relocations of 32 bits on x86-64, but for calls, which the loader leads over a stub: R_X86_64_PC32, ..."""

ROWS = (1, 2, 3, 4, 5, 8, 9, 31, 32, 33, 63, 64, 65, 131)


SEGMENTS = {"short": 700, "long": 16}
"""Operations in a segment of the program: it goes through vectors one by one, or through larger blocks."""


@cache
def copier(lanes: int, length: str = "short") -> Executable:
    """A program that hands on minus the numbers of arrays of all widths, but for the last of each, which is not read."""
    graph, results, first = Graph(), [], 0
    for width in WIDTHS:
        results += [graph.neg(graph.input(first + j)) for j in range(width)]
        first += width + 1
    inputs = tuple(Field(f"x{width}", (width + 1,)) for width in WIDTHS)
    made = Program(graph, inputs, tuple(Field(f"y{width}", (width,)) for width in WIDTHS), tuple(results))
    how = emitter()
    machine = how._machine()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(llvm_body, "SEGMENT", SEGMENTS[length])
        code = machine.emit_object(module(made, lanes, machine, OPTIMISATION))
    return how.load(code, made.inputs, made.outputs)


@pytest.fixture(scope="module", params=SEGMENTS)
def length(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module", params=LANES)
def how(request: pytest.FixtureRequest, length: str) -> Executable:
    return copier(int(request.param), length)


def offset(x: np.ndarray) -> np.ndarray:
    """On an address that is no multiple of anything longer than a number."""
    raw = np.empty(x.nbytes + 64 + x.itemsize, dtype=np.uint8)
    start = -raw.ctypes.data % 64 + x.itemsize
    view = raw[start : start + x.nbytes].view(x.dtype).reshape(x.shape)
    view[...] = x
    return view


IN: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "rows": np.ascontiguousarray,
    "columns": np.asfortranarray,
    "offset rows": offset,
    "offset columns": lambda x: offset(x.T.copy()).T,
    "backwards": lambda x: x[::-1, ::-1].copy()[::-1, ::-1],
    "columns backwards": lambda x: np.asfortranarray(x[::-1])[::-1],
    "rows in wider ones": lambda x: np.concatenate([x, x], axis=1)[:, : x.shape[1]],
    "every third row": lambda x: np.repeat(x, 3, axis=0)[::3],
    "every second column": lambda x: np.repeat(x, 2, axis=1)[:, ::2],
}

OUT: dict[str, Callable[[tuple[int, int]], np.ndarray]] = {
    "rows": lambda shape: np.full(shape, 7.0),
    "columns": lambda shape: np.full(shape, 7.0, order="F"),
    "offset rows": lambda shape: offset(np.full(shape, 7.0)),
    "backwards": lambda shape: np.full(shape, 7.0)[::-1, ::-1],
    "rows in wider ones": lambda shape: np.full((shape[0], shape[1] + 3), 7.0)[:, 1:-2],
    "every second column": lambda shape: np.full((shape[0], 2 * shape[1]), 7.0)[:, ::2],
}


def numbers(rows: int) -> list[np.ndarray]:
    """An array for each input."""
    rng = np.random.default_rng(rows)
    return [rng.uniform(-1, 1, (rows, width + 1)).astype(np.float32).astype(np.float64) for width in WIDTHS]


def copied(how: Executable, inputs: list[np.ndarray], out: str = "rows") -> tuple[list[np.ndarray], bool]:
    """The outputs, and whether the program says that a number is not finite."""
    outputs = [OUT[out]((len(inputs[0]), width)) for width in WIDTHS]
    surroundings = [x.base if x.base is not None and x.base.dtype == np.float64 else x for x in outputs]
    before = [int((x == 7.0).sum()) - y.size for x, y in zip(surroundings, outputs, strict=True)]
    bad = how.bind(inputs, outputs)(0, len(inputs[0]))
    assert [int((x == 7.0).sum()) for x in surroundings] == before  # nothing beside them is written
    return outputs, bad


@pytest.mark.one_in(3)
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("layout", IN)
def test_arrays_of_any_layout_are_read(layout: str, dtype: type, how: Executable) -> None:
    for rows in ROWS:
        inputs = numbers(rows)
        outputs, bad = copied(how, [IN[layout](x.astype(dtype)) for x in inputs])
        assert not bad
        for x, y in zip(inputs, outputs, strict=True):
            np.testing.assert_array_equal(y, -x[:, :-1])


@pytest.mark.one_in(3)
@pytest.mark.parametrize("layout", OUT)
def test_arrays_of_any_layout_are_written(layout: str, how: Executable) -> None:
    for rows in ROWS:
        inputs = numbers(rows)
        outputs, bad = copied(how, inputs, layout)
        assert not bad
        for x, y in zip(inputs, outputs, strict=True):
            np.testing.assert_array_equal(y, -x[:, :-1])


def test_one_row_for_all_states(how: Executable) -> None:
    """A payload that does not change."""
    for rows in ROWS:
        inputs = [np.broadcast_to(x[:1], x.shape) for x in numbers(rows)]
        for x, y in zip(inputs, copied(how, inputs)[0], strict=True):
            np.testing.assert_array_equal(y, -x[:, :-1])


@pytest.mark.one_in(3)
@pytest.mark.parametrize("layout", ["rows", "columns", "every second column"])
def test_what_is_not_finite_is_found_wherever_it_is(layout: str, how: Executable) -> None:
    """In any column of any array, read or not, in any state; its neighbours keep their numbers."""
    for rows in (1, 4, 8, 9, 19, 67):
        for number in (np.nan, np.inf, -np.inf):
            for k, width in enumerate(WIDTHS):
                for state, column in ((0, 0), (rows - 1, width), (rows // 2, width // 2), (rows - 1, width - 1)):
                    inputs = numbers(rows)
                    inputs[k][state, column] = number
                    outputs, bad = copied(how, [IN[layout](x) for x in inputs], layout)
                    assert bad, (rows, width, state, column)
                    for x, y in zip(inputs, outputs, strict=True):
                        np.testing.assert_array_equal(y, -x[:, :-1])


def test_parts_of_a_batch(how: Executable) -> None:
    """From any state to any other; the rest is left alone."""
    inputs = numbers(150)
    for start, stop in ((0, 0), (0, 1), (1, 2), (3, 70), (64, 128), (149, 150), (5, 150)):
        outputs = [np.full((150, width), 7.0) for width in WIDTHS]
        assert not how.bind(inputs, outputs)(start, stop)
        for x, y in zip(inputs, outputs, strict=True):
            np.testing.assert_array_equal(y[start:stop], -x[start:stop, :-1])
            assert (np.delete(y, np.s_[start:stop], axis=0) == 7.0).all()


def relocations(code: bytes) -> set[int]:
    """The types of what the loader has to fill in in sections of code of an ELF file of 64 bits."""
    start, size, count = struct.unpack_from("<Q", code, 0x28)[0], *struct.unpack_from("<HH", code, 0x3A)
    sections = [struct.unpack_from("<IIQQQQIIQQ", code, start + k * size) for k in range(count)]
    executable = {k for k, own in enumerate(sections) if own[2] & 4}
    tables = [own for own in sections if own[1] == 4 and own[7] in executable]
    return {code[at + 8] for own in tables for at in range(own[4], own[4] + own[5], 24)}


@pytest.mark.parametrize("outputs", ["tau", "mass_matrix"])
@pytest.mark.parametrize("straight_line", [0, 20_000], ids=["calls", "straight lines"])
def test_code_is_bound_to_lie_near_nothing(rttrr: Robot, outputs: str, straight_line: int) -> None:
    """The loader may put sections 100 GB apart: addresses have 64 bits, and functions of others are called by a stub."""
    if not llvm.ELF:
        return
    code = emitter().emit(build(rttrr.model, (outputs,), (), straight_line, True))
    found = relocations(code)
    assert found and not found & SHORT


def test_programs_for_wider_vectors_are_whole() -> None:
    """What another processor runs is compiled here."""
    graph = Graph()
    inputs = [graph.input(k) for k in range(5)]
    made = Program(graph, (Field("x", (5,)),), (Field("y", (5,)),), tuple(graph.mul(x, x) for x in inputs))
    triple = binding.get_process_triple()
    if not triple.startswith("x86_64"):
        return
    machine = binding.Target.from_triple(triple).create_target_machine(cpu="znver4", features="", opt=OPTIMISATION)
    assert "zmm" in machine.emit_assembly(module(made, 8, machine, OPTIMISATION))
