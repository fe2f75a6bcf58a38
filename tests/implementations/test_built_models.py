"""What a library built is what is judged: numbers that it rounds are named and allowed for, others are mismatches."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import RandomPayload, Robot
from rttrr_pin.core.model import Model
from rttrr_pin.errors import ImplementationError, ModelMismatchError
from rttrr_pin.implementations import make_implementation
from rttrr_pin.validation import SAMPLINGS, compare_state, validate
from support.implementations import altered
from support.serial_chains import inertial, numbers

LIBRARIES = ("pinocchio", "mujoco")


def arm(axis: object, kind: str = "revolute", rpy: object = (0.3, -0.2, 0.9), tail: str = "") -> Robot:
    """A joint about this axis, then one about another."""
    rng = np.random.default_rng(3)
    text = '<robot name="arm"><link name="base"/>'
    for name, parent, own, of_kind in (("a", "base", axis, kind), ("b", "a", (0.6, 0, 0.8), "revolute")):
        text += (
            f'<link name="{name}">{inertial(rng)}</link><joint name="to_{name}" type="{of_kind}">'
            f'<parent link="{parent}"/><child link="{name}"/><origin xyz="0.1 0.2 0.3" rpy="{numbers(rpy)}"/>'
            f'<axis xyz="{numbers(own)}"/><limit lower="-2" upper="2" velocity="3" effort="9"/></joint>'
        )
    return rttrr_pin.load(f"{text}{tail}</robot>")


def tilted(k: int, tilt: float, sign: float = 1.0, length: float = 1.0) -> np.ndarray:
    """x, y or z, or its opposite, turned by a small angle."""
    axis = np.full(3, tilt)
    axis[(k + 1) % 3] *= -0.5
    axis[k] = sign * length
    return axis


def moved(model: Model, joint: int, **changes: object) -> Model:
    joints = list(model.joints)
    joints[joint] = replace(joints[joint], **changes)
    return replace(model, joints=tuple(joints))


@pytest.mark.one_in(8)
@pytest.mark.parametrize("kind", ["revolute", "prismatic", "continuous"])
@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("tilt", [1e-16, 4e-15, 3e-14, 7e-13])
@pytest.mark.parametrize(("sign", "length"), [(1.0, 1.0), (-1.0, 1.0), (1.0, 1 + 5e-13), (1.0, 3.0)])
def test_axes_near_to_a_coordinate_axis_agree_and_are_named(
    kind: str, library: str, tilt: float, sign: float, length: float
) -> None:
    robot = arm(tilted(1, tilt, sign, length), kind)
    for sampling in ("corners", "large-velocities"):
        result = validate(robot, "recursion", library, 60, sampling=sampling)
        assert result.passed and not any(one.wrong for one in result.adjudications)
    snapped = library == "pinocchio" and sign > 0 and length < 2
    assert any("'to_a'" in note for note in result.notes) == snapped


@pytest.mark.parametrize("name", ["axis_nearly_y", "axis_tilted"])
@pytest.mark.parametrize("sampling", list(SAMPLINGS))
@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_reported_files_agree(repository: Path, name: str, sampling: str, base: str) -> None:
    robot = rttrr_pin.load(repository / f"tests/data/reports/{name}.urdf", base=base)  # type: ignore[arg-type]
    result = validate(robot, "recursion", n_states=200, sampling=sampling)
    assert result.passed and not any(one.wrong for one in result.adjudications)
    assert ["takes the axis" in note for note in result.to_dict()["notes"]] == [True]
    assert result.notes[0] in compare_state(robot, 3, "recursion", sampling=sampling).to_dict()["notes"]


@pytest.mark.parametrize("quantity", ["tau", "F", "N", "f", "n"])
def test_beside_a_snapped_axis_an_error_is_still_seen(quantity: str) -> None:
    """What is allowed is what the axis changes, and no more: 1e-11 of a number is seen beside a tilt of 1e-13."""
    robot = arm(tilted(1, 1e-13))
    wrong = altered(robot, lambda values, batch: values[quantity].__imul__(1 + 1e-11))
    assert not validate(robot, "recursion", wrong, 50).passed


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("off", [2e-12, 1e-6, 0.5])
@pytest.mark.parametrize("k", [0, 1, 2])
def test_an_axis_that_is_wrong_is_a_mismatch(library: str, off: float, k: int) -> None:
    """Shown by altering our axis while the library reads the file's."""
    axis = tilted(k, off)
    model = moved(arm(np.eye(3)[k]).model, 0, axis=axis / np.linalg.norm(axis))
    with pytest.raises(ModelMismatchError, match="joint 'to_a' axis"):
        make_implementation(library, model)


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("angle", [np.pi / 2, np.pi, 1e-16, 3e-9, 1.5707963267948968])
def test_rotations_some_ulp_off_agree(library: str, angle: float) -> None:
    robot = arm((0, 1, 0), rpy=(angle, -angle, angle))
    for sampling in ("corners", "mixed"):
        result = validate(robot, "recursion", library, 60, sampling=sampling)
        assert result.passed and not result.notes


def fixed_chain(lengths: list[float], rpy: object = (0, 0, 0), moving: str = "revolute") -> str:
    """A moving link, fixed links along x that come back to its origin, and a moving link on the last of them."""
    rng = np.random.default_rng(5)
    names = ["a", *(f"f{i}" for i in range(len(lengths))), "b"]
    text = f'<robot name="chain"><link name="base"/><link name="a">{inertial(rng)}</link>'
    text += f'<joint name="j_a" type="{moving}"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" velocity="1" effort="1"/></joint>'
    for i, length in enumerate([*lengths, 0.0], start=1):
        kind = "fixed" if i <= len(lengths) else moving
        limit = "" if kind == "fixed" else '<axis xyz="0 1 0"/><limit lower="-2" upper="2" velocity="1" effort="1"/>'
        text += (
            f'<link name="{names[i]}">{inertial(rng)}</link><joint name="j_{names[i]}" type="{kind}">'
            f'<parent link="{names[i - 1]}"/><child link="{names[i]}"/>'
            f'<origin xyz="{numbers((length, 0.3 * length, 0.0))}" rpy="{numbers(rpy)}"/>{limit}</joint>'
        )
    return f"{text}</robot>"


CANCELLING = [[0.1, 0.2, -0.3], [1e3, -1e3], [0.7, 1e5, -1e5, -0.7], [1e-8, 3.0, -3.0]]


@pytest.mark.parametrize("lengths", CANCELLING, ids=str)
@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("rpy", [(0, 0, 0), (0, 0, np.pi)], ids=["straight", "turned"])
def test_lengths_that_cancel_along_fixed_joints_are_no_mismatch(
    lengths: list[float], library: str, rpy: object
) -> None:
    robot = rttrr_pin.load(fixed_chain(lengths, rpy))
    assert validate(robot, "recursion", library, 60).passed


@pytest.mark.parametrize("lengths", CANCELLING, ids=str)
@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("what", ["p", "com", "inertia", "mass"])
def test_a_difference_of_1e_6_of_what_cancels_is_a_mismatch(lengths: list[float], library: str, what: str) -> None:
    model = rttrr_pin.load(fixed_chain(lengths)).model
    size = max(map(abs, lengths))
    if what == "p":
        other = moved(model, 2, p=model.joints[2].p + [0, 1e-6 * size, 0])
    else:
        links = list(model.links)
        link = links[1]
        change = {"com": 1e-6 * size, "inertia": 1e-6 * link.mass * size**2 * np.eye(3), "mass": 1e-6 * link.mass}
        links[1] = replace(link, **{what: getattr(link, what) + change[what]})
        other = replace(model, links=tuple(links))
    with pytest.raises(ModelMismatchError):
        make_implementation(library, other)


def test_a_centre_that_pinocchio_loses_is_a_mismatch_however_small_the_mass() -> None:
    """It moves the centre of masses below eps to the origin; products of such masses must not hide that."""
    text = arm((0, 0, 1)).model.urdf
    light = rttrr_pin.load(re.sub(r'<mass value="[^"]*"/>', '<mass value="5e-324"/>', text))
    with pytest.raises(ModelMismatchError, match=r"link 'a' centre of mass: \[0., 0., 0.\]"):
        make_implementation("pinocchio", light.model)


def test_all_snapped_axes_are_in_one_note() -> None:
    text = arm(tilted(1, 1e-15)).model.urdf
    robot = rttrr_pin.load(text.replace('xyz="0.6 0.0 0.8"', f'xyz="{numbers(tilted(2, 1e-15))}"'))
    (note,) = make_implementation("pinocchio", robot.model).notes  # type: ignore[attr-defined]
    assert "joint 'to_a'" in note and "joint 'to_b'" in note and note.count("allowed for") == 1


def test_what_urdfdom_prints_is_told_and_kept_from_the_terminal(
    repository: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Two messages of a mass with a blank, one of an attribute that it drops."""
    robot = rttrr_pin.load(repository / "tests/data/reports/blank_in_mass.urdf")
    with pytest.raises(ModelMismatchError, match=r"urdfdom, .* printed 2 messages: .*mass \[1 \] is not a float"):
        make_implementation("pinocchio", robot.model)
    text = '<robot name="x"><link name="a"/><link name="b"/><joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>'
    with pytest.raises(ImplementationError, match="Pinocchio refuses .*urdfdom, .* printed"):
        make_implementation("pinocchio", rttrr_pin.load(text).model)
    assert capfd.readouterr() == ("", "")


def test_what_others_write_to_stderr_stays(capfd: pytest.CaptureFixture[str], rttrr: Robot) -> None:
    make_implementation("pinocchio", rttrr.model)
    os.write(2, b"mine\n")
    assert capfd.readouterr().err == "mine\n"


def test_mujoco_says_where_placeholders_were_compiled(rttrr: Robot) -> None:
    assert validate(rttrr, "recursion", "mujoco", 5).notes == ()
    massless = re.sub("<inertial>.*?</inertial>", "", arm((0, 0, 1)).model.urdf)
    result = validate(rttrr_pin.load(massless), "recursion", "mujoco", 5, payload=RandomPayload())
    assert result.passed and "MuJoCo itself refuses this file" in result.notes[0]
