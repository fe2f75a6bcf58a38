"""The verdict matrix against the programs themselves: Pinocchio, MuJoCo, and Drake (`pytest -m drake`).

Each program loads the file, and what it made of it is compared with what the file says: degrees of freedom, masses, inertias,
limits. A rule of ours that its program does not have, or a rule of a program that we do not have, shows as a difference.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pinocchio
import pytest
from lxml import etree
from numpy.typing import ArrayLike

import rttrr_pin
from inspected import arm, diagonal, inertial, joint, shape, tip
from rttrr_pin.errors import RttrrError
from rttrr_pin.inspect import CONSUMERS, RULES, Does, inspect
from rttrr_pin.inspect.lumps import lumps
from rttrr_pin.inspect.reading import Document, read_document
from tolerances import CONSUMER

GOOD = inertial(1, diagonal(1, 1, 1))
ZERO = (0,) * 6
FREEDOM = {"revolute": 1, "continuous": 1, "prismatic": 1, "planar": 3, "floating": 6, "fixed": 0}

FILES = {
    "good": arm(GOOD),
    "full tensor": arm(inertial(2, ("0.5", "0.01", "-0.02", "0.4", "0.03", "0.3"), xyz="0.1 0.2 0.3", rpy="1 2 3")),
    "negative mass": arm(inertial(-1)),
    "tensor without mass": arm(inertial(0)),
    "frame that moves": arm(inertial(0, ZERO)),
    "no inertial": arm(""),
    "no inertial, prismatic": arm("", kind="prismatic"),
    "point": arm(inertial(1, ZERO)),
    "point off the axis": arm(inertial(1, ZERO, xyz="1 0 0")),
    "point, prismatic": arm(inertial(1, ZERO), kind="prismatic"),
    "negative moment": arm(inertial(1, diagonal(-1, 1, 1))),
    "indefinite": arm(inertial(1, (1, 2, 0, 1, 0, 1.5))),
    "triangle": arm(inertial(1, diagonal(1, 1, 3))),
    "triangle, full tensor": arm(inertial(1, ("1", "0.1", "0.1", "1", "0.1", "3"))),
    "triangle by a digit": arm(inertial(1, diagonal("0.10000", "0.20000", "0.30001"))),
    "plate in floats": arm(inertial(1, diagonal(0.1, 0.2, 0.3))),
    "plate, not in floats": arm(inertial(1, diagonal(0.1, 0.7, 0.8))),
    "rod": arm(inertial(1, diagonal(1, 1, 0))),
    **{f"ball, {power}": arm(inertial(1, diagonal(*[f"1e{power}"] * 3))) for power in (-18, -16, -15, -13, -12, 3, 6)},
    **{f"triangle, {power}": arm(inertial(1, diagonal(f"1e{power}", f"1e{power}", f"3e{power}")))
       for power in (-18, -15, -14, -12, 6)},
    "tiny mass": arm(inertial("1e-16")),
    "no limit": arm(GOOD, limit=""),
    "no limit, prismatic": arm(GOOD, limit="", kind="prismatic"),
    "no limit, continuous": arm(GOOD, limit="", kind="continuous"),
    "no effort": arm(GOOD, limit='<limit lower="-1" upper="1" velocity="1"/>'),
    "no velocity, continuous": arm(GOOD, limit='<limit effort="1"/>', kind="continuous"),
    "no range": arm(GOOD, limit='<limit effort="1" velocity="1"/>'),
    "no lower": arm(GOOD, limit='<limit upper="1" effort="1" velocity="1"/>'),
    "no upper": arm(GOOD, limit='<limit lower="-1" effort="1" velocity="1"/>'),
    "zero range": arm(GOOD, limit='<limit lower="0" upper="0" effort="1" velocity="1"/>'),
    "empty range": arm(GOOD, limit='<limit lower="0.5" upper="0.5" effort="1" velocity="1"/>'),
    "mass on the base": arm(GOOD, base=inertial()),
    "negative mass on the base": arm(GOOD, base=inertial(-1)),
    "triangle on the base": arm(GOOD, base=inertial(1, diagonal(1, 1, 3))),
    "point on the base": arm(GOOD, base=inertial(1, ZERO)),
    "tensor without mass on the base": arm(GOOD, base=inertial(0)),
    "fixed tip": arm(GOOD, extra=tip(inertial(0.5))),
    "fixed tip on a frame": arm("", extra=tip(inertial(0.5))),
    "fixed tip, triangle": arm(GOOD, extra=tip(inertial(1, diagonal(1, 1, 3)))),
    "fixed tip, negative mass": arm(GOOD, extra=tip(inertial(-0.1))),
    "fixed tip, more negative mass than the arm has": arm(GOOD, extra=tip(inertial(-2))),
    "fixed tip, tensor without mass": arm(GOOD, extra=tip(inertial(0))),
    "fixed tip, point": arm(GOOD, extra=tip(inertial(1, ZERO))),
    "fixed tip, frame": arm(GOOD, extra=tip("")),
    "tip makes up for the arm": arm(inertial(1, diagonal(1, 1, 3)), extra=tip(inertial(1, diagonal(5, 5, 5)))),
    "frame that carries mass": arm("", extra=tip(GOOD, kind="revolute")),
    "planar": arm(GOOD, limit="", kind="planar"),
    "floating": arm(GOOD, limit="", kind="floating"),
    "shape instead of mass": arm(shape('<sphere radius="0.1"/>')),
    "drawing instead of mass": arm(shape('<sphere radius="0.1"/>', role="visual")),
    "shape and no mass": arm(inertial(0, ZERO) + shape('<sphere radius="0.1"/>')),
    "shape on the tip": arm(GOOD, extra=tip(shape('<sphere radius="0.1"/>'))),
    "shape on the base": arm(GOOD, base=shape('<sphere radius="0.1"/>')),
    "mimic": arm(GOOD, extra=tip(GOOD, kind="revolute", more='<mimic joint="swing" multiplier="2"/>')),
    "mimic on a fixed joint": arm(GOOD, extra=tip(GOOD, more='<mimic joint="swing" multiplier="2"/>')),
}  # fmt: skip
"""Files for each rule, and for both sides of each threshold."""

UNDECIDED = {
    "small products": arm(inertial(1, ("2e-12", "9e-13", "0", "2e-12", "0", "3e-12"))),
    "plate, turned": arm(inertial(1, ("0.25", "0.05", "0", "0.25", "0", "0.5"))),
}
"""Where a program's version or rounding decides."""


def near(x: ArrayLike, y: ArrayLike) -> bool:
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    return bool(np.linalg.norm(x - y) <= CONSUMER * np.linalg.norm(y))


def freedom(document: Document) -> int:
    return sum(FREEDOM[joint.type] for joint in document.joints if joint.mimics is None)


def moments(tensor: ArrayLike) -> np.ndarray:
    return np.linalg.eigvalsh(np.asarray(tensor))


def pinocchio_does(text: str, document: Document) -> Does:
    try:
        model = pinocchio.buildModelFromXML(text)
    except ValueError:
        return Does.REFUSE
    same = model.nv == freedom(document)
    for name, lump in lumps(document).items():
        if name != document.root:
            loaded = model.inertias[model.getJointId(document.carried_by[name].name)]
            same &= near(loaded.mass, lump.mass) and near(moments(loaded.inertia), moments(lump.inertia))
    return Does.ACCEPT if same else Does.ALTER


def mujoco_does(text: str, document: Document) -> Does:
    try:
        model = mujoco.MjModel.from_xml_string(text)
    except ValueError:
        return Does.REFUSE
    same = model.nv == freedom(document)
    for name, lump in lumps(document).items():
        if name != document.root:
            body = model.body(name)
            same &= near(body.mass[0], lump.mass) and near(np.sort(body.inertia), moments(lump.inertia))
    for link in document.joints:
        if link.type in ("revolute", "prismatic") and link.limit is not None:
            wanted = (link.limit.get("lower", 0.0), link.limit.get("upper", 0.0))
            same &= bool(model.joint(link.name).limited[0]) and near(model.joint(link.name).range, wanted)
    return Does.ACCEPT if same else Does.ALTER


def drake_does(text: str, document: Document) -> Does:
    import logging

    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant

    logging.getLogger("drake").setLevel(logging.CRITICAL)
    plant = MultibodyPlant(0.0)
    try:
        (instance,) = Parser(plant).AddModelsFromString(text, "urdf")
        if document.root != "world":
            plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(document.root, instance))
        plant.Finalize()
    except RuntimeError:
        return Does.REFUSE
    same = plant.num_velocities(instance) - plant.num_constraints() == freedom(document)
    same &= all(plant.HasJointNamed(joint.name, instance) for joint in document.joints)
    for name, body in document.links.items():
        if name == "world":
            continue
        loaded, inertial = plant.GetBodyByName(name, instance), body.inertial
        mass = 0.0 if inertial is None else float(inertial.mass)
        same &= near(loaded.default_mass(), mass)
        if inertial is not None and mass > 0.0:
            spatial = loaded.default_spatial_inertia()
            tensor = spatial.Shift(spatial.get_com()).CalcRotationalInertia().CopyToFullMatrix3()
            lever = mass * float(np.dot(inertial.com, inertial.com))  # added and taken away again: its digits are lost
            same &= bool(np.linalg.norm(tensor - inertial.inertia) <= CONSUMER * (np.linalg.norm(tensor) + lever))
    return Does.ACCEPT if same else Does.ALTER


PROGRAMS: list = [
    pytest.param("Pinocchio", pinocchio_does, id="Pinocchio"),
    pytest.param("MuJoCo", mujoco_does, id="MuJoCo"),
    pytest.param("Drake", drake_does, id="Drake", marks=pytest.mark.drake),
]

Program = Callable[[str, Document], Does]


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize(("consumer", "program"), PROGRAMS)
def test_a_program_does_what_our_rules_say(consumer: str, program: Program, name: str) -> None:
    assert inspect(FILES[name]).verdict(consumer).does is program(FILES[name], read_document(FILES[name], name))


@pytest.mark.parametrize("power", range(-18, 7))
@pytest.mark.parametrize(("consumer", "program"), PROGRAMS)
def test_the_rules_hold_at_every_scale(consumer: str, program: Program, power: int) -> None:
    """Consumers' tolerances have a scale, ours in physics have none."""
    for last in ("1.5", "2", "2.5"):
        text = arm(inertial(1, diagonal(f"1e{power}", f"1e{power}", f"{last}e{power}")))
        assert inspect(text).verdict(consumer).does is program(text, read_document(text, "arm")), last


@pytest.mark.parametrize("name", UNDECIDED)
def test_where_rounding_or_the_version_decides_we_say_so(name: str) -> None:
    assert inspect(UNDECIDED[name]).verdict("MuJoCo").does is Does.EITHER
    assert mujoco_does(UNDECIDED[name], read_document(UNDECIDED[name], name)) in Does


def without_shapes(text: str) -> str:
    """What masses and joints say alone: no meshes to be found, no extensions."""
    root = etree.fromstring(text.encode())
    for tag in ("link/visual", "link/collision", "transmission", "gazebo"):
        for element in root.findall(tag):
            element.getparent().remove(element)
    return etree.tostring(root).decode()


def bundled_and_examples() -> dict[str, str | Path]:
    from rttrr_pin.model.sources import bundled, examples

    try:
        return {**{name: name for name in bundled()}, **examples()}
    except RttrrError:  # the extra `robots` is not installed
        return {name: name for name in bundled()}


@pytest.mark.parametrize(("consumer", "program"), PROGRAMS)
def test_the_rules_hold_for_real_robots(consumer: str, program: Program) -> None:
    wrong, seen = {}, 0
    for name, source in bundled_and_examples().items():
        try:
            text = without_shapes(rttrr_pin.load(source).model.urdf)
        except RttrrError:  # no URDF that the strict reader takes
            continue
        ours, theirs = inspect(text).verdict(consumer).does, program(text, read_document(text, name))
        seen += 1
        if ours is not theirs and ours is not Does.EITHER:
            wrong[name] = (str(ours), str(theirs))
    assert seen >= 5
    assert wrong == {}


# Consumers that are not run


@pytest.mark.parametrize(
    ("text", "gazebo", "kdl"),
    [
        (arm(GOOD, base=GOOD), "accept", "alter"),
        (arm(GOOD), "refuse", "accept"),
        (arm("", base=GOOD), "alter", "alter"),
        (arm("", base=GOOD, extra=tip(GOOD)), "accept", "alter"),
        (arm(inertial(1, diagonal(1, 1, 3)), base=GOOD), "refuse", "alter"),
        (arm(inertial(1, diagonal(1, 1, 3)), base=GOOD, extra=tip(inertial(1, diagonal(5, 5, 5)))), "accept", "alter"),
        (arm(inertial(1, diagonal(0.1, 0.7, 0.8)), base=GOOD), "accept", "alter"),
        (arm(inertial(1, ("0.25", "0.05", "0", "0.25", "0", "0.5")), base=GOOD), "either", "alter"),
        (arm(GOOD, limit=""), "refuse", "refuse"),
        (arm(GOOD, limit="", kind="planar", base=GOOD), "alter", "alter"),
        (arm(GOOD).replace('"base"', '"world"'), "accept", "accept"),
        (
            f'<robot name="r"><link name="world"/><link name="a">{GOOD}</link>{joint("j", "world", "a", "fixed")}</robot>',
            "accept",
            "accept",
        ),
    ],
)
def test_gazebo_and_kdl_by_their_sources(text: str, gazebo: str, kdl: str) -> None:
    result = inspect(text)
    assert (result.verdict("Gazebo").does, result.verdict("KDL").does) == (gazebo, kdl)


def test_every_rule_is_met_by_a_file_and_has_a_source() -> None:
    more = [
        *FILES.values(),
        *UNDECIDED.values(),
        arm(inertial(1, ("0.25", "0.05", "0", "0.25", "0", "0.5")), base=GOOD),
    ]
    more.append(arm(inertial(1, diagonal("1e-18", "1e-18", f"{2e-18 + 16 * 2.220446049250313e-16!r}"))))
    met = {hit.rule for text in more for verdict in inspect(text).verdicts for hit in verdict.hits}
    assert met == {rule.id for rule in RULES}
    assert all(":" in rule.source and set(rule.consumers) <= set(CONSUMERS) for rule in RULES)
