"""Each known slip is named where it was made, and nothing where none was or where two would explain the numbers."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rttrr_pin.core.arrays import Array, rotation
from rttrr_pin.core.solids import Box, Cylinder, RigidBody, Solid, Sphere
from rttrr_pin.inspection import Finding
from rttrr_pin.inspection.cases import cases
from rttrr_pin.inspection.causes import Cause, cause_of
from rttrr_pin.inspection.checks import Subject
from rttrr_pin.inspection.readings import MASS_UNITS, ORDERS, TENSOR_UNITS
from rttrr_pin.inspection.run import inspect_document
from rttrr_pin.urdf.inertial import ENTRIES
from rttrr_pin.urdf.parser import read_document
from support.inspected import arm, inertial, shape, tip

CAUSES = {
    "c20_mirror_copied": ("left_hip", "copied"),
    "c21_dexforce": ("base_link", "rows"),
    "c23_tensor_in_part_axes": ("bracket", "axes"),
    "c25_products_sign": ("finger", "sign"),
    "c26_unit_no_mesh": ("upper", "unit"),
    "i_turtlebot": ("l", "placeholder"),
    "i_decimal": ("l", "decimal"),
}
"""The link of a file, and why its numbers are wrong."""


def findings_of(text: str | Path) -> list[Finding]:
    return [found for found in inspect_document(read_document(text)).findings if found.id != "C501"]


@pytest.mark.parametrize("name", CAUSES)
def test_reported_files_are_explained(name: str, repository: Path) -> None:
    (found,) = findings_of(repository / "tests" / "data" / "reports" / f"{name}.urdf")
    assert (found.name, found.cause) == CAUSES[name]


def test_bodies_without_mass_are_told_once(repository: Path) -> None:
    folder = repository / "tests" / "data" / "reports"
    assert [found.id for found in findings_of(folder / "no_mass.urdf")] == ["P109"]
    found = findings_of(folder / "c27_massless_collider.urdf")
    assert [(each.id, each.name) for each in found] == [("P110", "omni_chassis_base_link"), ("P110", "arm_base_link")]


# A body with the shape that is drawn, and the file that one slip makes of it

SOLIDS: dict[str, Callable[[float, float, float], tuple[Solid, str]]] = {
    "box": lambda x, y, z: (Box((x, y, z)), f'<box size="{x} {y} {z}"/>'),
    "cylinder": lambda x, y, z: (Cylinder(x / 2, y), f'<cylinder radius="{x / 2}" length="{y}"/>'),
    "sphere": lambda x, y, z: (Sphere(x), f'<sphere radius="{x}"/>'),
}

LENGTHS = st.floats(0.05, 0.5)

Triple = tuple[float, float, float]


class Body:
    """A homogeneous solid, turned and away from the link's origin."""

    def __init__(self, kind: str, lengths: Triple, xyz: Triple, rpy: Triple, density: float) -> None:
        solid, self.tag = SOLIDS[kind](*lengths)
        self.xyz, self.rpy = xyz, rpy
        part = RigidBody.of(solid, density)
        self.mass, self.R = part.mass, rotation(rpy)
        self.part = part.inertia
        self.tensor = self.R @ part.inertia @ self.R.T
        self.other_way: Triple = (-rpy[0], -rpy[1], -rpy[2])
        self.back = rotation(self.other_way)

    def written(
        self, tensor: Array, mass: float | None = None, digits: int | None = 12, rpy: Triple = (0.0, 0.0, 0.0)
    ) -> str:
        """The file, with a tensor in the axes of the inertial frame; without digits, with the entries as they are."""
        entries = [tensor[at] for at in ENTRIES.values()]
        words = [f"{entry:.{digits}g}" if digits else str(entry) for entry in entries]
        place = {"xyz": "{} {} {}".format(*self.xyz), "rpy": "{} {} {}".format(*self.rpy)}
        return arm(
            inertial(self.mass if mass is None else mass, words, place["xyz"], "{} {} {}".format(*rpy))
            + shape(self.tag, "visual", **place)
        )


BODIES = st.builds(
    Body,
    st.sampled_from(list(SOLIDS)),
    st.tuples(LENGTHS, LENGTHS, LENGTHS),
    st.tuples(*[st.floats(-0.5, 0.5)] * 3),
    st.tuples(*[st.floats(-3.0, 3.0)] * 3),
    st.floats(500.0, 8000.0),
)

GENERIC = Body("box", (0.31, 0.17, 0.05), (0.2, -0.1, 0.05), (0.3, -0.5, 0.7), 2700.0)


def ordered(tensor: Array, names: str) -> Array:
    """What stands in each slot if the slots hold, in turn, the entries of these names."""
    slots = np.zeros((3, 3))
    for at, name in zip(ENTRIES.values(), names.split(), strict=True):
        slots[at] = tensor[ENTRIES[name]]
    return slots


def decimal(tensor: Array, slot: int, places: int) -> Array:
    moved = tensor.copy()
    moved[list(ENTRIES.values())[slot]] *= 10.0**places
    return moved


Slip = Callable[[Body], str]


def in_unit(factor: float) -> Slip:
    return lambda body: body.written(body.tensor / factor)


def mass_in_unit(factor: float) -> Slip:
    return lambda body: body.written(body.tensor, body.mass / factor)


def in_order(names: str) -> Slip:
    return lambda body: body.written(ordered(body.tensor, names))


def shifted(slot: int, places: int) -> Slip:
    return lambda body: body.written(decimal(body.tensor, slot, places))


def about_origin(body: Body) -> str:
    return body.written(
        body.tensor + body.mass * (np.dot(body.xyz, body.xyz) * np.eye(3) - np.outer(body.xyz, body.xyz))
    )


def cut(body: Body) -> str:
    places = -int(np.floor(np.log10(1.9 * body.tensor.max())))
    return body.written(np.round(body.tensor, places), digits=None)


SLIPS: dict[str, list[Slip]] = {
    "unit": [*map(in_unit, TENSOR_UNITS.values()), *map(mass_in_unit, MASS_UNITS.values())],
    "sign": [lambda body: body.written(2.0 * np.diag(body.tensor.diagonal()) - body.tensor)],
    "axes": [
        lambda body: body.written(body.part),
        lambda body: body.written(body.R.T @ body.part @ body.R),
        lambda body: body.written(body.back @ body.part @ body.back.T),
        lambda body: body.written(body.part, rpy=body.other_way),
        lambda body: body.written(body.tensor, rpy=body.rpy),
    ],
    "origin": [about_origin],
    "order": [*map(in_order, ORDERS)],
    "rows": [in_order("ixx ixy ixz ixy iyy iyz")],
    "decimal": [shifted(slot, places) for slot in range(6) for places in (-3, -2, -1, 1, 2, 3)],
    "cut": [cut],
}
"""Files with each slip, by the name of the reading that knows it."""

ALL = [(name, slip) for name, slips in SLIPS.items() for slip in slips]


def cause(text: str) -> Cause | None:
    with np.errstate(all="ignore"):
        return cause_of(cases(Subject(read_document(text), None))["arm"])


@pytest.mark.parametrize(("name", "case"), [(name, k) for name in SLIPS for k in range(len(SLIPS[name]))])
def test_a_slip_is_named(name: str, case: int) -> None:
    """On a box with six entries that differ; where it hardly changes the tensor, nothing need be said."""
    text = SLIPS[name][case](GENERIC)
    found = findings_of(text)
    slight = np.linalg.norm(written_tensor(text) - GENERIC.tensor) < 0.1 * np.linalg.norm(GENERIC.tensor)
    assert [each.cause for each in found] in ([[name], []] if slight and name != "unit" else [[name]])


def written_tensor(text: str) -> Array:
    written = read_document(text).links["arm"].inertial
    assert written is not None
    return written.inertia


@pytest.mark.slow
@settings(max_examples=200)
@given(BODIES, st.sampled_from(ALL))
def test_no_wrong_cause_is_named(body: Body, slip: tuple[str, Slip]) -> None:
    """What is named leads back to the body; where another reading would explain the numbers, too, nothing is named."""
    named = cause(slip[1](body))
    if named is not None and named.meant is not None:
        known = np.ones(6, dtype=bool)
        known[5] = named.name != "rows"
        meant, true = (np.array([tensor[at] for at in ENTRIES.values()]) for tensor in (named.meant, body.tensor))
        assert np.allclose(meant[known], true[known], atol=2e-3 * np.abs(true).max()), named.name


@settings(max_examples=100)
@given(BODIES)
def test_nothing_is_said_of_a_body_as_it_is_drawn(body: Body) -> None:
    assert findings_of(body.written(body.tensor)) == []


def test_a_dummy_that_hardly_changes_its_body_is_a_note() -> None:
    """Fixed to an arm of 1 kg, where it moves by itself it is a warning."""
    dummy = inertial(1e-3, (1e-4, 0, 0, 1e-4, 0, 1e-4))
    for kind, severity in (("fixed", "note"), ("revolute", "warning")):
        (found,) = findings_of(arm(extra=tip(dummy, kind=kind)))
        assert (found.name, found.severity, found.cause) == ("tip", severity, "placeholder")


# Without drawing

MOMENTS = st.tuples(st.floats(1e-4, 1e-2), st.floats(1e-4, 1e-2), st.floats(1e-4, 1e-2))


@settings(max_examples=100)
@given(MOMENTS, st.tuples(*[st.floats(-3.0, 3.0)] * 3), st.integers(0, 5), st.sampled_from([-3, -2, -1, 1, 2, 3]))
def test_laws_alone_never_name_a_wrong_decimal_point(
    second: tuple[float, ...], rpy: tuple[float, ...], slot: int, places: int
) -> None:
    """The reading named is a body, and the only one of one shift."""
    sigma = rotation(rpy) @ np.diag(second) @ rotation(rpy).T
    tensor = np.trace(sigma) * np.eye(3) - sigma
    wrong = decimal(tensor, slot, places)
    named = cause(arm(inertial(1, [f"{wrong[at]:.12g}" for at in ENTRIES.values()])))
    if named is not None and named.meant is not None and named.name == "decimal":
        assert np.allclose(named.meant, tensor, atol=2e-2 * tensor.max())


def test_several_shifts_of_one_decimal_point_are_not_told() -> None:
    (found,) = findings_of(arm(inertial(1, (0.02, 0, 0, 0.02, 0, 0.3))))
    assert (found.id, found.cause) == ("P105", "")


@pytest.mark.parametrize(("factor", "cause"), [(1e9, "unit"), (1e7, "unit"), (1e6, "unit"), (1e4, "unit"), (1e3, "")])
def test_a_unit_is_named_without_a_drawing(factor: float, cause: str) -> None:
    """A bar of 0.3 x 0.04 x 0.03 m; what is 1000 times too large may be a guess."""
    body = RigidBody.of(Box((0.3, 0.04, 0.03)), 2000.0)
    x, y, z = (f"{moment * factor:.9g}" for moment in body.inertia.diagonal())
    (found,) = findings_of(arm(inertial(body.mass, (x, 0, 0, y, 0, z))))
    assert (found.id, found.cause) == ("G209", cause)


@pytest.mark.parametrize(
    ("tensor", "mass", "cause"),
    [
        ((2.7e-20, -1.7e-21, 1.4e-20, 5.4e-20, 3.4e-21, 1.4e-20), 0.7, "dust"),
        ((0.01, 0, 0, 0.01, 0, -1e-19), 1, "dust"),
        ((1e-20, 0, 0, 2e-20, 0, 2.5e-20), 0, "dust"),
        ((1e-6,) * 6, 1e-6, "placeholder"),
        ((0.001, 0, 0, 0.001, 0, 0.001), 0.001, "placeholder"),
    ],
)
def test_numbers_that_are_no_body_are_told_once(tensor: tuple[object, ...], mass: float, cause: str) -> None:
    (found,) = findings_of(arm(inertial(mass, tensor), base=inertial()))
    assert found.cause == cause


def test_a_cylinder_of_other_dimensions_is_recognised() -> None:
    """The wrists of a well-known arm: 0.6 m in place of 0.06 m."""
    tensor = (0.111172755531, 0, 0, 0.111172755531, 0, 0.21942)
    (found,) = findings_of(arm(inertial(1.219, tensor) + shape('<sphere radius="0.1"/>')))
    assert (found.id, found.cause) == ("G201", "size")


def test_a_placeholder_with_a_drawing_is_one_finding() -> None:
    text = arm(inertial(1e-4, (1e-3, 0, 0, 1e-3, 0, 1e-3), xyz="0.3 0 0") + shape('<box size="0.1 0.1 0.1"/>'))
    (found,) = findings_of(text)
    assert found.cause == "placeholder"


@pytest.mark.parametrize(
    ("xyz", "cause"), [("70 60 50", "unit"), ("0.07 0.06 -0.05", "sign"), ("0.07 -0.06 -0.05", ""), ("0 0 0", "zero")]
)
def test_why_a_centre_of_mass_lies_outside(xyz: str, cause: str) -> None:
    box = Box((0.04, 0.04, 0.04))
    body = RigidBody.of(box, 2700.0)
    drawn = shape('<box size="0.04 0.04 0.04"/>', xyz="0.07 0.06 0.05")
    moment = f"{body.inertia[0, 0]:.9g}"
    (found,) = findings_of(arm(inertial(body.mass, (moment, 0, 0, moment, 0, moment), xyz=xyz) + drawn))
    assert (found.id, found.cause) == ("G204", cause)
