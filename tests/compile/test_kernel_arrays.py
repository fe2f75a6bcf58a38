"""Arrays in and out of a kernel: any shape and layout, in any batch and on any thread, have the same bits."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Robot, RttrrError, Wrench
from rttrr_pin.compile import QUANTITIES, Kernel
from rttrr_pin.core.wrench import RESULTS
from rttrr_pin.errors import InputError, ShapeError
from support.inputs import JOINTS, some
from support.recursion import recursion
from support.serial_chains import EXAMPLES
from support.tolerances import ROUNDING, norm_error

BLOCK = 64
PART = 8192


# Shapes and layouts


@pytest.mark.parametrize("batch", [(), (1,), (3,), (2, 3), (0,), (2, 0), (0, 2), (1, 1, 1), (2, 1, 3)], ids=str)
def test_outputs_follow_the_batch_axes(wrenches: Kernel, batch: tuple[int, ...]) -> None:
    result = wrenches(*some(batch))
    assert {name: x.shape for name, x in result.items()} == dict.fromkeys(("tau", "tau_joint"), (*batch, 5)) | (
        dict.fromkeys("FNfn", (*batch, 6, 3))
    )


def test_leading_axes_broadcast(kernel: Kernel) -> None:
    q, v, a = some((4, 3))
    wide = kernel(q[:, :1], v[:1], a[2, 1])
    assert wide.shape == (4, 3, 5)
    for i, k in np.ndindex(4, 3):
        np.testing.assert_array_equal(wide[i, k], kernel(q[i, 0], v[0, k], a[2, 1]))


@pytest.mark.one_in(8)
@pytest.mark.parametrize("batch", [(), (4,), (0,), (2, 3)], ids=str)
@pytest.mark.parametrize("text", ["no-joint", "root-alone"])
def test_robots_without_a_joint(text: str, batch: tuple[int, ...], emitter: str) -> None:
    robot = rttrr_pin.load(EXAMPLES.get(text, '<robot name="x"><link name="base"/></robot>'))
    empty = np.zeros((*batch, 0))
    result = robot.compile(tuple(QUANTITIES), emitter)(empty, empty, empty)
    reference = recursion(robot, empty, empty, empty)
    for name in RESULTS:
        assert result[name].shape == getattr(reference, name).shape
        assert norm_error(result[name], getattr(reference, name)) <= ROUNDING
    assert result["regressor"].shape == (*batch, 0, 10 * len(robot.model.links))
    assert result["mass_matrix"].shape == (*batch, 0, 0)


def misaligned(x: np.ndarray) -> np.ndarray:
    raw = np.zeros(x.nbytes + 1, dtype=np.uint8)
    view = raw[1:].view(np.float64).reshape(x.shape)
    view[...] = x
    assert not view.flags.aligned
    return view


def read_only(x: np.ndarray) -> np.ndarray:
    copy = x.copy()
    copy.setflags(write=False)
    return copy


def sliced(x: np.ndarray) -> np.ndarray:
    wide = np.full((3 * len(x), 11), np.nan)
    wide[1::3, 2:7] = x
    return wide[1::3, 2:7]


class Mine(np.ndarray):
    """A subclass, such as np.matrix or a memory map."""


LAYOUTS: dict[str, Callable[[np.ndarray], Any]] = {
    "fortran": np.asfortranarray,
    "transposed": lambda x: np.ascontiguousarray(x.T).T,
    "reversed-rows": lambda x: np.ascontiguousarray(x[::-1])[::-1],
    "reversed-columns": lambda x: np.ascontiguousarray(x[:, ::-1])[:, ::-1],
    "reversed-both": lambda x: np.ascontiguousarray(x[::-1, ::-1])[::-1, ::-1],
    "reversed-fortran": lambda x: np.asfortranarray(x[::-1])[::-1],
    "every-other-column": lambda x: np.repeat(x, 2, axis=1)[:, ::2],
    "every-third-row": lambda x: np.repeat(x, 3, axis=0)[::3],
    "inside-nan": sliced,
    "read-only": read_only,
    "big-endian": lambda x: x.astype(">f8"),
    "misaligned": misaligned,
    "lists": lambda x: x.tolist(),
    "tuples-of-arrays": lambda x: tuple(x),
    "dict": lambda x: {name: x[:, j] for j, name in reversed(list(enumerate(JOINTS)))},
    "objects": lambda x: x.astype(object),
    "subclass": lambda x: x.view(Mine),
    "masked-array-without-mask": lambda x: np.ma.masked_array(x),
    "field-of-a-record": lambda x: np.rec.fromarrays([x, x + 1], dtype=[("x", "f8", 5), ("y", "f8", 5)]).x,
}


@pytest.mark.parametrize("rows", [1, 3, 70])
@pytest.mark.parametrize("layout", LAYOUTS)
def test_the_layout_does_not_change_a_bit(kernel: Kernel, layout: str, rows: int) -> None:
    state = some((rows,), seed=rows)
    expected = kernel(*state)
    other = [LAYOUTS[layout](x) for x in state]
    np.testing.assert_array_equal(kernel(*other), expected)
    np.testing.assert_array_equal(kernel(state[0], other[1], state[2]), expected)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("layout", ["fortran", "reversed-both", "every-other-column", "inside-nan", "read-only"])
def test_few_states_in_any_strides_are_computed_at_once(rttrr: Robot, layout: str, dtype: type) -> None:
    """Compiled code takes them and the payload as they are, and writes where it is told."""
    made, payload = rttrr.compile("tau"), Wrench((1.0, 2.0, 3.0))
    state = [x.astype(dtype) for x in some((70,))]
    expected, loaded = made(*state), made(*state, payload=payload)
    other = [LAYOUTS[layout](x) for x in state]
    for out in (None, np.empty((70, 5), order="F"), np.empty((140, 10))[::-2, ::2]):
        np.testing.assert_array_equal(made._at_once(*other, None, out), expected)
        np.testing.assert_array_equal(made._at_once(*other, payload, out), loaded)


@pytest.mark.parametrize("layout", LAYOUTS)
def test_the_layout_of_a_payload_does_not_change_a_bit(kernel: Kernel, layout: str) -> None:
    if layout in ("dict", "inside-nan", "field-of-a-record"):
        return  # of five columns
    state, (force, moment) = some((7,)), np.random.default_rng(0).uniform(-1, 1, (2, 7, 3))
    other = [LAYOUTS[layout](x) for x in (force, moment)]
    np.testing.assert_array_equal(kernel(*state, payload=Wrench(*other)), kernel(*state, payload=Wrench(force, moment)))


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("axes", [(0, 1, 2), (1, 0, 2), (2, 0, 1), (1, 2, 0)], ids=str)
def test_batches_of_three_axes_in_any_order_of_memory(kernel: Kernel, axes: tuple[int, ...], order: Any) -> None:
    state = some((4, 6))
    back = np.argsort(axes)
    other = [np.array(np.transpose(x, axes), order=order).transpose(back) for x in state]
    np.testing.assert_array_equal(kernel(*other), kernel(*state))


def test_a_batch_whose_states_lie_in_no_rows_is_copied_in_parts(kernel: Kernel) -> None:
    """Inputs and outputs: the last axis of memory is the first of the batch."""
    out = np.empty((10, 5, 20_000)).transpose(2, 0, 1)
    given = [x.transpose(2, 0, 1) for x in np.random.default_rng(0).uniform(-1, 1, (3, 10, 5, 20_000))]
    tracemalloc.start()
    try:
        kernel(*given, out=out, threads=1)
        assert tracemalloc.get_traced_memory()[1] < out.nbytes / 2
    finally:
        tracemalloc.stop()
    np.testing.assert_array_equal(out, kernel(*(np.ascontiguousarray(x) for x in given)))


@pytest.mark.parametrize("layout", ["as-is", "fortran", "every-other-column", "reversed-both"])
@pytest.mark.parametrize("dtype", [np.float32, np.float16])
def test_short_floats_are_widened_first(kernel: Kernel, dtype: Any, layout: str) -> None:
    state = [x.astype(dtype) for x in some((70,))]
    other = [LAYOUTS.get(layout, np.copy)(x) for x in state]
    result = kernel(*other)
    assert result.dtype == np.float64
    np.testing.assert_array_equal(result, kernel(*(x.astype(np.float64) for x in state)))
    np.testing.assert_array_equal(kernel(*(x[3] for x in other)), result[3])


@pytest.mark.parametrize("dtype", [np.int8, np.int64, np.uint16, ">i4"], ids=str)
def test_integers_are_taken(kernel: Kernel, dtype: Any) -> None:
    state = np.random.default_rng(0).integers(0, 3, (3, 9, 5)).astype(dtype)
    np.testing.assert_array_equal(kernel(*state), kernel(*state.astype(np.float64)))


def test_transposed_square_arrays_are_read_as_they_are_indexed(kernel: Kernel) -> None:
    """(5, 5) and its transpose have the same shape: only strides tell them apart."""
    state = some((5,))
    flipped = kernel(*(x.T for x in state))
    np.testing.assert_array_equal(flipped, kernel(*(np.ascontiguousarray(x.T) for x in state)))
    assert (flipped != kernel(*state)).any()


# The same bits everywhere


def far(rows: int) -> tuple[np.ndarray, ...]:
    """Now and then an angle that the C library must do."""
    q, v, a = some((rows,), seed=rows)
    q[::17, 3] = 1e7 + np.arange(len(q[::17]))
    return q, v, a


@pytest.fixture(scope="module")
def together(kernel: Kernel) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
    state = far(PART + BLOCK + 3)
    return state, kernel(*state, threads=1)


@pytest.mark.parametrize("rows", [1, 2, 3, 4, 5, 7, 8, 9, 15, 17, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK + 3, 1000])
def test_a_state_gives_the_same_bits_at_any_place_of_any_batch(kernel: Kernel, together: Any, rows: int) -> None:
    state, expected = together
    for first in (0, 1, 2, 3, 16, BLOCK - 1, PART - 1, PART - rows + 1, len(expected) - rows):
        part = slice(first, first + rows)
        np.testing.assert_array_equal(kernel(*(x[part] for x in state)), expected[part])


def test_a_state_alone_has_the_bits_of_the_batch(kernel: Kernel, together: Any) -> None:
    state, expected = together
    out = np.empty(5)
    for k in range(0, 200):
        np.testing.assert_array_equal(kernel(*(x[k] for x in state)), expected[k])
        np.testing.assert_array_equal(kernel(*(x[k] for x in state), out=out), expected[k])
        np.testing.assert_array_equal(kernel(*(x[k : k + 1, ::-1][:, ::-1][0] for x in state), out=out), expected[k])


@pytest.mark.parametrize("threads", [1, 2, 3, 7, None])
def test_threads_do_not_change_a_bit(kernel: Kernel, threads: int | None) -> None:
    state = far(3 * PART + 5)
    np.testing.assert_array_equal(kernel(*state, threads=threads), kernel(*state, threads=1))


def test_outputs_beside_it_do_not_leave_gaps(rttrr: Robot) -> None:
    """A dict by name, in any layout, is the same as fresh arrays."""
    kernel = rttrr.compile(RESULTS)
    state = some((BLOCK + 5,))
    fresh = kernel(*state)
    out = {name: np.asfortranarray(np.full_like(x, np.nan)) for name, x in fresh.items()}
    assert kernel(*state, out=out) is out
    for name, x in fresh.items():
        np.testing.assert_array_equal(out[name], x)


BAD_THREADS = (0, -1, 1.0, True, "2", 5000)


@pytest.mark.parametrize("rows", [(), (0,), (3,)], ids=str)
@pytest.mark.parametrize("given", [False, True], ids=["fresh", "out"])
def test_bad_threads(kernel: Kernel, rows: tuple[int, ...], given: bool) -> None:
    """Also where one thread is enough anyhow: a typing error must not wait for a larger batch."""
    state = some(rows)
    out = np.empty((*rows, 5)) if given else None
    kernel(*state, out=out)
    for threads in BAD_THREADS:
        with pytest.raises(InputError, match="threads is .* expected a whole number from 1"):
            kernel(*state, out=out, threads=threads)  # type: ignore[arg-type]


# out


def strided(shape: tuple[int, ...]) -> np.ndarray:
    return np.full(tuple(3 * n for n in shape), np.nan)[tuple(slice(1, None, 3) for _ in shape)]


OUT: dict[str, Callable[[tuple[int, ...]], np.ndarray]] = {
    "c": np.empty,
    "fortran": lambda shape: np.empty(shape, order="F"),
    "strided": strided,
    "reversed": lambda shape: np.empty(shape)[tuple(slice(None, None, -1) for _ in shape)],
    "one-row-in-two": lambda shape: np.empty((2 * shape[0], *shape[1:]))[::2],
    "subclass": lambda shape: np.empty(shape).view(Mine),
}


@pytest.mark.parametrize("batch", [(), (1,), (0,), (7,), (2 * BLOCK + 1,), (3, 4)], ids=str)
@pytest.mark.parametrize("layout", OUT)
def test_out_is_filled_and_returned(kernel: Kernel, mass_matrix: Kernel, layout: str, batch: tuple[int, ...]) -> None:
    state = some(batch)
    for _ in range(2):  # the first call compiles, later ones may take a short cut
        for made, arguments in ((kernel, state), (mass_matrix, state[:1])):
            expected = made(*arguments)
            out = OUT[layout](expected.shape)
            out[...] = np.nan
            assert made(*arguments, out=out) is out
            np.testing.assert_array_equal(out, expected)


def test_out_leaves_its_surroundings_alone(kernel: Kernel) -> None:
    state = some((BLOCK + 3,))
    around = np.full((3 * (BLOCK + 3), 15), -7.0)
    inner = around[1::3, 2:12:2]
    kernel(*state, out=inner)
    np.testing.assert_array_equal(inner, kernel(*state))
    inner[:] = -7.0
    assert (around == -7.0).all()


OVERLAPS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "itself": lambda a: a,
    "reversed-rows": lambda a: a[::-1],
    "reversed-columns": lambda a: a[:, ::-1],
    "transposed": lambda a: a[:5].T,
}


@pytest.mark.parametrize("rows", [5, 200])
@pytest.mark.parametrize("case", OVERLAPS)
@pytest.mark.parametrize("name", ["q", "v", "a"])
def test_out_may_overlap_an_input(kernel: Kernel, case: str, rows: int, name: str) -> None:
    state = dict(zip("qva", some((rows,)), strict=True))
    mine = state[name]
    target = OVERLAPS[case](mine)
    if target.shape != mine.shape:
        state = {key: x[:5] for key, x in state.items()}
    expected = kernel(**state)
    kernel(**state, out=target)
    np.testing.assert_array_equal(target, expected)


def test_out_one_row_further_than_an_input(kernel: Kernel) -> None:
    q, v, _ = some((200,))
    memory = np.random.default_rng(5).uniform(-1, 1, (201, 5))
    expected = kernel(q, v, memory[:-1])
    kernel(q, v, memory[:-1], out=memory[1:])
    np.testing.assert_array_equal(memory[1:], expected)


def test_one_states_out_may_be_its_input(kernel: Kernel) -> None:
    q, v, a = some(())
    expected = kernel(q, v, a)
    for _ in range(2):
        same = a.copy()
        assert kernel(q, v, same, out=same) is same
        np.testing.assert_array_equal(same, expected)
        turned = a.copy()
        kernel(q, v, turned, out=turned[::-1])
        np.testing.assert_array_equal(turned[::-1], expected)


def test_out_may_overlap_a_payload(kernel: Kernel) -> None:
    state = some((9,))
    memory = np.random.default_rng(5).uniform(-1, 1, (9, 5))
    expected = kernel(*state, payload=Wrench(memory[:, 1:4].copy()))
    np.testing.assert_array_equal(kernel(*state, payload=Wrench(memory[:, 1:4]), out=memory), expected)


BAD_OUT: dict[str, tuple[Callable[[], Any], type[RttrrError], str]] = {
    "list": (lambda: [0.0] * 5, InputError, "out for tau is a list"),
    "float32": (lambda: np.zeros((3, 5), np.float32), InputError, "array of float32: expected a float64 array"),
    "big-endian": (lambda: np.zeros((3, 5), ">f8"), InputError, "array of >f8"),
    "integers": (lambda: np.zeros((3, 5), int), InputError, "array of int64"),
    "objects": (lambda: np.zeros((3, 5), object), InputError, "array of object"),
    "complex": (lambda: np.zeros((3, 5), complex), InputError, "array of complex"),
    "misaligned": (lambda: misaligned(np.zeros((3, 5))), InputError, "out for tau"),
    "rows": (lambda: np.zeros((4, 5)), ShapeError, r"out for tau has shape \(4, 5\), expected \(3, 5\)"),
    "columns": (lambda: np.zeros((3, 6)), ShapeError, r"\(3, 6\)"),
    "transposed": (lambda: np.zeros((5, 3)), ShapeError, r"\(5, 3\)"),
    "flat": (lambda: np.zeros(15), ShapeError, r"\(15,\)"),
    "too-many-axes": (lambda: np.zeros((1, 3, 5)), ShapeError, r"\(1, 3, 5\)"),
    "no-axis": (lambda: np.zeros(()), ShapeError, r"\(\)"),
    "read-only": (lambda: read_only(np.zeros((3, 5))), InputError, "cannot be written"),
    "broadcast": (lambda: np.broadcast_to(np.zeros(5), (3, 5)), InputError, "cannot be written"),
    "dict": (lambda: {"tau": np.zeros((3, 5))}, InputError, "out for tau is a dict"),
}


@pytest.mark.parametrize("batch", [(3,), ()], ids=str)
@pytest.mark.parametrize("case", BAD_OUT)
def test_bad_out(kernel: Kernel, case: str, batch: tuple[int, ...]) -> None:
    make, error, message = BAD_OUT[case]
    out = make()
    if not batch and isinstance(out, np.ndarray) and out.shape == (3, 5):
        out = out[0]
    elif not batch:
        message = "out for tau"
    for _ in range(2):
        with pytest.raises(error, match=message):
            kernel(*some(batch), out=out)
    assert not np.any(out["tau"] if isinstance(out, dict) else out)


def test_out_of_several_is_a_dict_of_all_and_nothing_else(wrenches: Kernel) -> None:
    state = some((3,))
    good = wrenches(*state)
    for bad in (
        good["tau"],
        {},
        {name: x for name, x in good.items() if name != "N"},
        good | {"tau_": np.zeros((3, 5))},
        {name: x for name, x in good.items() if name != "N"} | {"Nn": good["N"]},
        list(good.values()),
    ):
        with pytest.raises(InputError, match="out must be a dict with an array for each of tau, F, N, f, n, tau_joint"):
            wrenches(*state, out=bad)
    with pytest.raises(ShapeError, match="out for N has shape"):
        wrenches(*state, out=good | {"N": np.zeros((3, 5, 3))})


@pytest.mark.parametrize("batch", [(), (3,)], ids=str)
def test_out_of_several_by_name(wrenches: Kernel, batch: tuple[int, ...]) -> None:
    state = some(batch)
    fresh = wrenches(*state)
    for _ in range(2):
        out = {name: np.full_like(fresh[name], np.nan) for name in reversed(fresh)}
        assert wrenches(*state, out=out) is out
        for name, x in fresh.items():
            np.testing.assert_array_equal(out[name], x)


def test_outputs_that_share_memory_are_refused(wrenches: Kernel) -> None:
    """One array for two quantities: one of them would be lost without a word."""
    state = some((3,))
    shared = np.zeros((3, 6, 3))
    with pytest.raises(InputError, match="out"):
        wrenches(*state, out=wrenches(*state) | {"F": shared, "N": shared})
