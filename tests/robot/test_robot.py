"""The Python API: shapes, batch axes, names, and every error message."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Robot, RttrrError, Wrench
from rttrr_pin.core.payload import loads_of
from rttrr_pin.errors import InputError, MissingJointError, NumberError, ShapeError, UnknownNameError
from support.inputs import BAD, JOINTS, PAYLOADS, ZERO, some
from support.recursion import recursion
from support.tolerances import ROUNDING, norm_error


@pytest.mark.parametrize("batch", [(), (1,), (3,), (2, 3), (0,), (2, 0), (1, 1, 1)], ids=str)
def test_outputs_follow_the_batch_axes(rttrr: Robot, batch: tuple[int, ...]) -> None:
    result = rttrr.inverse_dynamics(*some(batch))
    assert result.tau.shape == (*batch, 5)
    for key in ("F", "N", "f", "n"):
        assert getattr(result, key).shape == (*batch, 6, 3)


@pytest.mark.parametrize("rows", [1, 2, 7, 64, 65, 9000])
def test_a_state_gives_the_same_bits_in_any_batch(rttrr: Robot, rows: int) -> None:
    """Alone, in a block of any length, first or last, on several threads."""
    q, v, a = some((rows,), seed=rows)
    payload = Wrench((1.0, 2.0, 3.0), (0.1, 0.2, 0.3), expressed_in="base")
    together = rttrr.inverse_dynamics(q, v, a, payload)
    for k in {0, rows // 2, rows - 1}:
        alone = rttrr.inverse_dynamics(q[k], v[k], a[k], payload)
        for key, x in alone.items():
            np.testing.assert_array_equal(x, getattr(together, key)[k])


def test_it_is_the_recursion_within_rounding(rttrr: Robot) -> None:
    q, v, a = some((99,))
    wrench = Wrench((1.0, 2.0, 3.0), (0.1, 0.2, 0.3), expressed_in="base")
    reference = recursion(rttrr, q, v, a, loads_of(rttrr.model, wrench))
    for key, x in rttrr.inverse_dynamics(q, v, a, wrench).items():
        assert norm_error(x, getattr(reference, key)) <= ROUNDING


def test_leading_axes_broadcast(rttrr: Robot) -> None:
    q, v, a = some((4, 3))
    wide = rttrr.inverse_dynamics(q[:, :1], v[:1], a, Wrench(np.ones((3, 3))))
    for i, k in np.ndindex(4, 3):
        one = rttrr.inverse_dynamics(q[i, 0], v[0, k], a[i, k], Wrench(np.ones(3)))
        np.testing.assert_array_equal(wide.n[i, k], one.n)


def test_strided_and_read_only_arrays_are_taken(rttrr: Robot) -> None:
    q, v, a = some((6,))
    strided = np.repeat(q, 2, axis=1)[:, ::2]
    strided.setflags(write=False)
    np.testing.assert_array_equal(rttrr.inverse_dynamics(strided, v, a).tau, rttrr.inverse_dynamics(q, v, a).tau)


def test_float32_is_taken_up_to_float64(rttrr: Robot) -> None:
    """The computation is in float64 from the first operation on."""
    q, v, a = (x.astype(np.float32) for x in some((8,)))
    wide = rttrr.inverse_dynamics(q.astype(np.float64), v.astype(np.float64), a.astype(np.float64))
    result = rttrr.inverse_dynamics(q, v, a)
    assert result.tau.dtype == np.float64
    np.testing.assert_array_equal(result.n, wide.n)


def test_integers_and_lists_are_taken(rttrr: Robot) -> None:
    ints = rttrr.inverse_dynamics([0, 1, 0, 1, 0], [1] * 5, np.ones(5, dtype=np.uint8))
    floats = rttrr.inverse_dynamics([0.0, 1.0, 0.0, 1.0, 0.0], [1.0] * 5, np.ones(5))
    np.testing.assert_array_equal(ints.f, floats.f)


def test_a_dict_by_joint_name_is_taken_in_any_order(rttrr: Robot) -> None:
    q, v, a = some((4,))
    as_dict = {name: q[:, j] for j, name in reversed(list(enumerate(JOINTS)))}
    np.testing.assert_array_equal(rttrr.inverse_dynamics(as_dict, v, a).tau, rttrr.inverse_dynamics(q, v, a).tau)


def test_dict_entries_broadcast(rttrr: Robot) -> None:
    q = dict.fromkeys(JOINTS, 0.1) | {"joint_4": np.linspace(0, 1, 3)}
    assert rttrr.inverse_dynamics(q, ZERO, ZERO).tau.shape == (3, 5)


def test_results_are_read_by_name(rttrr: Robot) -> None:
    result = rttrr.inverse_dynamics(*some((2,)))
    np.testing.assert_array_equal(result.at("link_3")["n"], result.n[:, 2])
    np.testing.assert_array_equal(result.at("joint_2")["tau"], result.tau[:, 1])
    np.testing.assert_array_equal(result[1].f, result.f[1])
    with pytest.raises(UnknownNameError, match="link_3"):
        result.at("link3")


@pytest.mark.one_in(4)
def test_tau_is_the_component_along_the_axis(robot: Robot) -> None:
    rng = np.random.default_rng(0)
    q, v, a = rng.uniform(-1, 1, (3, 10, robot.model.nv))
    result = robot.inverse_dynamics(q, v, a)
    for column, joint in enumerate(robot.model.moving):
        i = robot.model.joints.index(joint)
        whole = result.n[:, i] if joint.type.rotates else result.f[:, i]
        assert norm_error(result.tau[:, column], whole @ joint.axis) <= ROUNDING


def test_the_tool_hands_on_the_payload(rttrr: Robot) -> None:
    """f_6, n_6 are the payload, equation (8)."""
    result = rttrr.inverse_dynamics(*some((3,)), Wrench((1, 2, 3), (4, 5, 6)))
    assert (result.at("tool")["f"] == [1, 2, 3]).all()
    assert (result.at("tool")["n"] == [4, 5, 6]).all()


def test_one_state_has_no_batch_axis_to_index(rttrr: Robot) -> None:
    with pytest.raises(ShapeError, match="of one state and has no batch axis"):
        rttrr.inverse_dynamics(ZERO, ZERO, ZERO)[0]


def test_repr_names_the_joints(rttrr: Robot) -> None:
    assert "joint_3 (prismatic)" in repr(rttrr)


@pytest.mark.parametrize("name", ["q", "v", "a"])
@pytest.mark.parametrize("case", BAD)
def test_bad_coordinates_are_named_with_joint_and_index(rttrr: Robot, case: str, name: str) -> None:
    values, error, message = BAD[case]
    arguments: dict[str, Any] = {"q": ZERO, "v": ZERO, "a": ZERO} | {name: values}
    pattern = f"^{name}" + message[1:] if message.startswith("q") else message
    with pytest.raises(error, match=pattern) as caught:
        rttrr.inverse_dynamics(**arguments)
    assert isinstance(caught.value, ValueError)


def test_errors_carry_their_facts(rttrr: Robot) -> None:
    with pytest.raises(NumberError) as number:
        rttrr.inverse_dynamics([[0, 0, 0, 0, 0], [0, np.inf, 0, 0, 0]], ZERO, ZERO)
    assert (number.value.name, number.value.joint, number.value.index) == ("q", "joint_2", (1, 1))
    with pytest.raises(ShapeError) as shape:
        rttrr.inverse_dynamics(np.zeros((2, 3)), ZERO, ZERO)
    assert (shape.value.name, shape.value.got) == ("q", (2, 3))
    with pytest.raises(MissingJointError) as missing:
        rttrr.inverse_dynamics({"joint_1": 0.0}, ZERO, ZERO)
    assert missing.value.missing == JOINTS[1:]


def test_batches_that_do_not_broadcast_are_an_error(rttrr: Robot) -> None:
    with pytest.raises(ShapeError, match=r"q: \(2,\), v: \(3,\)"):
        rttrr.inverse_dynamics(np.zeros((2, 5)), np.zeros((3, 5)), ZERO)
    with pytest.raises(ShapeError, match="payload force"):
        rttrr.inverse_dynamics(np.zeros((2, 5)), ZERO, ZERO, Wrench(np.zeros((3, 3))))


@pytest.mark.parametrize("case", PAYLOADS)
def test_bad_payloads_are_errors(rttrr: Robot, case: str) -> None:
    payload, error, message = PAYLOADS[case]
    with pytest.raises(error, match=message):
        rttrr.inverse_dynamics(ZERO, ZERO, ZERO, payload)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (((0, 0),), ShapeError, "payload force has 2 values"),
        ((3.0,), ShapeError, "payload force is a single number"),
        (((0, 0, 0), (0, np.nan, 0)), NumberError, r"payload moment\[1\] is nan"),
    ],
)
def test_bad_wrenches_are_errors_at_once(arguments: Any, error: type[RttrrError], message: str) -> None:
    with pytest.raises(error, match=message):
        Wrench(*arguments)


def test_payload_axes_are_link_or_base() -> None:
    with pytest.raises(InputError, match="expected 'link'.*or 'base'"):
        Wrench((0, 0, 0), expressed_in="world")  # type: ignore[arg-type]


def test_overflow_names_the_state(rttrr: Robot) -> None:
    v = np.zeros((3, 5))
    v[1, 0] = 1e200
    with pytest.raises(NumberError, match=r"overflows in state 1, where \|v\| reaches 1e\+200"):
        rttrr.inverse_dynamics(np.ones((3, 5)), v, v * 0)


@pytest.mark.parametrize(
    ("gravity", "error"),
    [(9.81, ShapeError), ((0, 0), ShapeError), ((0, 0, np.nan), NumberError), (np.zeros((2, 3)), ShapeError)],
)
def test_gravity_is_a_vector(gravity: Any, error: type[RttrrError]) -> None:
    with pytest.raises(error, match="gravity"):
        rttrr_pin.load("rttrr", gravity=gravity)


def test_mapping_types_other_than_dict_are_taken(rttrr: Robot) -> None:
    class Table(Mapping[str, float]):
        def __getitem__(self, key: str) -> float:
            return 0.5

        def __iter__(self) -> Any:
            return iter(JOINTS)

        def __len__(self) -> int:
            return 5

    np.testing.assert_array_equal(
        rttrr.inverse_dynamics(Table(), ZERO, ZERO).tau, rttrr.inverse_dynamics(ZERO + 0.5, ZERO, ZERO).tau
    )


@pytest.mark.parametrize("outputs", [None, 3, {"tau": 1}, [["tau"]]], ids=repr)
def test_outputs_that_are_no_names_are_told(rttrr: Robot, outputs: Any) -> None:
    with pytest.raises(InputError, match="pass a name, or several"):
        rttrr.compile(outputs)


def test_effects_that_are_no_dict_are_told(rttrr: Robot) -> None:
    with pytest.raises(InputError, match="pass a dict from joint name to JointEffects"):
        rttrr.with_joint_effects(None)  # type: ignore[arg-type]
