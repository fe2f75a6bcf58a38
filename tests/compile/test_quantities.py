"""Mass matrix, nonlinear effects, gravity, regressor, derivatives: against Pinocchio, and against the laws they obey."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import rttrr_pin
from rttrr_pin import JointEffects, Robot, Wrench
from rttrr_pin.compile import QUANTITIES
from rttrr_pin.core.joints import CONTINUOUS, FLOATING, PLANAR
from rttrr_pin.errors import InputError
from rttrr_pin.validation import Sampler
from support.recursion import recursion
from support.serial_chains import inertial, joint, random_chain
from support.slow import slow_but
from support.tolerances import DIFFERENCES, EPS, ROUNDING, norm_error
from support.trees import random_tree

STATES = 12
DERIVATIVES = ("dtau_dq", "dtau_dv", "dtau_da")
NAMES = ("tau", "mass_matrix", "nonlinear_effects", "gravity_torque", "regressor", *DERIVATIVES)
BUNDLED = ("rttrr", "trr", "trtr", "trtrr", "trttr")
ONE_AXIS = ("revolute", "continuous", "prismatic")

ROBOTS: dict[str, tuple[str, Any]] = {
    **{name: (name, "fixed") for name in BUNDLED},
    "rttrr-floating": ("rttrr", "floating"),
    "tree-of-axes": (random_tree(1, 4, ONE_AXIS, mimics=False), "fixed"),
    "tree-with-fixed-links": (random_tree(2, 5, (*ONE_AXIS, "fixed"), mimics=False), "fixed"),
    "floating-joints": (random_tree(3, 2, ("floating", "revolute"), mimics=False), "fixed"),
    "floating-tree": (random_tree(4, 3, (*ONE_AXIS, "fixed"), mimics=False), "floating"),
    "planar-joints": (random_tree(5, 2, ("planar", "continuous"), mimics=False), "fixed"),
    "planar-joint-on-a-floating-base": (random_tree(6, 1, ("planar",), mimics=False), "floating"),
}


COMPILED = ("rttrr", "floating-joints")
"""By LLVM; of the others the emitter that compiles nothing says the same, in a third of the time."""


@cache
def made(case: str) -> tuple[Robot, Any, dict[str, np.ndarray]]:
    """The robot, states, and every quantity at these."""
    source, base = ROBOTS[case]
    robot = rttrr_pin.load(source, base=base)
    drawn = Sampler(robot.model, "mixed", 1).draw(0, STATES)
    kernel = robot.compile(NAMES, "llvm" if case in COMPILED else "numpy")
    return robot, drawn, kernel(drawn.q, drawn.v, drawn.a)


@cache
def theirs(case: str) -> tuple[Any, np.ndarray]:
    """Pinocchio's model, and the same states in its coordinates."""
    robot, drawn, _ = made(case)
    floating = ROBOTS[case][1] == "floating"
    root = (pin.JointModelFreeFlyer(),) if floating else ()
    return pin.buildModelFromXML(robot.model.urdf, *root), pin_coordinates(robot, drawn.q)


def pin_coordinates(robot: Robot, q: np.ndarray) -> np.ndarray:
    """Angles of planar and continuous joints as cosine and sine."""
    columns: list[np.ndarray] = []
    at = 0
    for each in robot.model.moving:
        own = list(q[:, at : at + each.nq].T)
        at += each.nq
        if each.type in (CONTINUOUS, PLANAR):
            own = [*own[:-1], np.cos(own[-1]), np.sin(own[-1])]
        columns += own
    return np.stack(columns, axis=1)


@pytest.mark.one_in(2)
@pytest.mark.parametrize("case", slow_but(("rttrr", "trr", "floating-tree", "planar-joints"), ROBOTS))
def test_mass_matrix_is_pinocchios(case: str) -> None:
    _, _, ours = made(case)
    model, q = theirs(case)
    data = model.createData()
    for k in range(STATES):
        upper = np.triu(pin.crba(model, data, q[k]))
        assert norm_error(ours["mass_matrix"][k], upper + np.triu(upper, 1).T) <= ROUNDING


@pytest.mark.one_in(3)
@pytest.mark.parametrize("case", ROBOTS)
def test_mass_matrix_is_symmetric_to_the_last_bit_and_positive_definite(case: str) -> None:
    """Semidefinite where the floating link has no inertia of its own: then it turns with the first joint for nothing."""
    robot, _, ours = made(case)
    M = ours["mass_matrix"]
    np.testing.assert_array_equal(M, M.swapaxes(-1, -2))
    least, most = np.moveaxis(np.linalg.eigvalsh(M), -1, 0)[[0, -1]]
    if robot.model.links[0].mass:
        assert (least > 0.0).all()
    else:
        assert (least > -ROUNDING * most).all()


@pytest.mark.one_in(3)
@pytest.mark.parametrize("case", ROBOTS)
def test_nonlinear_effects_and_gravity_are_pinocchios(case: str) -> None:
    _, drawn, ours = made(case)
    model, q = theirs(case)
    data = model.createData()
    effects = [pin.nonLinearEffects(model, data, q[k], drawn.v[k]).copy() for k in range(STATES)]
    gravity = [pin.computeGeneralizedGravity(model, data, q[k]).copy() for k in range(STATES)]
    assert norm_error(ours["nonlinear_effects"], effects) <= ROUNDING
    assert norm_error(ours["gravity_torque"], gravity) <= ROUNDING


@pytest.mark.one_in(2)
@pytest.mark.parametrize("case", ROBOTS)
def test_tau_is_mass_matrix_times_acceleration_plus_nonlinear_effects(case: str) -> None:
    robot, drawn, ours = made(case)
    inertial_part = np.einsum("kij,kj->ki", ours["mass_matrix"], drawn.a)
    whole = np.linalg.norm(inertial_part) + np.linalg.norm(ours["nonlinear_effects"])
    tau = recursion(robot, drawn.q, drawn.v, drawn.a).tau
    assert np.linalg.norm(inertial_part + ours["nonlinear_effects"] - tau) <= ROUNDING * whole
    assert norm_error(ours["tau"], tau) <= ROUNDING


@pytest.mark.parametrize("case", ROBOTS)
def test_gravity_torque_is_what_holds_it_still(case: str) -> None:
    robot, drawn, ours = made(case)
    rest = np.zeros(robot.model.nv)
    assert norm_error(ours["gravity_torque"], recursion(robot, drawn.q, rest, rest).tau) <= ROUNDING


@pytest.mark.parametrize("case", ROBOTS)
def test_the_regressor_is_pinocchios(case: str) -> None:
    """Column by column where no link is fixed to another; Pinocchio merges those."""
    robot, drawn, ours = made(case)
    model, q = theirs(case)
    data = model.createData()
    Y = np.array(
        [pin.computeJointTorqueRegressor(model, data, q[k], drawn.v[k], drawn.a[k]).copy() for k in range(STATES)]
    )
    moving = [i for i, each in enumerate(robot.model.joints) if each.nv]
    if len(moving) == len(robot.model.joints):
        assert norm_error(ours["regressor"], Y) <= ROUNDING
        parameters = np.concatenate([inertia.toDynamicParameters() for inertia in list(model.inertias)[1:]])
        assert norm_error(robot.inertial_parameters(), parameters) <= ROUNDING
    else:
        ends = [10 * i + k for i in moving for k in range(10)]
        assert norm_error(ours["regressor"][..., ends], Y) <= ROUNDING


@pytest.mark.parametrize("case", ROBOTS)
def test_tau_is_linear_in_the_inertial_parameters(case: str) -> None:
    robot, drawn, ours = made(case)
    tau = recursion(robot, drawn.q, drawn.v, drawn.a).tau
    terms = np.abs(ours["regressor"]) @ np.abs(robot.inertial_parameters())
    error = np.linalg.norm(ours["regressor"] @ robot.inertial_parameters() - tau)
    assert error <= ROUNDING * np.linalg.norm(terms)


@pytest.mark.parametrize("case", ROBOTS)
def test_derivatives_are_pinocchios(case: str) -> None:
    """Along the tangent where a coordinate is no number: the twist of planar and floating joints is in their frame.

    At rest the derivative by the rates is 0, and rounding elsewhere: it is measured against inertia times 1/s.
    """
    _, drawn, ours = made(case)
    model, q = theirs(case)
    data = model.createData()
    for k in range(STATES):
        pin.computeRNEADerivatives(model, data, q[k], drawn.v[k], drawn.a[k])
        upper = np.triu(data.M)
        M = upper + np.triu(upper, 1).T
        for name, other in zip(DERIVATIVES, (data.dtau_dq, data.dtau_dv, M), strict=True):
            size = np.linalg.norm(other) + np.linalg.norm(M)
            assert np.linalg.norm(ours[name][k] - other) <= ROUNDING * size, name


@pytest.mark.parametrize("case", ROBOTS)
def test_derivatives_are_the_limits_of_differences(case: str) -> None:
    robot, drawn, ours = made(case)
    model, q = theirs(case)
    step = EPS ** (1 / 3)
    own = np.cumsum([0] + [each.nq for each in robot.model.moving])
    k = STATES - 1
    for name, by in zip(DERIVATIVES, ("q", "v", "a"), strict=True):
        moved = []
        for direction in step * np.eye(robot.model.nv):
            pair = []
            for sign in (1, -1):
                state = {"q": drawn.q[k], "v": drawn.v[k], "a": drawn.a[k]}
                if by == "q":
                    state["q"] = our_coordinates(robot, own, pin.integrate(model, q[k], sign * direction), drawn.q[k])
                else:
                    state[by] = state[by] + sign * direction
                pair.append(recursion(robot, **state).tau)
            moved.append((pair[0] - pair[1]) / (2 * step))
        size = np.linalg.norm(ours[name][k]) + np.linalg.norm(ours["tau"][k])
        assert np.linalg.norm(ours[name][k] - np.array(moved).T) <= DIFFERENCES * size, name


def our_coordinates(robot: Robot, own: np.ndarray, q: np.ndarray, near: np.ndarray) -> np.ndarray:
    """Back from cosine and sine, to the angle next to the one before."""
    values: list[float] = []
    at = 0
    for each, first in zip(robot.model.moving, own, strict=False):
        wide = each.type in (CONTINUOUS, PLANAR)
        part = list(q[at : at + each.nq + wide])
        at += each.nq + wide
        if wide:
            c, s = part[-2:]
            before = near[first + each.nq - 1]
            turn = np.arctan2(s * np.cos(before) - c * np.sin(before), c * np.cos(before) + s * np.sin(before))
            part = [*part[:-2], before + turn]
        elif each.type == FLOATING:
            part[3:] /= np.linalg.norm(part[3:])
        values += part
    return np.array(values)


@pytest.mark.parametrize("case", ROBOTS)
def test_the_derivative_by_acceleration_is_the_mass_matrix(case: str) -> None:
    ours = made(case)[2]
    assert norm_error(ours["dtau_da"], ours["mass_matrix"]) <= ROUNDING


# Followers, drives, payloads


@pytest.fixture(scope="module")
def driven() -> Robot:
    """A chain whose first joint follows its last, with drives: one that Pinocchio has no words for."""
    text = random_chain(7, ("revolute", "prismatic", "revolute"))
    text = text.replace("</joint>", '<mimic joint="joint_3" multiplier="-1.5" offset="0.3"/></joint>', 1)
    return rttrr_pin.load(text).with_joint_effects(
        {"joint_3": JointEffects(0.7, 0.2, 0.5), "joint_1": JointEffects(0.3, 0.1)}
    )


@pytest.fixture(scope="module")
def of_driven(driven: Robot) -> tuple[Any, dict[str, np.ndarray]]:
    drawn = Sampler(driven.model, "mixed", 2).draw(0, STATES)
    return drawn, driven.compile((*NAMES, "tau_joint"))(drawn.q, drawn.v, drawn.a)


def test_followers_and_drives_enter_as_in_the_recursion(driven: Robot, of_driven: Any) -> None:
    drawn, ours = of_driven
    reference = recursion(driven, drawn.q, drawn.v, drawn.a)
    M, h = ours["mass_matrix"], ours["nonlinear_effects"]
    np.testing.assert_array_equal(M, M.swapaxes(-1, -2))
    np.linalg.cholesky(M)
    assert norm_error(np.einsum("kij,kj->ki", M, drawn.a) + h, reference.tau) <= ROUNDING
    assert norm_error(ours["regressor"] @ driven.inertial_parameters(), reference.tau - reference.tau_joint) <= ROUNDING
    assert norm_error(ours["tau_joint"], reference.tau_joint) <= ROUNDING
    assert norm_error(ours["dtau_da"], M) <= ROUNDING


def test_damping_has_a_derivative_and_friction_has_none(driven: Robot, of_driven: Any) -> None:
    drawn, ours = of_driven
    bare = Robot(driven.model.without_joint_effects()).compile(DERIVATIVES)(drawn.q, drawn.v, drawn.a)
    own = np.diag([0.0, 0.2 + 1.5**2 * 0.1])
    assert norm_error(ours["dtau_dv"], bare["dtau_dv"] + own) <= ROUNDING
    assert norm_error(ours["dtau_dq"], bare["dtau_dq"]) <= ROUNDING


@pytest.mark.parametrize("axes", ["link", "base"])
def test_derivatives_under_a_payload(rttrr: Robot, axes: Any) -> None:
    """The payload stays as it is in the axes in which it was given."""
    payload = [Wrench((1.0, -2.0, 3.0), (0.3, 0.2, -0.1), expressed_in=axes)]
    drawn = Sampler(rttrr.model, "mixed", 3).draw(0, 4)
    parts = rttrr.derivatives(drawn.q, drawn.v, drawn.a, payload)
    step = EPS ** (1 / 3)
    for by, ours in zip("qva", parts, strict=True):
        for j, direction in enumerate(step * np.eye(5)):
            state = {name: getattr(drawn, name) for name in "qva"}
            taus = [
                recursion(rttrr, **(state | {by: state[by] + sign * direction}), payload=payload).tau
                for sign in (1, -1)
            ]
            size = np.linalg.norm(ours) + np.linalg.norm(taus)
            assert np.linalg.norm(ours[..., j] - (taus[0] - taus[1]) / (2 * step)) <= DIFFERENCES * size


# Hard places


def test_massless_links_carry_what_hangs_on_them() -> None:
    """A link without mass on a joint that moves, such as a universal joint made of two: common in URDFs."""
    check_carrier('<link name="cross"/>')


@pytest.mark.parametrize("mass", [1e-3, 1e-6, 1e-9])
def test_nearly_massless_links_cost_no_digits(mass: float) -> None:
    """Files give dummy links a gram, or less."""
    tensor = f'ixx="{mass}" ixy="0" ixz="0" iyy="{mass}" iyz="0" izz="{mass}"'
    check_carrier(f'<link name="cross"><inertial><mass value="{mass}"/><inertia {tensor}/></inertial></link>')


def check_carrier(link: str) -> None:
    rng = np.random.default_rng(0)
    robot = rttrr_pin.load(
        f'<robot name="x"><link name="base"/>{link}<link name="arm">{inertial(rng)}</link>'
        + joint(1, "revolute", "base", "cross", (0, 0, 0.1), (0.1, 0.2, 0.3), (0, 1, 0))
        + joint(2, "revolute", "cross", "arm", (0.1, 0.2, 0.1), (0.3, 0.2, 0.3), (0, 0, 1))
        + "</robot>"
    )
    drawn = Sampler(robot.model, "mixed", 0).draw(0, STATES)
    tau = recursion(robot, drawn.q, drawn.v, drawn.a).tau
    assert norm_error(robot.compile("tau", "numpy")(drawn.q, drawn.v, drawn.a), tau) <= ROUNDING


def test_one_state_has_no_batch_axis(rttrr: Robot) -> None:
    zero = np.zeros(5)
    assert rttrr.mass_matrix(zero).shape == (5, 5)
    assert rttrr.nonlinear_effects(zero, zero).shape == (5,)
    assert rttrr.gravity_torque(zero).shape == (5,)
    assert rttrr.regressor(zero, zero, zero).shape == (5, 10 * len(rttrr.link_names))
    assert [x.shape for x in rttrr.derivatives(zero, zero, zero)] == [(5, 5)] * 3


def test_the_methods_give_the_kernels_numbers() -> None:
    robot, drawn, ours = made("rttrr")
    q, v, a = drawn.q, drawn.v, drawn.a
    assert norm_error(robot.mass_matrix(q), ours["mass_matrix"]) <= ROUNDING
    assert norm_error(robot.nonlinear_effects(q, v), ours["nonlinear_effects"]) <= ROUNDING
    assert norm_error(robot.gravity_torque(q), ours["gravity_torque"]) <= ROUNDING
    assert norm_error(robot.regressor(q, v, a), ours["regressor"]) <= ROUNDING
    for name, x in zip(DERIVATIVES, robot.derivatives(q, v, a), strict=True):
        assert norm_error(x, ours[name]) <= ROUNDING


def test_the_methods_take_dicts_and_leading_axes(rttrr: Robot) -> None:
    q = dict.fromkeys(rttrr.joint_names, np.full((2, 3), 0.4))
    assert rttrr.mass_matrix(q).shape == (2, 3, 5, 5)
    np.testing.assert_array_equal(rttrr.mass_matrix(q)[1, 2], rttrr.mass_matrix(np.full(5, 0.4)))
    assert rttrr.regressor(q, np.zeros((3, 5)), np.zeros(5)).shape == (2, 3, 5, 10 * len(rttrr.link_names))


def test_a_payload_has_no_place_in_a_mass_matrix(rttrr: Robot) -> None:
    for name in (name for name, quantity in QUANTITIES.items() if not quantity.payload):
        arguments = [np.zeros(5)] * len(QUANTITIES[name].inputs)
        with pytest.raises(InputError, match=f"{name} does not depend on it"):
            rttrr.compile(name, "numpy")(*arguments, payload=Wrench((0, 0, 1)))


def test_without_gravity_nothing_holds_it() -> None:
    robot = rttrr_pin.load("rttrr", gravity=(0, 0, 0))
    assert not robot.gravity_torque(np.ones((3, 5))).any()
