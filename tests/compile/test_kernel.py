"""The compiled kernel as a user calls it: the reference's numbers, whatever the arrays look like, and every error."""

from __future__ import annotations

import copy
import gc
import multiprocessing
import pickle
import subprocess
import sys
import threading
import tracemalloc
import weakref
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import JointEffects, Robot, RttrrError, Wrench
from rttrr_pin.compile import QUANTITIES, Kernel
from rttrr_pin.errors import InputError, NumberError, ShapeError, UnknownNameError
from rttrr_pin.validation import Sampler
from support.inputs import BAD, JOINTS, PAYLOADS, ZERO, some
from support.recursion import recursion
from support.serial_chains import EXAMPLES
from support.slow import slow_after, slow_but
from support.tolerances import ROUNDING, norm_error
from support.trees import random_tree

EMITTERS = ("llvm", "numpy")
RECURSION = ("tau", "F", "N", "f", "n", "tau_joint")
PART = 8192
BLOCK = 64


@pytest.fixture(scope="module", params=EMITTERS)
def emitter(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def kernel(rttrr: Robot, emitter: str) -> Kernel:
    return rttrr.compile("tau", emitter)


@pytest.fixture(scope="module")
def wrenches(rttrr: Robot, emitter: str) -> Kernel:
    return rttrr.compile(RECURSION, emitter)


@pytest.fixture(scope="module")
def mass_matrix(rttrr: Robot, emitter: str) -> Kernel:
    return rttrr.compile("mass_matrix", emitter)


@cache
def tree(seed: int, joints: int, base: Any = "fixed") -> Robot:
    return rttrr_pin.load(random_tree(seed, joints), base=base, friction=True)


def agree(
    robot: Robot, outputs: str | Sequence[str], payload: Any = None, seed: int = 0, emitter: str = "llvm"
) -> None:
    """The kernel and the specification over floats, on states of every kind."""
    outputs = (outputs,) if isinstance(outputs, str) else outputs
    drawn = Sampler(robot.model, "mixed", seed).draw(0, 70)
    ours = robot.compile(outputs, emitter)(drawn.q, drawn.v, drawn.a, payload=payload)
    theirs = recursion(robot, drawn.q, drawn.v, drawn.a, payload)
    for name in outputs:
        assert norm_error(ours[name], getattr(theirs, name)) <= ROUNDING, name


# Numbers


def test_the_specifications_numbers(robot: Robot) -> None:
    agree(robot, RECURSION)
    agree(robot, "tau", emitter="numpy")


@pytest.mark.parametrize("outputs", ["tau", RECURSION], ids=["tau", "all"])
@pytest.mark.parametrize(("seed", "joints", "base"), [(1, 5, "floating"), (5, 9, "fixed")], ids=str)
def test_trees_with_every_joint_type_followers_and_friction(seed: int, joints: int, base: Any, outputs: Any) -> None:
    agree(tree(seed, joints, base), outputs, seed=seed)


@pytest.mark.parametrize("seed", range(8))
def test_many_trees_by_the_emitter_that_compiles_nothing(seed: int) -> None:
    """The same program, lumped and folded, without the compiler's time."""
    for base in ("fixed", "floating"):
        agree(tree(seed, 2 + 2 * seed, base), "tau", seed=seed, emitter="numpy")


def test_drives_enter_tau_and_not_the_bearings(rttrr: Robot) -> None:
    robot = rttrr.with_joint_effects({"joint_2": JointEffects(3.0, 2.0, 5.0), "joint_5": JointEffects(armature=0.1)})
    agree(robot, RECURSION)


PAYLOAD_CASES: dict[str, Any] = {
    "tool": Wrench((1.0, -2.0, 3.0), (0.1, 0.2, -0.3)),
    "base": Wrench((1.0, -2.0, 3.0), (0.1, 0.2, -0.3), expressed_in="base"),
    "inner": Wrench((1.0, -2.0, 3.0), link="link_3", expressed_in="base"),
    "list": [Wrench((1, 2, 3), (4, 5, 6), link="link_4")],
    "tuple": (Wrench((1, 2, 3), (4, 5, 6)), Wrench((0, 1, 0), link="link_1", expressed_in="base")),
    "same-link-twice": [Wrench((1, 2, 3), link="link_4"), Wrench((-1, 4, 9), (1, 1, 0), link="link_4")],
    "none-of-them": [],
    "batch": Wrench(np.random.default_rng(0).uniform(-9, 9, (70, 3)), (0.1, 0.2, 0.3)),
    "both-batches": Wrench(*np.random.default_rng(1).uniform(-9, 9, (2, 70, 3)), expressed_in="base"),
    "lists-and-integers": Wrench([1, 2, 3], np.array([1, 2, 3], dtype=np.int8)),
    "fortran": Wrench(np.asfortranarray(np.random.default_rng(2).uniform(-9, 9, (70, 3)))),
}


@pytest.mark.parametrize("case", PAYLOAD_CASES)
def test_payloads(rttrr: Robot, case: str, emitter: str) -> None:
    agree(rttrr, "tau", PAYLOAD_CASES[case], emitter=emitter)


def test_payloads_on_a_tree_and_a_fixed_link() -> None:
    robot = tree(5, 9)
    fixed = next(joint for joint in robot.model.joints if not joint.nv)
    on_fixed = robot.model.link_names[robot.model.joints.index(fixed)]
    agree(robot, "tau", [Wrench((1, 2, 3), (4, 5, 6), on_fixed, "base"), Wrench((1, 2, 3), link=robot.link_names[-1])])


def test_payload_axes_broadcast_with_the_states(kernel: Kernel) -> None:
    q, v, a = some((4, 1))
    force = np.random.default_rng(1).uniform(-1, 1, (3, 3))
    wide = kernel(q, v, a, payload=Wrench(force))
    assert wide.shape == (4, 3, 5)
    for i, k in np.ndindex(4, 3):
        np.testing.assert_array_equal(wide[i, k], kernel(q[i, 0], v[i, 0], a[i, 0], payload=Wrench(force[k])))


# Outputs


@pytest.mark.parametrize("name", QUANTITIES)
def test_one_name_gives_an_array_and_several_a_dict(rttrr: Robot, name: str) -> None:
    needed = QUANTITIES[name].inputs
    arguments = dict(zip("qva", some((3,)), strict=True))
    given = {key: x for key, x in arguments.items() if key in needed}
    single, listed = (rttrr.compile(outputs, "numpy")(**given) for outputs in (name, [name]))
    assert list(listed) == [name]
    assert single.shape == (3, *QUANTITIES[name].shape(rttrr.model))
    np.testing.assert_array_equal(single, listed[name])


def test_a_list_of_one_name_gives_a_dict_in_every_call(rttrr: Robot) -> None:
    """The first call compiles; compiled code takes those after it."""
    listed, q = rttrr.compile(["tau"]), np.zeros((3, 5))
    for state in (q, q, q[0], q[0]):
        assert listed(state, state, state)["tau"].shape == state.shape


def test_all_outputs_at_once_in_the_order_asked_for(rttrr: Robot) -> None:
    names = tuple(reversed(QUANTITIES))
    state = some((70,))
    together = rttrr.compile(names)(*state)
    assert tuple(together) == names
    reference = recursion(rttrr, *state)
    for name in RECURSION:
        assert norm_error(together[name], getattr(reference, name)) <= ROUNDING


def test_compile_gives_the_same_kernel_again(rttrr: Robot) -> None:
    assert rttrr.compile("tau") is rttrr.compile("tau")
    assert rttrr.compile(["tau"]) is rttrr.compile(("tau",))
    assert rttrr.compile("tau") is not rttrr.compile(("tau",))


def test_results_are_new_writeable_and_the_callers(kernel: Kernel) -> None:
    state = some((3,))
    first, second = kernel(*state), kernel(*state)
    first[:] = 0.0
    assert second.any()
    assert first.flags.writeable and first.flags.c_contiguous and first.dtype == np.float64


BAD_OUTPUTS: dict[str, tuple[Any, type[RttrrError], str]] = {
    "unknown": ("torque", UnknownNameError, "no output is called 'torque'"),
    "unknown-in-list": (("tau", "g"), UnknownNameError, "no output is called 'g'"),
    "none": ((), InputError, "name at least one"),
    "twice": (("tau", "tau"), InputError, "each once"),
    "empty-name": ("", UnknownNameError, "no output is called ''"),
    "number": ((3,), UnknownNameError, "no output is called 3"),
}


@pytest.mark.parametrize("case", BAD_OUTPUTS)
def test_bad_outputs(rttrr: Robot, case: str) -> None:
    outputs, error, message = BAD_OUTPUTS[case]
    with pytest.raises(error, match=message):
        rttrr.compile(outputs)


def test_unknown_emitter(rttrr: Robot) -> None:
    with pytest.raises(UnknownNameError, match=r"no emitter is called 'cuda': .*llvm, numpy, c"):
        rttrr.compile("tau", emitter="cuda")


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


@pytest.mark.parametrize("batch", [(), (4,), (0,), (2, 3)], ids=str)
@pytest.mark.parametrize("text", ["no-joint", "root-alone"])
def test_robots_without_a_joint(text: str, batch: tuple[int, ...], emitter: str) -> None:
    robot = rttrr_pin.load(EXAMPLES.get(text, '<robot name="x"><link name="base"/></robot>'))
    empty = np.zeros((*batch, 0))
    result = robot.compile(tuple(QUANTITIES), emitter)(empty, empty, empty)
    reference = recursion(robot, empty, empty, empty)
    for name in RECURSION:
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
    kernel = rttrr.compile(RECURSION)
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


# Errors


@pytest.mark.parametrize("name", ["q", "v", "a"])
@pytest.mark.parametrize("case", BAD)
def test_bad_coordinates_are_named_with_joint_and_index(kernel: Kernel, case: str, name: str) -> None:
    """The same messages as those of the readable recursion."""
    values, error, message = BAD[case]
    arguments: dict[str, Any] = {"q": ZERO, "v": ZERO, "a": ZERO} | {name: values}
    pattern = f"^{name}" + message[1:] if message.startswith("q") else message
    for out in (None, np.empty((3, 5) if case == "inf-in-batch" else 5)):
        with pytest.raises(error, match=pattern):
            kernel(**arguments, out=out)


@pytest.mark.parametrize("case", PAYLOADS)
def test_bad_payloads(kernel: Kernel, case: str) -> None:
    payload, error, message = PAYLOADS[case]
    with pytest.raises(error, match=message):
        kernel(ZERO, ZERO, ZERO, payload=payload)


def test_batches_that_do_not_broadcast(kernel: Kernel) -> None:
    with pytest.raises(ShapeError, match=r"q: \(2,\), v: \(3,\), a: \(\)"):
        kernel(np.zeros((2, 5)), np.zeros((3, 5)), ZERO)
    with pytest.raises(ShapeError, match=r"payload.*\(3,\)"):
        kernel(np.zeros((2, 5)), ZERO, ZERO, payload=Wrench(np.zeros((3, 3))))


def test_a_masked_array_is_refused(kernel: Kernel) -> None:
    with pytest.raises(NumberError, match="masked entries"):
        kernel(np.ma.masked_array(np.zeros((2, 5)), mask=np.eye(2, 5)), ZERO, ZERO)


@pytest.fixture(scope="module")
def rough(rttrr: Robot) -> Robot:
    """Coulomb friction alone: the sign of a rate is all of it that enters some outputs."""
    return rttrr.with_joint_effects({name: JointEffects(friction=1.0 + i) for i, name in enumerate(JOINTS)})


NOT_FINITE = (np.nan, np.inf, -np.inf)


@pytest.mark.one_in(4)
@pytest.mark.parametrize("value", slow_after(1, NOT_FINITE))
@pytest.mark.parametrize("name", QUANTITIES)
def test_what_is_not_finite_is_found_in_every_input(rough: Robot, name: str, value: float, emitter: str) -> None:
    """Also where no output depends on it, or only on its sign."""
    made = rough.compile(name, emitter)
    needed = QUANTITIES[name].inputs
    state = dict(zip(needed, some((BLOCK + 6,)), strict=False))
    out = np.empty(QUANTITIES[name].shape(rough.model))
    for key in needed:
        for j in range(5):
            bad = state[key].copy()
            bad[BLOCK + 1, j] = value
            with pytest.raises(NumberError, match=rf"^{key}\[{BLOCK + 1}, {j}\], joint 'joint_{j + 1}', is {value}"):
                made(**(state | {key: bad}))
            one = {other: x[0] for other, x in state.items()} | {key: bad[BLOCK + 1]}
            for target in (None, out):
                with pytest.raises(NumberError, match=rf"^{key}\[{j}\], joint 'joint_{j + 1}', is {value}"):
                    made(**one, out=target)


@pytest.mark.parametrize("value", NOT_FINITE)
def test_the_rate_of_a_sliding_joint_with_friction_alone(value: float, emitter: str) -> None:
    robot = rttrr_pin.load(EXAMPLES["one-joint"]).with_joint_effects({"joint_1": JointEffects(friction=2.0)})
    with pytest.raises(NumberError, match=f"joint 'joint_1', is {value}"):
        robot.compile("tau", emitter)(np.zeros((3, 1)), np.array([[0.0], [0.0], [value]]), np.zeros((3, 1)))


@pytest.mark.parametrize("dtype", [np.float32, np.float64, ">f8"], ids=str)
@pytest.mark.parametrize("value", NOT_FINITE)
def test_the_place_of_a_bad_value_is_that_of_the_users_array(kernel: Kernel, value: float, dtype: Any) -> None:
    q = np.zeros((2, 3, 5), dtype=dtype)
    q[1, 2, 4] = value
    with pytest.raises(NumberError) as caught:
        kernel(q, ZERO, np.zeros((3, 5)))
    assert (caught.value.name, caught.value.joint, caught.value.index) == ("q", "joint_5", (1, 2, 4))


@pytest.mark.parametrize("threads", [1, 2])
def test_a_bad_value_in_any_part_is_found(kernel: Kernel, threads: int) -> None:
    state = some((2 * PART + 9,))
    for row in (0, PART - 1, PART, 2 * PART + 8):
        bad = state[1].copy()
        bad[row, 2] = np.nan
        with pytest.raises(NumberError, match=rf"^v\[{row}, 2\]"):
            kernel(state[0], bad, state[2], threads=threads)


def test_values_next_to_a_batch_are_not_looked_at(kernel: Kernel) -> None:
    wide = np.full((BLOCK + 9, 9), np.nan)
    wide[4:-4, 2:7] = 0.25
    inner = wide[4:-4, 2:7]
    np.testing.assert_array_equal(kernel(inner, inner, inner), kernel(inner.copy(), inner.copy(), inner.copy()))


@pytest.mark.parametrize("batch", [(), (3,), (3, 2)], ids=str)
def test_overflow_names_the_state(kernel: Kernel, batch: tuple[int, ...]) -> None:
    q, v, a = some(batch)
    v.reshape(-1, 5)[-1, 0] = 1e200
    for out in (None, np.empty((*batch, 5))):
        with pytest.raises(
            NumberError, match=rf"tau overflows in state {max(int(np.prod(batch)) - 1, 0)}, where \|v\| reaches 1e\+200"
        ):
            kernel(q, v, a, out=out)


def test_large_finite_numbers_are_no_error(kernel: Kernel) -> None:
    """1e100 squared does not overflow, and the greatest coordinate is an angle as any other."""
    assert np.isfinite(kernel(ZERO + 1e10, ZERO + 1e100, ZERO + 1e200)).all()
    assert np.isfinite(kernel([np.finfo(float).max, 0, 0, np.finfo(float).max, -np.finfo(float).max], ZERO, ZERO)).all()


def test_a_kernel_works_after_an_error(kernel: Kernel) -> None:
    state = some((3,))
    before = kernel(*state)
    for bad in (np.full((3, 5), np.nan), np.zeros((3, 4)), "q", None, {}, object()):
        with pytest.raises(RttrrError):
            kernel(bad, *state[1:])
    np.testing.assert_array_equal(kernel(*state), before)


WRONG_ARGUMENTS: dict[str, tuple[str, tuple[str, ...], str]] = {
    "tau-without-a": ("tau", ("q", "v"), "a is missing: tau depend on q, v, a"),
    "tau-without-v": ("tau", ("q", "a"), "v is missing"),
    "tau-without-q": ("tau", ("v", "a"), "q is missing"),
    "mass-matrix-without-q": ("mass_matrix", (), "q is missing"),
    "mass-matrix-with-v": ("mass_matrix", ("q", "v"), "v was passed"),
    "mass-matrix-with-a": ("mass_matrix", ("q", "a"), "a was passed"),
    "mass-matrix-of-a": ("mass_matrix", ("a",), "q is missing"),
    "gravity-torque-of-v": ("gravity_torque", ("v",), "q is missing"),
    "nonlinear-effects-of-q-and-a": ("nonlinear_effects", ("q", "a"), "v is missing"),
    "nonlinear-effects-of-v-and-a": ("nonlinear_effects", ("v", "a"), "q is missing"),
    "nonlinear-effects-with-a": ("nonlinear_effects", ("q", "v", "a"), "a was passed"),
}


@pytest.mark.parametrize("given", [False, True], ids=["fresh", "out"])
@pytest.mark.parametrize("case", WRONG_ARGUMENTS)
def test_missing_and_superfluous_arguments(rttrr: Robot, case: str, given: bool) -> None:
    """Whether it is the first call or a later one, with `out` or without."""
    name, keys, message = WRONG_ARGUMENTS[case]
    made = rttrr.compile(name)
    state = dict(zip("qva", some(()), strict=True))
    out = made(**{key: state[key] for key in QUANTITIES[name].inputs})
    with pytest.raises(InputError, match=message):
        made(*(state[key] if key in keys else None for key in "qva"), out=out if given else None)


def test_a_payload_where_none_enters(mass_matrix: Kernel) -> None:
    with pytest.raises(InputError, match="mass_matrix does not depend on it"):
        mass_matrix(ZERO, payload=Wrench((0, 0, 1)))


@pytest.fixture(scope="module")
def floating() -> Robot:
    return rttrr_pin.load("rttrr", base="floating")


QUATERNIONS: dict[str, tuple[Any, str]] = {
    "long": ((0, 0, 0, 2.0), "quaternion .* of length 2, expected 1"),
    "zero": ((0, 0, 0, 0), "of length 0"),
    "nearly": ((0, 0, 0, 1 + 1e-9), "of length 1.000000001"),
    "nan": ((0, np.nan, 0, 1.0), r"q\[4\], joint 'root_joint.qy', is nan"),
    "inf": ((0, np.inf, 0, 1.0), r"q\[4\], joint 'root_joint.qy', is inf"),
    "square-overflows": ((0, 0, 0, 1e200), "quaternion .* of length"),
}


@pytest.mark.parametrize("case", QUATERNIONS)
def test_bad_quaternions(floating: Robot, case: str, emitter: str) -> None:
    quaternion, message = QUATERNIONS[case]
    q = np.r_[0, 0, 0, quaternion, ZERO]
    for values in (q, q.tolist()):
        with pytest.raises(NumberError, match=message):
            floating.compile("tau", emitter)(values, np.zeros(11), np.zeros(11))


def test_a_quaternion_is_looked_at_in_every_call(floating: Robot) -> None:
    """Also once compiled, with an array to write to."""
    made = floating.compile("tau")
    q, out = np.r_[0, 0, 0, 0, 0, 0, 1.0, ZERO], np.empty(11)
    made(q, np.zeros(11), np.zeros(11), out=out)
    with pytest.raises(NumberError, match="of length 2"):
        made(np.r_[0, 0, 0, 0, 0, 0, 2.0, ZERO], np.zeros(11), np.zeros(11), out=out)


def test_the_numbers_of_rates_and_coordinates_are_not_mixed_up(floating: Robot) -> None:
    with pytest.raises(ShapeError, match="q has 11 values .* expected 12"):
        floating.compile("tau")(np.zeros(11), np.zeros(11), np.zeros(11))
    with pytest.raises(ShapeError, match="v has 12 values .* expected 11"):
        floating.compile("tau")(np.r_[0, 0, 0, 0, 0, 0, 1.0, ZERO], np.zeros(12), np.zeros(11))


def test_mappings_other_than_dict_are_taken(kernel: Kernel) -> None:
    class Table(Mapping[str, float]):
        def __getitem__(self, key: str) -> float:
            return 0.5

        def __iter__(self) -> Iterator[str]:
            return iter(JOINTS)

        def __len__(self) -> int:
            return 5

    np.testing.assert_array_equal(kernel(Table(), ZERO, ZERO), kernel(ZERO + 0.5, ZERO, ZERO))


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))], ids=["copy", "pickle"])
def test_robots_and_kernels_are_copied_and_go_to_other_processes(rttrr: Robot, copied: Callable[[Any], Any]) -> None:
    """Whether they have computed or not."""
    robot = Robot(rttrr.model)
    robot.gravity_torque(ZERO)
    np.testing.assert_array_equal(copied(robot).gravity_torque(ZERO), robot.gravity_torque(ZERO))
    for outputs in ("tau", ("tau", "f")):
        kernel = robot.compile(outputs)
        other = copied(kernel)
        assert (other.outputs, repr(other)) == (kernel.outputs, repr(kernel))
        np.testing.assert_equal(other(*some((3,))), kernel(*some((3,))))


def test_a_process_pool_maps_a_kernel(rttrr: Robot) -> None:
    kernel = rttrr.compile()
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        results = list(pool.map(kernel, *[[x] * 2 for x in some(())]))
    for tau in results:
        np.testing.assert_array_equal(tau, kernel(*some(())))


def test_repr_says_what_it_computes(wrenches: Kernel, emitter: str) -> None:
    assert repr(wrenches) == f"<Kernel of 'rttrr': tau, F, N, f, n, tau_joint by {emitter}>"


# Threads, processes, memory


def in_threads(calls: Sequence[Callable[[], Any]]) -> list[Any]:
    """All at once; what one raises is raised."""
    results: list[Any] = [None] * len(calls)
    start = threading.Barrier(len(calls))

    def run(k: int) -> None:
        start.wait()
        try:
            results[k] = calls[k]()
        except BaseException as error:
            results[k] = error

    workers = [threading.Thread(target=run, args=(k,)) for k in range(len(calls))]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    for result in results:
        if isinstance(result, BaseException):
            raise result
    return results


def test_the_first_call_from_several_threads(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RTTRR_PIN_CACHE", "")
    robot = Robot(rttrr.model)
    states = [some((40,), seed=k) for k in range(6)]
    results = in_threads([lambda state=state: robot.compile("tau")(*state) for state in states])
    for state, result in zip(states, results, strict=True):
        np.testing.assert_array_equal(result, rttrr.compile("tau")(*state))


def test_different_robots_compiled_at_the_same_time(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RTTRR_PIN_CACHE", "")
    robots = [Robot(rttrr.model.with_gravity(np.array([0, 0, -g]))) for g in (1.0, 2.0, 3.0)]
    results = in_threads([lambda robot=robot: robot.compile("gravity_torque")(ZERO + 0.3) for robot in robots])
    for robot, result in zip(robots, results, strict=True):
        assert norm_error(result, recursion(robot, ZERO + 0.3, ZERO, ZERO).tau) <= ROUNDING


def test_calls_at_the_same_time_do_not_meet(rttrr: Robot) -> None:
    """Batches on several threads each, single states between them, payloads that compile on the way."""
    made = Robot(rttrr.model).compile("tau")
    large, one = some((2 * PART + 3,)), some(())
    expected, alone = made(*large, threads=1), made(*one)
    payload = Wrench((1.0, 2.0, 3.0))

    def single() -> np.ndarray:
        out = np.empty(5)
        for _ in range(500):
            made(*one, out=out)
        return out

    calls = [lambda: made(*large, threads=2), single, lambda: made(*one, payload=payload)] * 3
    for k, result in enumerate(in_threads(calls)):
        np.testing.assert_array_equal(result, (expected, alone, made(*one, payload=payload))[k % 3])


FORKED = """
import os, sys
import numpy as np
from rttrr_pin import Robot
from rttrr_pin.core.joints import REVOLUTE
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.model import Link, Model

link = Link("a", 2.0, np.array([0.1, 0.2, 0.3]), np.diag([1.0, 2.0, 2.5]))
robot = Robot(Model("one", Link("base"), (link,), (Joint("j", REVOLUTE, axis=np.array([0.0, 1.0, 0.0])),)))
state = np.random.default_rng(0).uniform(-1, 1, (3, 2 * 8192 + 5, 1))
expected = robot.compile("tau")(*state, threads=2)
child = os.fork()
if child == 0:
    same = np.array_equal(robot.compile("tau")(*state, threads=2), expected)
    os._exit(0 if same and robot.mass_matrix(state[0]).shape == (2 * 8192 + 5, 1, 1) else 1)
assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
assert np.array_equal(robot.compile("tau")(*state, threads=2), expected)
"""


def test_a_forked_process_computes_on_threads_of_its_own() -> None:
    subprocess.run([sys.executable, "-c", FORKED], check=True, timeout=600)


def calls_of(made: Kernel) -> dict[str, Callable[[], Any]]:
    state, single, out = some((3,)), some(()), np.empty(5)
    nan = np.full(5, np.nan)

    def fails() -> None:
        try:
            made(nan, *single[1:], out=out)
        except NumberError:
            return
        raise AssertionError

    return {
        "batch": lambda: made(*state),
        "state": lambda: made(*single),
        "short-cut": lambda: made(*single, out=out),
        "declined-short-cut": lambda: made([0.0] * 5, *single[1:], out=out),
        "strided-out": lambda: made(*single, out=out[::-1]),
        "payload": lambda: made(*single, payload=Wrench((1, 2, 3))),
        "error": fails,
    }


@pytest.mark.slow
@pytest.mark.parametrize("case", slow_but(("batch", "payload", "error"), calls_of(None)))  # type: ignore[arg-type]
def test_calls_leave_nothing_behind(rttrr: Robot, case: str) -> None:
    """No reference to an argument, to None or to True, and no memory that grows with the count of calls."""
    made = rttrr.compile("tau")
    call = calls_of(made)[case]
    watched = [cell.cell_contents for cell in call.__closure__ or ()] + [None, True]
    count, references, growth = 200, [], []
    for _ in range(50):
        call()
    tracemalloc.start()
    try:
        for _ in range(4):  # caches of others grow now and then; what a call leaves behind, every round leaves behind
            gc.collect()
            before, memory = [sys.getrefcount(x) for x in watched], tracemalloc.get_traced_memory()[0]
            for _ in range(count):
                call()
            gc.collect()
            after = [sys.getrefcount(x) for x in watched]
            growth.append(tracemalloc.get_traced_memory()[0] - memory)
            references.append(max(abs(x - y) for x, y in zip(before, after, strict=True)))
    finally:
        tracemalloc.stop()
    assert min(references) < count // 10
    assert min(growth) < 8 * count


@pytest.mark.parametrize("outputs", ["tau", ("tau", "f"), "mass_matrix", "nonlinear_effects"], ids=str)
@pytest.mark.parametrize("wrench", [None, Wrench((1, 2, 3), expressed_in="base")], ids=["free", "payload"])
def test_calling_at_once_and_in_general_are_one(rttrr: Robot, outputs: Any, wrench: Wrench | None) -> None:
    """What compiled code answers itself, and what Python code prepares: the same bits."""
    kernel = Robot(rttrr.model).compile(outputs)
    arrays = dict(zip(QUANTITIES[kernel.outputs[0]].inputs, some(()), strict=False))
    if wrench is not None and not QUANTITIES[kernel.outputs[0]].payload:
        with pytest.raises(InputError):
            kernel(**arrays, payload=wrench)
        return
    first = kernel(**{name: x.tolist() for name, x in arrays.items()}, payload=wrench)  # type: ignore[arg-type]
    at_once = kernel._at_once(*(arrays.get(name) for name in "qva"), wrench, None)
    assert at_once is not None
    batch = {name: np.tile(x, (3, 1)) for name, x in arrays.items()}
    for again in (at_once, kernel(**arrays, payload=wrench), kernel(**arrays, payload=wrench, out=at_once)):
        np.testing.assert_equal(again, first)
    for again in (kernel(**batch, payload=wrench), kernel(**batch, payload=wrench, threads=2)):
        last = {name: x[2] for name, x in again.items()} if isinstance(again, dict) else again[2]
        np.testing.assert_equal(last, first)


def test_a_payload_is_the_one_of_this_call(rttrr: Robot) -> None:
    kernel = Robot(rttrr.model).compile("n")
    one, other = Wrench((1, 2, 3)), Wrench((1, 2, 4))
    expected = [kernel(*some(()), payload=[wrench]) for wrench in (one, other)]
    for _ in range(2):
        for wrench, n in zip((one, other), expected, strict=True):
            np.testing.assert_array_equal(kernel(*some(()), payload=wrench), n)


def test_a_wrench_never_changes(rttrr: Robot) -> None:
    force = np.array([1.0, 2.0, 3.0])
    wrench = Wrench(force)
    force[0] = np.nan
    assert np.isfinite(rttrr.compile()(*some(()), payload=wrench)).all()
    with pytest.raises(ValueError, match="read-only"):
        wrench.force[0] = 2.0  # type: ignore[index]


def test_a_kernel_that_no_one_holds_is_freed(rttrr: Robot) -> None:
    kernel = Robot(rttrr.model).compile("tau")
    kernel(*np.zeros((3, 5)))
    gone = weakref.ref(kernel)
    del kernel
    gc.collect()
    assert gone() is None
