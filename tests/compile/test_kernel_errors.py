"""What a kernel refuses: each error names the argument, and the joint and state where there are such."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import JointEffects, Robot, RttrrError, Wrench
from rttrr_pin.compile import QUANTITIES, Kernel
from rttrr_pin.errors import InputError, NumberError, ShapeError
from support.inputs import BAD, JOINTS, PAYLOADS, ZERO, some
from support.serial_chains import EXAMPLES
from support.slow import slow_after

BLOCK = 64
PART = 8192


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


@pytest.mark.one_in(6)
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
