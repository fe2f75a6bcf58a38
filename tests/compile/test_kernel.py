"""The compiled kernel as a user calls it: the numbers of the reference, its outputs, copies, threads and processes."""

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
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import JointEffects, Robot, RttrrError, Wrench
from rttrr_pin.compile import QUANTITIES, Kernel
from rttrr_pin.core.wrench import RESULTS
from rttrr_pin.errors import InputError, NumberError, UnknownNameError
from rttrr_pin.validation import Sampler
from support.inputs import ZERO, some
from support.recursion import recursion
from support.slow import slow_but
from support.tolerances import ROUNDING, norm_error
from support.trees import random_tree

PART = 8192


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


@pytest.mark.one_in(2)
def test_the_specifications_numbers(robot: Robot) -> None:
    agree(robot, RESULTS)
    agree(robot, "tau", emitter="numpy")


@pytest.mark.parametrize("outputs", ["tau", RESULTS], ids=["tau", "all"])
@pytest.mark.parametrize(("seed", "joints", "base"), [(1, 5, "floating"), (5, 9, "fixed")], ids=str)
def test_trees_with_every_joint_type_followers_and_friction(seed: int, joints: int, base: Any, outputs: Any) -> None:
    agree(tree(seed, joints, base), outputs, seed=seed)


@pytest.mark.one_in(2)
@pytest.mark.parametrize("seed", range(8))
def test_many_trees_by_the_emitter_that_compiles_nothing(seed: int) -> None:
    """The same program, lumped and folded, without the compiler's time."""
    for base in ("fixed", "floating"):
        agree(tree(seed, 2 + 2 * seed, base), "tau", seed=seed, emitter="numpy")


def test_drives_enter_tau_and_not_the_bearings(rttrr: Robot) -> None:
    robot = rttrr.with_joint_effects({"joint_2": JointEffects(3.0, 2.0, 5.0), "joint_5": JointEffects(armature=0.1)})
    agree(robot, RESULTS)


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


@pytest.mark.one_in(2)
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


@pytest.mark.slow
def test_all_outputs_at_once_in_the_order_asked_for(rttrr: Robot) -> None:
    names = tuple(reversed(QUANTITIES))
    state = some((70,))
    together = rttrr.compile(names)(*state)
    assert tuple(together) == names
    reference = recursion(rttrr, *state)
    for name in RESULTS:
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
    "number": ((3,), InputError, "pass a name, or several"),
}


@pytest.mark.parametrize("case", BAD_OUTPUTS)
def test_bad_outputs(rttrr: Robot, case: str) -> None:
    outputs, error, message = BAD_OUTPUTS[case]
    with pytest.raises(error, match=message):
        rttrr.compile(outputs)


def test_unknown_emitter(rttrr: Robot) -> None:
    with pytest.raises(UnknownNameError, match=r"no emitter is called 'fortran': .*llvm, numpy, c"):
        rttrr.compile("tau", emitter="fortran")


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
