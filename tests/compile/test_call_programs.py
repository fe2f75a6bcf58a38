"""Kernels of robots too large for straight lines: each step of the recursion compiled once, and called."""

from __future__ import annotations

import struct
import threading
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import LinkWrenches, Robot, Wrench
from rttrr_pin.compile import Kernel, build, cache
from rttrr_pin.compile.call_program import CallProgram
from rttrr_pin.compile.emit import EMITTERS, emitter, llvm_module
from rttrr_pin.compile.expression import Graph, Node
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.outlining import Outliner
from rttrr_pin.compile.program import Program
from rttrr_pin.compile.quantities import QUANTITIES
from rttrr_pin.compile.register_allocation import arranged
from rttrr_pin.compile.trace import trace
from rttrr_pin.core.joint import JointEffects
from rttrr_pin.errors import InputError, NumberError
from rttrr_pin.implementations import Batch
from rttrr_pin.validation import Sampler
from support.programs import evaluate_calls
from support.recursion import recursion
from support.serial_chains import random_chain
from support.slow import slow_after
from support.tolerances import ROUNDING, norm_error
from support.trees import random_tree

FIVE = ("tau", "F", "N", "f", "n", "tau_joint")

BY_CALLS = [name for name in EMITTERS if emitter(name).calls]

OF_STEPS = tuple(name for name, quantity in QUANTITIES.items() if quantity.by_steps)


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "kernels"))


def forced(robot: Robot, outputs: str | Sequence[str], emitter: str | None = None) -> Kernel:
    """Calls of steps also for a robot that is small."""
    return Kernel(robot.model, outputs, emitter, straight_line=0)


def chain(joints: int) -> Robot:
    return rttrr_pin.load(random_chain(joints, ("revolute",) * joints))


def states(robot: Robot, seed: int, count: int = 37) -> Batch:
    return Sampler(robot.model, "mixed", seed).draw(0, count)


def payload(robot: Robot) -> list[Wrench]:
    first, last = robot.link_names[0], robot.link_names[-1]
    return [
        Wrench((1, 2, 3), (4, 5, 6), last, "base"),
        Wrench((-3, 1, 2), (0, 7, 1), first),
        Wrench((0, 0, 9), link=last),
    ]


def assert_equal(ours: dict[str, np.ndarray], theirs: LinkWrenches) -> None:
    for name, x in ours.items():
        y = getattr(theirs, name)
        for one, other in zip(x, y, strict=True):
            assert norm_error(one, other) <= ROUNDING, name


@pytest.mark.one_in(4)
@pytest.mark.parametrize("by", BY_CALLS)
@pytest.mark.parametrize("base", ["fixed", "floating"])
@pytest.mark.parametrize("seed", slow_after(1, range(4)))
def test_trees_of_all_joints_followers_drives_and_payloads(seed: int, base: str, by: str) -> None:
    robot = rttrr_pin.load(random_tree(seed, 12), base=base, friction=True)  # type: ignore[arg-type]
    names = [joint.name for joint in robot.model.joints if joint.nv]
    robot = robot.with_joint_effects({names[0]: JointEffects(armature=0.7), names[-1]: JointEffects(0.2, 0.3, 0.4)})
    s = states(robot, seed)
    for wrenches in (None, payload(robot)):
        ours = forced(robot, FIVE, by)(s.q, s.v, s.a, payload=wrenches)
        assert_equal(ours, recursion(robot, s.q, s.v, s.a, wrenches))


@pytest.mark.one_in(9)
@pytest.mark.parametrize("seed", slow_after(1, range(2)))
@pytest.mark.parametrize("name", OF_STEPS)
def test_each_output_alone_is_that_of_straight_lines(name: str, seed: int) -> None:
    robot = rttrr_pin.load(random_tree(seed, 7), friction=True)
    s = states(robot, seed)
    given = [getattr(s, x) for x in QUANTITIES[name].inputs]
    straight = Kernel(robot.model, name, straight_line=10**9)
    for x, y in zip(forced(robot, name)(*given), straight(*given), strict=True):
        assert norm_error(x, y) <= ROUNDING


def test_any_robot_of_the_shared_fixture(robot: Robot) -> None:
    """Fixed joints at any place, no joint that moves, one joint; what is called is the same by each emitter."""
    s = states(robot, 1)
    ours = forced(robot, FIVE, "numpy")(s.q, s.v, s.a)
    assert_equal(ours, recursion(robot, s.q, s.v, s.a))


def test_a_long_chain_takes_calls_by_itself_and_is_not_traced_to_its_end(monkeypatch: pytest.MonkeyPatch) -> None:
    limits, made = [], list[CallProgram]()
    whole, calls = build.trace, build.call_program
    monkeypatch.setattr(build, "trace", lambda *words, most: limits.append(most) or whole(*words, most=most))
    monkeypatch.setattr(build, "call_program", lambda *words, **more: made.append(calls(*words, **more)) or made[-1])
    robot = chain(250)
    s = states(robot, 0, 20)
    tau = robot.compile("tau")(s.q, s.v, s.a)
    assert limits == [build.NODES * build.STRAIGHT_LINE]
    assert [type(program) for program in made] == [CallProgram]
    for ours, reference in zip(tau, recursion(robot, s.q, s.v, s.a).tau, strict=True):
        assert norm_error(ours, reference) <= ROUNDING


def test_the_threshold_counts_operations() -> None:
    model = chain(12).model
    count = trace(model, ["tau"]).operations.total
    assert isinstance(build.build(model, ["tau"], straight_line=count), Program)
    assert isinstance(build.build(model, ["tau"], straight_line=count - 1), CallProgram)


def test_what_is_no_sequence_of_steps_stays_straight_until_it_is_too_long(
    rttrr: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert isinstance(build.build(rttrr.model, ["tau", "regressor"], straight_line=0), Program)
    monkeypatch.setattr(build, "LONGEST", 100)
    with pytest.raises(InputError, match="^regressor of robot 'rttrr' with 5 degrees of freedom: .* more than 100"):
        rttrr_pin.load("rttrr").compile(("tau", "regressor"))(np.zeros(5), np.zeros(5), np.zeros(5))


def test_bounds_count_among_what_is_too_long(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    """They make a program some times as long."""
    nodes = len(trace(rttrr.model, ["tau"]).graph)
    monkeypatch.setattr(build, "LONGEST", 2 * nodes)
    assert isinstance(build.build(rttrr.model, ["tau"], straight_line=None), Program)
    with pytest.raises(InputError, match="^tau of robot 'rttrr' with 5 degrees of freedom: "):
        build.build(rttrr.model, ["tau", "tau_bound"])


def test_emitters_that_know_no_calls_get_straight_lines(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    assert set(BY_CALLS) == {"llvm", "numpy"}
    monkeypatch.setattr(build, "call_program", None)
    monkeypatch.setattr(type(emitter("numpy")), "calls", False)
    s = states(rttrr, 0)
    assert norm_error(forced(rttrr, "tau", "numpy")(s.q, s.v, s.a), recursion(rttrr, s.q, s.v, s.a).tau) <= ROUNDING


@lru_cache
def called(joints: int) -> CallProgram:
    return build.call_program(chain(joints).model, ["tau"])


def test_code_does_not_grow_with_the_robot() -> None:
    """The table of calls does, by as much for each joint; the operations that are compiled stay the same."""
    programs = [called(joints) for joints in (30, 60, 120)]
    operations = [[step.program.operations for step in program.steps] for program in programs]
    assert operations[0] == operations[1] == operations[2]
    assert sum(step.total for step in operations[0]) > 100
    calls = [len(program.calls) for program in programs]
    assert calls[2] - calls[1] == 2 * (calls[1] - calls[0])


def test_columns_are_used_again() -> None:
    """What lies between inputs and outputs: R, f and n of each link, and little else."""
    small, large = called(60), called(120)
    assert (large.between - small.between) / 60 <= 9 + 3 + 3


@pytest.mark.one_in(3)
@pytest.mark.parametrize("size", [1, 8, 64])
def test_the_same_bits_in_any_block_layout_or_thread(size: int, monkeypatch: pytest.MonkeyPatch) -> None:
    robot = rttrr_pin.load(random_tree(3, 12), friction=True)
    s = states(robot, 0, 9000)
    kernel = forced(robot, FIVE)
    batch = kernel(s.q, s.v, s.a)
    monkeypatch.setattr(llvm_module, "SECOND_LEVEL", 8 * size * build.call_program(robot.model, FIVE).columns)
    monkeypatch.setenv(cache.VARIABLE, "")
    blocked = forced(robot, FIVE)(s.q, s.v, s.a, threads=2)
    columns = kernel(*(np.asfortranarray(x) for x in (s.q, s.v, s.a)))
    for name, x in batch.items():
        np.testing.assert_array_equal(x, blocked[name])
        np.testing.assert_array_equal(x, columns[name])
    for k in (0, 1, 4095, 8999):
        out = {name: np.empty(x.shape[1:]) for name, x in batch.items()}
        kernel(s.q[k], s.v[k], s.a[k], out=out)
        one = kernel(s.q[k], s.v[k], s.a[k])
        for name, x in batch.items():
            np.testing.assert_array_equal(x[k], out[name])
            np.testing.assert_array_equal(x[k], one[name])


MIXED = random_tree(8, 10)

FLOATING = random_tree(8, 6, ("floating", "revolute"))
"""Where the floating base is changes no force, where a floating joint is does."""


@pytest.mark.one_in(2)
@pytest.mark.parametrize("by", BY_CALLS)
@pytest.mark.parametrize(("text", "base"), [(MIXED, "fixed"), (FLOATING, "floating")])
def test_every_number_that_is_not_finite_is_named(text: str, base: str, by: str) -> None:
    """Also of joints that move no link with a mass, and of coordinates that no output depends on."""
    robot = rttrr_pin.load(text, base=base, friction=True)  # type: ignore[arg-type]
    kernel = forced(robot, "tau", by)
    s = states(robot, 0, 3)
    quaternion = {i for i, name in enumerate(robot.model.q_names) if ".q" in name}
    for name in "qva":
        for column in range(getattr(s, name).shape[1]):
            if name == "q" and column in quaternion:
                continue  # looked at before
            given = {key: getattr(s, key).copy() for key in "qva"}
            given[name][2, column] = np.nan
            with pytest.raises(NumberError, match=f"^{name}"):
                kernel(**given)


def test_an_input_that_only_results_without_use_depend_on_is_unread() -> None:
    """A step has all results that some call needs; another call may not need them all."""
    outliner = Outliner(Graph())
    a, b, c, d = (Node(outliner.graph, outliner.graph.input(place)) for place in range(4))

    def step(x: Node, y: Node) -> tuple[Node, Node]:
        return x + x, y * y

    (first, second), (third, _) = outliner.call(step, a, b), outliner.call(step, c, d)
    fields = (Field("x", (4,)),), (Field("y", (3,)),)
    call_program = arranged(outliner, [x.number for x in (first, second, third)], *fields)
    assert len(call_program.calls) == 2
    assert call_program.unread == (3,)
    assert evaluate_calls(call_program, [np.array(x) for x in (1.0, 2.0, 3.0, 4.0)]) == [2.0, 4.0, 6.0]


def test_what_comes_from_disk_is_the_same(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    """And straight lines are told from calls."""
    s = states(rttrr, 0)
    first = forced(rttrr, "tau")(s.q, s.v, s.a)
    monkeypatch.setattr(build, "call_program", None)
    np.testing.assert_array_equal(forced(rttrr, "tau")(s.q, s.v, s.a), first)
    straight = Kernel(rttrr.model, "tau")(s.q, s.v, s.a)
    assert norm_error(straight, first) <= ROUNDING
    assert len(list((cache.folder() or Path()).glob("*.kernel"))) == 2


@pytest.mark.one_in(4)
@pytest.mark.parametrize("text", [b".L", b'"', b"\\", b"\n", b".section"], ids=str)
def test_numbers_whose_bytes_read_like_assembly_stay_what_they_are(rttrr: Robot, text: bytes) -> None:
    """The table of numbers goes through assembly, in which bytes stand as text; labels there get other names."""
    (mass,) = struct.unpack("<d", text[:6].rjust(6, b"\0") + b"\xf0\x3f")
    model = rttrr.model
    model = replace(model, links=tuple(replace(link, mass=mass) if link.mass else link for link in model.links))
    s = states(rttrr, 0)
    by_calls, straight = (Kernel(model, "tau", straight_line=longest)(s.q, s.v, s.a) for longest in (0, 10**6))
    assert norm_error(by_calls, straight) <= ROUNDING


@pytest.mark.slow
def test_a_block_that_is_too_large_for_the_stack_is_allocated() -> None:
    """One block of 600 joints takes a megabyte, the stack of a thread may be smaller."""
    robot = chain(600)
    s = states(robot, 0, 2)
    kernel = robot.compile("tau")
    tau = kernel(s.q, s.v, s.a)
    assert norm_error(tau, recursion(robot, s.q, s.v, s.a).tau) <= ROUNDING
    again = np.empty_like(tau)
    before = threading.stack_size(256 * 1024)
    try:
        thread = threading.Thread(target=lambda: [kernel(s.q[k], s.v[k], s.a[k], out=again[k]) for k in range(2)])
        thread.start()
        thread.join()
    finally:
        threading.stack_size(before)
    np.testing.assert_array_equal(again, tau)
