"""The bundled arms, built from modules: a code such as "RTTRR" in, URDF text out.

`python -m rttrr_pin.model.modular_arm urdf` writes urdf/*.urdf, and the tables in urdf/README.md where that file
stands there. Of the RTTRR arm, the paper (Detesan) gives the structure and which lengths exist; every number is ours.

A joint's module has two halves: the *stator*, which belongs to the link before the joint, and the *mover*, which
belongs to the link behind it. A mover carries the next stator on its port, so

    origin of joint k+1 in {k} = exit of the mover of joint k + entry of the stator of joint k+1.

All frames are parallel at q = 0. Parts of both halves are placed in the frame at the joint's origin, at q = 0.

| joint | axis |
|---|---|
| T, the first, third, ... T of the code | z |
| T, the second, fourth, ... T of the code | y |
| R, the first, third, ... of an unbroken run of R | z |
| R, the second, fourth, ... of an unbroken run of R | y |

RTTRR has z, z, y, z, y. The R that end the code, two at most and never the first joint, are of wrist size.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from math import pi
from pathlib import Path
from types import MappingProxyType
from typing import Literal
from xml.etree import ElementTree as ET

from rttrr_pin.errors import InputError
from rttrr_pin.model.solids import Box, Cylinder, Material, Part, RigidBody, Sphere, Triple, combine

CODES = ("RTTRR", "TRR", "TRTR", "TRTRR", "TRTTR")
"""The bundled arms; the file of each is its code in small letters."""

STEEL = Material("steel", 7850.0, (0.45, 0.47, 0.50, 1.0), "solid steel")
ALUMINIUM = Material("aluminium", 2700.0, (0.78, 0.80, 0.82, 1.0), "solid aluminium alloy")
PROFILE = Material("profile", 810.0, (0.62, 0.70, 0.78, 1.0), "aluminium extrusion, 30 % of its outline filled")
HOUSING = Material("housing", 1500.0, (0.25, 0.35, 0.55, 1.0), "cast aluminium housing with bearings, 56 % filled")
MOTOR = Material("motor", 3500.0, (0.15, 0.15, 0.17, 1.0), "servo motor with gear: iron, copper and air")
ELECTRONICS = Material("electronics", 1150.0, (0.85, 0.50, 0.15, 1.0), "polymer box with boards and plugs")
MATERIALS = (STEEL, ALUMINIUM, PROFILE, HOUSING, MOTOR, ELECTRONICS)

ALONG_Y = (pi / 2, 0.0, 0.0)
"""Lays a cylinder along y."""


@dataclass(frozen=True)
class Module:
    """A joint and the solids on either side of it.

    Attributes:
        key: its name in `MODULES`: a letter and an axis, "wrist" before it where it is of that size.
        entry: from the port of the mover below to the origin of this joint [m].
        exit: from the origin of this joint to the port of its mover, in the mover's frame [m].
        lower: smallest coordinate [rad or m].
        upper: largest coordinate [rad or m].
        range_note: where the limits come from.
        velocity: largest rate [rad/s or m/s].
        effort: largest torque or force [N m or N].
        effort_note: what the effort must do.
        stator: the parts on the link before the joint, in the joint's frame at q = 0; their names are not the mover's.
        mover: the parts on the link behind the joint, in the joint's frame.
    """

    key: str
    entry: Triple
    exit: Triple
    lower: float
    upper: float
    range_note: str
    velocity: float
    effort: float
    effort_note: str
    stator: tuple[Part, ...]
    mover: tuple[Part, ...]

    @property
    def type(self) -> Literal["revolute", "prismatic"]:
        """URDF's word for the joint."""
        return "revolute" if self.key[-2] == "R" else "prismatic"

    @property
    def axis(self) -> Triple:
        """The joint's axis, in both frames."""
        return (0.0, 0.0, 1.0) if self.key[-1] == "z" else (0.0, 1.0, 0.0)


BASE_EXIT = (0.0, 0.0, 0.10)
BASE = (
    Part("foot", Box((0.30, 0.30, 0.02)), STEEL, (0.0, 0.0, 0.01)),
    Part("pedestal", Cylinder(0.09, 0.08), HOUSING, (0.0, 0.0, 0.06)),
)
"""The base and its port, in the base frame, which stands on the floor."""

TOOL_ENTRY = (0.0, 0.0, 0.13)
TOOL = (
    Part("palm", Box((0.07, 0.05, 0.05)), HOUSING, (0.0, 0.0, -0.105)),
    Part("finger_left", Box((0.012, 0.03, 0.08)), ALUMINIUM, (-0.022, 0.0, -0.04)),
    Part("finger_right", Box((0.012, 0.03, 0.08)), ALUMINIUM, (0.022, 0.0, -0.04)),
    Part("fingertip", Sphere(0.01), ELECTRONICS, (0.013, 0.0, -0.01)),
    Part("camera", Box((0.03, 0.05, 0.03)), ELECTRONICS, (0.03, 0.042, -0.105), (0.3, 0.4, 0.25)),
)
"""The gripper on the last mover's port, in the tool frame, which lies between the fingertips."""

_REVOLUTE_RANGE = "170 degrees to either side, short of a full turn for the cables"
_TILT_RANGE = "the flange stays clear of the fork's foot"

MODULES: Mapping[str, Module] = MappingProxyType(
    {
        module.key: module
        for module in (
            Module(
                "Rz",
                entry=(0.0, 0.0, 0.07),
                exit=(0.0, 0.0, 0.06),
                lower=-2.97,
                upper=2.97,
                range_note=_REVOLUTE_RANGE,
                velocity=2.5,
                effort=80.0,
                effort_note="swings the outstretched arm with 3 kg in the tool",
                stator=(
                    Part("housing", Cylinder(0.07, 0.07), HOUSING, (0.0, 0.0, -0.035)),
                    Part("motor", Cylinder(0.03, 0.08), MOTOR, (0.09, 0.03, -0.035), (0.3, 0.2, 0.0)),
                ),
                mover=(
                    Part("turntable", Cylinder(0.065, 0.02), ALUMINIUM, (0.0, 0.0, 0.01)),
                    Part("neck", Box((0.09, 0.09, 0.04)), PROFILE, (0.0, 0.0, 0.04)),
                    Part("junction_box", Box((0.03, 0.05, 0.03)), ELECTRONICS, (-0.05, 0.022, 0.045), (0.2, 0.3, 0.4)),
                ),
            ),
            Module(
                "Ry",
                entry=(0.0, 0.0, 0.09),
                exit=(0.0, 0.0, 0.252),
                lower=-1.9,
                upper=1.9,
                range_note=_TILT_RANGE,
                velocity=2.0,
                effort=150.0,
                effort_note="holds a second arm of this size with 3 kg in its tool, level",
                stator=(
                    Part("foot", Box((0.14, 0.16, 0.015)), ALUMINIUM, (0.0, 0.0, -0.0825)),
                    Part("cheek_left", Box((0.10, 0.014, 0.12)), ALUMINIUM, (0.0, 0.067, -0.015)),
                    Part("cheek_right", Box((0.10, 0.014, 0.12)), ALUMINIUM, (0.0, -0.067, -0.015)),
                    Part("motor", Cylinder(0.035, 0.10), MOTOR, (0.01, 0.118, -0.01), (1.35, 0.25, 0.0)),
                ),
                mover=(
                    Part("hub", Cylinder(0.04, 0.12), HOUSING, (0.0, 0.0, 0.0), ALONG_Y),
                    Part("beam", Box((0.06, 0.07, 0.21)), PROFILE, (0.0, 0.0, 0.135)),
                    Part("flange", Box((0.10, 0.10, 0.012)), ALUMINIUM, (0.0, 0.0, 0.246)),
                    Part("drive_box", Box((0.04, 0.04, 0.06)), ELECTRONICS, (-0.045, 0.015, 0.12), (0.3, 0.2, 0.4)),
                ),
            ),
            Module(
                "Tz",
                entry=(0.0, 0.0, 0.30),
                exit=(0.14, 0.03, 0.08),
                lower=-0.20,
                upper=0.20,
                range_note="rail 0.52 m, less the runner's 0.12 m, halved",
                velocity=0.8,
                effort=400.0,
                effort_note="lifts all that stands behind it with 3 kg in the tool, at 1 g and more to spare",
                stator=(
                    Part("foot", Box((0.12, 0.12, 0.02)), ALUMINIUM, (0.0, 0.0, -0.29)),
                    Part("column", Box((0.08, 0.08, 0.56)), PROFILE, (0.0, 0.0, 0.0)),
                    Part("rail", Box((0.012, 0.025, 0.52)), STEEL, (0.046, 0.0, 0.0)),
                    Part("motor", Cylinder(0.03, 0.11), MOTOR, (0.012, -0.022, 0.325), (0.35, 0.25, 0.0)),
                ),
                mover=(
                    Part("runner", Box((0.028, 0.07, 0.12)), ALUMINIUM, (0.066, 0.0, 0.0)),
                    Part("plate", Box((0.012, 0.13, 0.16)), ALUMINIUM, (0.086, 0.0, 0.0)),
                    Part("shelf", Box((0.10, 0.12, 0.015)), ALUMINIUM, (0.142, 0.03, 0.0725)),
                    Part("gusset", Box((0.06, 0.012, 0.06)), ALUMINIUM, (0.122, 0.05, 0.035)),
                    Part("brake", Cylinder(0.025, 0.08), MOTOR, (0.145, 0.005, 0.03), (0.4, 0.3, 0.0)),
                ),
            ),
            Module(
                "Ty",
                entry=(0.0, 0.05, 0.055),
                exit=(0.0, 0.30, 0.062),
                lower=-0.08,
                upper=0.32,
                range_note="the rail, -0.41 m to 0.17 m, stays on both runners, which end 0.085 m from the origin",
                velocity=1.0,
                effort=200.0,
                effort_note="accelerates the beam, the wrist and 3 kg in the tool at 1 g",
                stator=(
                    Part("bed", Box((0.07, 0.20, 0.02)), ALUMINIUM, (0.0, 0.0, -0.045)),
                    Part("runner_front", Box((0.05, 0.05, 0.025)), ALUMINIUM, (0.0, 0.06, -0.0225)),
                    Part("runner_rear", Box((0.05, 0.05, 0.025)), ALUMINIUM, (0.0, -0.06, -0.0225)),
                    Part("motor", Cylinder(0.025, 0.08), MOTOR, (0.055, 0.06, -0.045), (0.35, 0.25, 0.0)),
                ),
                mover=(
                    Part("rail", Box((0.02, 0.58, 0.01)), STEEL, (0.0, -0.12, -0.005)),
                    Part("beam", Box((0.06, 0.76, 0.05)), PROFILE, (0.0, -0.04, 0.025)),
                    Part("flange", Box((0.09, 0.09, 0.012)), ALUMINIUM, (0.0, 0.30, 0.056)),
                    Part("cable_box", Box((0.03, 0.09, 0.03)), ELECTRONICS, (0.04, -0.25, 0.03), (0.2, 0.3, 0.25)),
                ),
            ),
            Module(
                "wrist Rz",
                entry=(0.0, 0.0, 0.05),
                exit=(0.0, 0.0, 0.03),
                lower=-2.97,
                upper=2.97,
                range_note=_REVOLUTE_RANGE,
                velocity=4.0,
                effort=25.0,
                effort_note="turns the tool with 3 kg in it, tilted level",
                stator=(
                    Part("housing", Cylinder(0.04, 0.05), HOUSING, (0.0, 0.0, -0.025)),
                    Part("motor", Cylinder(0.02, 0.06), MOTOR, (0.054, 0.015, -0.03), (0.35, 0.25, 0.0)),
                ),
                mover=(
                    Part("turntable", Cylinder(0.038, 0.012), ALUMINIUM, (0.0, 0.0, 0.006)),
                    Part("neck", Cylinder(0.03, 0.018), ALUMINIUM, (0.0, 0.0, 0.021)),
                    Part("encoder", Box((0.03, 0.03, 0.02)), ELECTRONICS, (-0.034, -0.018, 0.024), (0.3, 0.2, 0.5)),
                ),
            ),
            Module(
                "wrist Ry",
                entry=(0.0, 0.0, 0.06),
                exit=(0.0, 0.0, 0.07),
                lower=-1.75,
                upper=1.75,
                range_note=_TILT_RANGE,
                velocity=4.0,
                effort=25.0,
                effort_note="holds the tool with 3 kg in it, level",
                stator=(
                    Part("foot", Box((0.05, 0.09, 0.01)), ALUMINIUM, (0.0, 0.0, -0.055)),
                    Part("cheek_left", Box((0.05, 0.01, 0.075)), ALUMINIUM, (0.0, 0.04, -0.0125)),
                    Part("cheek_right", Box((0.05, 0.01, 0.075)), ALUMINIUM, (0.0, -0.04, -0.0125)),
                    Part("motor", Cylinder(0.02, 0.06), MOTOR, (0.008, 0.07, -0.01), (1.3, 0.3, 0.0)),
                ),
                mover=(
                    Part("hub", Cylinder(0.02, 0.07), HOUSING, (0.0, 0.0, 0.0), ALONG_Y),
                    Part("stem", Box((0.03, 0.04, 0.048)), PROFILE, (0.0, 0.0, 0.036)),
                    Part("flange", Box((0.06, 0.06, 0.01)), ALUMINIUM, (0.0, 0.0, 0.065)),
                ),
            ),
        )
    }
)
"""The modules by key: from the ground up, every number is an assumption of ours."""

PAPER: Mapping[tuple[str, str], str] = MappingProxyType(
    {
        ("joint_1", "axis"): "(9): q1'' and q1'^2 accelerate along x and y, never along z",
        ("joint_2", "axis"): "(10): q2'' adds to the z component alone",
        ("joint_3", "axis"): "(11): q3'' adds to the y component alone",
        ("joint_4", "axis"): "(12): c q4 and s q4 mix x and y",
        ("joint_5", "axis"): "(13)-(15): c q5 and s q5 mix x and z; (13) has -s q5 g",
        ("joint_1", "x"): "none: the base frame stands under the axis",
        ("joint_1", "y"): "none: the base frame stands under the axis",
        ("joint_1", "z"): "h1; in no equation, since {1} does not move away from the base",
        ("joint_2", "x"): "no length in (10): zero",
        ("joint_2", "y"): "no length in (10): zero",
        ("joint_2", "z"): "h2; see *heights*",
        ("joint_3", "x"): "l2, (11): -q1'^2 l2 in x",
        ("joint_3", "y"): "l3, (11): -q1'' l3 in x, added to q3",
        ("joint_3", "z"): "h3; see *heights*",
        ("joint_4", "x"): "no other length beside l2 in (12): zero",
        ("joint_4", "y"): "l4, (12): added to q3 + l3",
        ("joint_4", "z"): "h4; see *heights*",
        ("joint_5", "x"): "no length beyond l4 in (13)-(15): zero",
        ("joint_5", "y"): "no length beyond l4 in (13)-(15): zero",
        ("joint_5", "z"): "h5; see *heights*",
        ("tool_joint", "x"): "{6} of (8); not given: taken as zero",
        ("tool_joint", "y"): "{6} of (8); not given: taken as zero",
        ("tool_joint", "z"): "{6} of (8); h6, carries the payload's force into n5, whose equations are not printed",
    }
)
"""Where the paper shows, or leaves out, RTTRR's geometry: (joint, axis or component of the origin) -> equation."""


@dataclass(frozen=True)
class Arm:
    """An arm of modules.

    Attributes:
        code: its letters, from the base to the tool.
        modules: the module of each joint.
        origins: the origin of each joint, and of the tool joint at the end, in the frame of the link before [m].
        links: the parts of the base and of each link behind a joint, in that link's frame.
    """

    code: str
    modules: tuple[Module, ...]
    origins: tuple[Triple, ...]
    links: tuple[tuple[Part, ...], ...]

    @property
    def bodies(self) -> tuple[RigidBody, ...]:
        """Mass, centre of mass and inertia of each moving link, in its frame."""
        return tuple(combine(part.body() for part in parts) for parts in self.links[1:])

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Of the moving joints, from the base."""
        return tuple(f"joint_{k}" for k in range(1, len(self.modules) + 1))

    @property
    def link_names(self) -> tuple[str, ...]:
        """From the base to the tool, which is a frame and has no parts."""
        return ("base", *(f"link_{k}" for k in range(1, len(self.modules) + 1)), "tool")


def modules_of(code: str) -> tuple[Module, ...]:
    """The modules that the letters stand for, by the table at the top of this file.

    Args:
        code: at least one letter, each R (revolute) or T (prismatic), from the base to the tool.

    Raises:
        InputError: the code is no text, empty, or has other letters.
    """
    if not isinstance(code, str) or not re.fullmatch("[RT]+", code):
        raise InputError(
            f"the arm's code is {code!r}, wanted one letter per joint, R (revolute) or T (prismatic), in capitals and "
            f"at least one: write it like 'RTTRR'"
        )
    first_of_wrist = max(1, len(code.rstrip("R")), len(code) - 2)
    keys = []
    for k, letter in enumerate(code):
        before = code[:k]
        count = before.count("T") if letter == "T" else len(before) - len(before.rstrip("R"))
        keys.append(f"{'wrist ' if k >= first_of_wrist else ''}{letter}{'zy'[count % 2]}")
    return tuple(MODULES[key] for key in keys)


def build_arm(code: str) -> Arm:
    """Stands the modules of a code on one another.

    Args:
        code: as in `modules_of`.

    Raises:
        InputError: see `modules_of`.
    """
    modules = modules_of(code)
    exits = (BASE_EXIT, *(module.exit for module in modules))
    entries = (*(module.entry for module in modules), TOOL_ENTRY)
    origins = tuple(_sum(port, entry) for port, entry in zip(exits, entries, strict=True))
    owners = ("base", *(f"joint_{k}" for k in range(1, len(modules) + 1)), "tool")
    movers = (BASE, *(module.mover for module in modules))
    stators = (*(module.stator for module in modules), TOOL)
    links = tuple(
        (*_named(mover, owner, (0.0, 0.0, 0.0)), *_named(stator, next_owner, origin))
        for mover, stator, origin, (owner, next_owner) in zip(movers, stators, origins, pairwise(owners), strict=True)
    )
    return Arm(code, modules, origins, links)


def build_urdf(code: str, name: str | None = None) -> str:
    """The URDF text of the arm with these letters.

    Lengths, angles and limits are written as the tables give them, to 9 decimals; mass, centre of mass and inertia,
    which are computed, to 6 significant digits, each rounded on its own.

    Args:
        code: at least one letter, each R (revolute) or T (prismatic), from the base to the tool.
        name: the robot's name in the file; the code in small letters unless given.

    Returns:
        The file's text. Links `base`, `link_1`, ..., `tool`; joints `joint_1`, ..., `tool_joint` (fixed).

    Raises:
        InputError: the code is no such word, or the name is not made of letters, digits, `_`, `.` and `-`.
    """
    arm = build_arm(code)
    name = code.lower() if name is None else name
    if not re.fullmatch(r"[A-Za-z0-9_.-]+", name):
        raise InputError(f"the robot's name is {name!r}, wanted letters, digits, '_', '.' and '-': choose another name")
    robot = ET.Element("robot", name=name)
    for material in MATERIALS:
        element = ET.SubElement(robot, "material", name=material.name)
        ET.SubElement(element, "color", rgba=_given(material.rgba))
    ET.SubElement(robot, "link", name="base").extend(_shapes(arm.links[0]))
    for joint, module, origin, parts, body, (parent, child) in zip(
        arm.joint_names, arm.modules, arm.origins, arm.links[1:], arm.bodies, pairwise(arm.link_names), strict=False
    ):
        robot.append(_joint(joint, module.type, parent, child, origin, module))
        link = ET.SubElement(robot, "link", name=child)
        link.append(_inertial(body))
        link.extend(_shapes(parts))
    robot.append(_joint("tool_joint", "fixed", arm.link_names[-2], "tool", arm.origins[-1]))
    ET.SubElement(robot, "link", name="tool")
    ET.indent(robot)
    return f'<?xml version="1.0"?>\n<!--\n{_header(code)}-->\n{ET.tostring(robot, encoding="unicode")}\n'


def _sum(a: Triple, b: Triple) -> Triple:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def _named(parts: tuple[Part, ...], owner: str, origin: Triple) -> Iterator[Part]:
    return (replace(part, name=f"{owner}_{part.name}", xyz=_sum(origin, part.xyz)) for part in parts)


def _given(values: Iterable[float]) -> str:
    """Numbers of the tables and their sums, to 9 decimals (of a length: a nanometre)."""
    return " ".join(f"{round(value, 9) + 0.0:.9f}".rstrip("0").rstrip(".") for value in values)


def _computed(values: Iterable[float]) -> str:
    """Numbers computed from the tables, to 6 significant digits."""
    return " ".join(f"{value:.6g}" for value in values)


def _inertial(body: RigidBody) -> ET.Element:
    element = ET.Element("inertial")
    ET.SubElement(element, "origin", xyz=_computed(body.com), rpy="0 0 0")
    ET.SubElement(element, "mass", value=_computed([body.mass]))
    entries = {f"i{'xyz'[i]}{'xyz'[j]}": _computed([body.inertia[i, j]]) for i in range(3) for j in range(i, 3)}
    ET.SubElement(element, "inertia", entries)
    return element


def _shapes(parts: Iterable[Part]) -> Iterator[ET.Element]:
    """The visuals, then the collisions: the very solids that the inertia is computed from."""
    solids = tuple(parts)
    for tag, suffix in (("visual", ""), ("collision", "_collision")):
        for part in solids:
            element = ET.Element(tag, name=part.name + suffix)
            ET.SubElement(element, "origin", xyz=_given(part.xyz), rpy=_given(part.rpy))
            shape, sizes = type(part.solid).__name__.lower(), vars(part.solid)
            numbers = {key: _given(value if isinstance(value, tuple) else (value,)) for key, value in sizes.items()}
            ET.SubElement(ET.SubElement(element, "geometry"), shape, numbers)
            if tag == "visual":
                ET.SubElement(element, "material", name=part.material.name)
            yield element


def _joint(name: str, kind: str, parent: str, child: str, origin: Triple, module: Module | None = None) -> ET.Element:
    element = ET.Element("joint", name=name, type=kind)
    ET.SubElement(element, "origin", xyz=_given(origin), rpy="0 0 0")
    ET.SubElement(element, "parent", link=parent)
    ET.SubElement(element, "child", link=child)
    if module is not None:
        ET.SubElement(element, "axis", xyz=_given(module.axis))
        limits = {key: _given([getattr(module, key)]) for key in ("lower", "upper", "effort", "velocity")}
        ET.SubElement(element, "limit", limits)
    return element


_OURS_OF_RTTRR = """\
From the paper: the order, types and axes of the joints; that l2, l3, l4 exist and no other length in the plane;
that all frames are parallel at q = 0. From us: every number (the paper prints none) and every solid.
"""
_OURS_OF_THE_FAMILY = """\
A modular arm of the same family, built from the same modules by the same script. The paper cites an arm with these
letters and prints nothing of its geometry: axes, numbers and solids are all ours, not published.
"""
_HEADER = """\
{code}, a serial arm of {count} joints (R revolute, T prismatic).
{origin}Paper: Detesan, "The dynamic model of RTTRR serial robot - iterations outwards and inwards the robot's
mechanical structure", Acta Technica Napocensis.

Each inertial block is that of the link's visuals, homogeneous, overlaps counted twice, rounded to 6 significant
digits. ixy, ixz and iyz are the matrix elements. Base: no inertial, since it does not move. Densities [kg/m^3]:
{densities}
Written by `python -m rttrr_pin.model.modular_arm urdf`: do not edit. Every number is in urdf/README.md.
"""


def _header(code: str) -> str:
    origin = _OURS_OF_RTTRR if code == "RTTRR" else _OURS_OF_THE_FAMILY
    densities = "\n".join(f"  {material.name}: {_given([material.density])}" for material in MATERIALS)
    return _HEADER.format(code=code, count=len(code), origin=origin, densities=densities)


BEGIN, END = "<!-- tables: begin -->", "<!-- tables: end -->"
"""What stands before and after the tables in urdf/README.md."""

Row = tuple[str, ...]


def readme_tables() -> str:
    """The tables of urdf/README.md: one row for each number in the bundled files, with its source (Markdown)."""
    sections = [
        "## Materials\n\n" + _table(("material", "density [kg/m^3]", "assumed: stands for"), _material_rows()),
        "## Modules: joints\n\n"
        "The axis, ports and limits of each module; all are ours. Ports and origins that are not listed are zero.\n\n"
        + _table(("module", "quantity", "value", "unit", "assumed because"), _module_rows()),
        "## Modules: solids\n\n"
        "Centres and angles in the frame at the joint's origin (of the base and the tool: in their frame), at q = 0. "
        "Dimensions are\noutlines. Coordinates and angles that are not listed are zero. All are ours, by the look of "
        "such parts.\n\n"
        + _table(("module", "belongs to", "solid", "quantity", "value", "unit", "computed mass [kg]"), _solid_rows()),
    ]
    for code in CODES:
        arm = build_arm(code)
        sections.append(
            f"## {code}: joints\n\n" + _table(("joint", "quantity", "value", "unit", "source"), _joint_rows(arm))
        )
        sections.append(
            f"## {code}: inertias\n\nComputed from the solids. The moving mass is "
            f"{_computed([sum(body.mass for body in arm.bodies)])} kg.\n\n"
            + _table(("link", "quantity", "value", "unit"), _inertia_rows(arm))
        )
    return "\n\n".join(sections)


def with_tables(readme: str) -> str:
    """The text of urdf/README.md with fresh tables between its marks.

    Raises:
        InputError: the text lacks the marks `BEGIN` and `END`, in this order.
    """
    head, begin, rest = readme.partition(BEGIN)
    _, end, tail = rest.partition(END)
    if not (begin and end):
        raise InputError(f"README.md lacks a mark, wanted {BEGIN!r} and then {END!r}: put both where the tables belong")
    return f"{head}{BEGIN}\n\n{readme_tables()}\n\n{END}{tail}"


def write_all(directory: Path) -> tuple[Path, ...]:
    """Writes the bundled files, and the tables in the directory's README.md if there is one; each file whole or not.

    Returns:
        The files written.

    Raises:
        InputError: see `with_tables`.
        OSError: a file cannot be written.
    """
    texts = {directory / f"{code.lower()}.urdf": build_urdf(code) for code in CODES}
    readme = directory / "README.md"
    if readme.exists():
        texts[readme] = with_tables(readme.read_text(encoding="utf-8"))
    for path, text in texts.items():
        fresh = path.with_name(path.name + ".new")
        fresh.write_text(text, encoding="utf-8", newline="\n")
        fresh.replace(path)
    return tuple(texts)


def _table(head: Row, rows: Iterable[Row]) -> str:
    lines = (head, ("---",) * len(head), *rows)
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _nonzero(prefix: str, letters: Iterable[str], values: Triple, unit: str) -> Iterator[Row]:
    return ((prefix + letter, _given([value]), unit) for letter, value in zip(letters, values, strict=True) if value)


def _units(module: Module) -> tuple[str, str, str]:
    """Of the coordinate, the rate and the effort."""
    return ("rad", "rad/s", "N m") if module.type == "revolute" else ("m", "m/s", "N")


def _material_rows() -> Iterator[Row]:
    return ((material.name, _given([material.density]), material.note) for material in MATERIALS)


def _module_rows() -> Iterator[Row]:
    yield from (("base", *row, "height of the base") for row in _nonzero("exit ", "xyz", BASE_EXIT, "m"))
    for module in MODULES.values():
        coordinate, rate, effort = _units(module)
        yield (module.key, "axis", _given(module.axis), "", "the rule for codes")
        for row in (*_nonzero("entry ", "xyz", module.entry, "m"), *_nonzero("exit ", "xyz", module.exit, "m")):
            yield (module.key, *row, "size of the solids")
        yield (module.key, "lower", _given([module.lower]), coordinate, module.range_note)
        yield (module.key, "upper", _given([module.upper]), coordinate, module.range_note)
        yield (module.key, "velocity", _given([module.velocity]), rate, "usual for a drive of this size")
        yield (module.key, "effort", _given([module.effort]), effort, module.effort_note)
    yield from (("tool", *row, "length of the gripper") for row in _nonzero("entry ", "xyz", TOOL_ENTRY, "m"))


def _solid_rows() -> Iterator[Row]:
    halves: list[tuple[str, str, tuple[Part, ...]]] = [("base", "base", BASE)]
    for module in MODULES.values():
        halves += [(module.key, "link before", module.stator), (module.key, "link behind", module.mover)]
    halves += [("tool", "last link", TOOL)]
    for key, side, parts in halves:
        for part in parts:
            for row in _part_rows(part):
                yield (key, side, f"{part.name}: {type(part.solid).__name__.lower()}, {part.material.name}", *row)


def _part_rows(part: Part) -> Iterator[Row]:
    mass = _computed([part.body().mass])
    for name, value in vars(part.solid).items():
        if isinstance(value, tuple):
            yield from ((*row, mass) for row in _nonzero(f"{name} ", "xyz", value, "m"))
        else:
            yield (name, _given([value]), "m", mass)
    yield from ((*row, mass) for row in _nonzero("centre ", "xyz", part.xyz, "m"))
    yield from ((*row, mass) for row in _nonzero("", ("roll", "pitch", "yaw"), part.rpy, "rad"))


def _joint_rows(arm: Arm) -> Iterator[Row]:
    names = ("base", *(module.key for module in arm.modules), "tool")
    modules = (*arm.modules, None)
    for joint, origin, (below, above), module in zip(
        (*arm.joint_names, "tool_joint"), arm.origins, pairwise(names), modules, strict=True
    ):
        ours = f"ours: exit of {below} + entry of {above}"
        for letter, value in zip("xyz", origin, strict=True):
            paper = PAPER.get((joint, letter), "") if arm.code == "RTTRR" else ""
            yield (joint, f"origin {letter}", _given([value]), "m", f"{paper}; value {ours}" if paper else ours)
        parallel = "(9)-(15): frames parallel at q = 0" if arm.code == "RTTRR" else "ours: frames parallel at q = 0"
        yield (joint, "origin roll, pitch, yaw", "0 0 0", "rad", parallel)
        if module:
            paper = PAPER.get((joint, "axis"), "") if arm.code == "RTTRR" else ""
            yield (joint, f"axis ({module.type})", _given(module.axis), "", paper or "ours: the rule for codes")
            coordinate, rate, effort = _units(module)
            for key, unit in (("lower", coordinate), ("upper", coordinate), ("velocity", rate), ("effort", effort)):
                yield (joint, key, _given([getattr(module, key)]), unit, f"ours: module {module.key}")


def _inertia_rows(arm: Arm) -> Iterator[Row]:
    for name, body in zip(arm.link_names[1:-1], arm.bodies, strict=True):
        yield (name, "mass", _computed([body.mass]), "kg")
        yield from ((name, f"com {'xyz'[i]}", _computed([body.com[i]]), "m") for i in range(3))
        for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)):
            yield (name, f"i{'xyz'[i]}{'xyz'[j]}", _computed([body.inertia[i, j]]), "kg m^2")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=write_all.__doc__.splitlines()[0] if write_all.__doc__ else None)
    parser.add_argument("directory", type=Path, help="where to write, such as urdf")
    for written in write_all(parser.parse_args().directory):
        print(written)
