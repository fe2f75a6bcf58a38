"""Modules stood on one another: the letters of an arm in, its joints' origins and its links' parts out, or its URDF."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from xml.etree import ElementTree as ET

from rttrr_pin.core.solids import Part, RigidBody, Triple, combine
from rttrr_pin.errors import InputError, shortened
from rttrr_pin.modular_arm.modules import BASE, BASE_EXIT, CODES, MATERIALS, MODULES, TOOL, TOOL_ENTRY, Module
from rttrr_pin.urdf.inertial import ENTRIES

MOST_JOINTS = 1000
"""Of an arm; the time to build one grows with the square."""


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
    """The modules that the letters stand for, by the table in the docstring of `rttrr_pin.modular_arm`.

    Args:
        code: at least one letter, each R (revolute) or T (prismatic), from the base to the tool.

    Raises:
        InputError: the code is no text, empty, or has other letters.
    """
    if not isinstance(code, str) or not re.fullmatch("[RT]+", code):
        raise InputError(
            f"the arm's code is {shortened(repr(code))}, wanted one letter per joint, R (revolute) or T (prismatic), "
            f"in capitals and at least one: write it like 'RTTRR'"
        )
    if len(code) > MOST_JOINTS:
        raise InputError(
            f"the arm's code has {len(code):,} letters, expected {MOST_JOINTS} at most: write it like 'RTTRR'"
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


def _sum(a: Triple, b: Triple) -> Triple:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def _named(parts: tuple[Part, ...], owner: str, origin: Triple) -> Iterator[Part]:
    return (replace(part, name=f"{owner}_{part.name}", xyz=_sum(origin, part.xyz)) for part in parts)


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
        ET.SubElement(element, "color", rgba=decimals(material.rgba))
    ET.SubElement(robot, "link", name="base").extend(_shapes(arm.links[0]))
    for joint, module, origin, parts, body, (parent, child) in zip(
        arm.joint_names, arm.modules, arm.origins, arm.links[1:], arm.bodies, pairwise(arm.link_names), strict=False
    ):
        robot.append(_joint(joint, parent, child, origin, module))
        link = ET.SubElement(robot, "link", name=child)
        link.append(_inertial(body))
        link.extend(_shapes(parts))
    robot.append(_joint("tool_joint", arm.link_names[-2], "tool", arm.origins[-1]))
    ET.SubElement(robot, "link", name="tool")
    ET.indent(robot)
    header = _header(code, is_bundled=code in CODES and name == code.lower())
    return f'<?xml version="1.0"?>\n<!--\n{header}-->\n{ET.tostring(robot, encoding="unicode")}\n'


def decimals(values: Iterable[float]) -> str:
    """Numbers of the tables and their sums, to 9 decimals (of a length: a nanometre)."""
    return " ".join(f"{round(value, 9) + 0.0:.9f}".rstrip("0").rstrip(".") for value in values)


def significant(values: Iterable[float]) -> str:
    """Numbers computed from the tables, to 6 significant digits."""
    return " ".join(f"{value:.6g}" for value in values)


def _inertial(body: RigidBody) -> ET.Element:
    element = ET.Element("inertial")
    ET.SubElement(element, "origin", xyz=significant(body.com), rpy="0 0 0")
    ET.SubElement(element, "mass", value=significant([body.mass]))
    ET.SubElement(element, "inertia", {name: significant([body.inertia[at]]) for name, at in ENTRIES.items()})
    return element


def _shapes(parts: Iterable[Part]) -> Iterator[ET.Element]:
    """The visuals, then the collisions: the very solids that the inertia is computed from."""
    solids = tuple(parts)
    for tag, suffix in (("visual", ""), ("collision", "_collision")):
        for part in solids:
            element = ET.Element(tag, name=part.name + suffix)
            ET.SubElement(element, "origin", xyz=decimals(part.xyz), rpy=decimals(part.rpy))
            shape, sizes = type(part.solid).__name__.lower(), vars(part.solid)
            numbers = {key: decimals(value if isinstance(value, tuple) else (value,)) for key, value in sizes.items()}
            ET.SubElement(ET.SubElement(element, "geometry"), shape, numbers)
            if tag == "visual":
                ET.SubElement(element, "material", name=part.material.name)
            yield element


def _joint(name: str, parent: str, child: str, origin: Triple, module: Module | None = None) -> ET.Element:
    """A module's joint; without a module a fixed one."""
    element = ET.Element("joint", name=name, type="fixed" if module is None else module.type)
    ET.SubElement(element, "origin", xyz=decimals(origin), rpy="0 0 0")
    ET.SubElement(element, "parent", link=parent)
    ET.SubElement(element, "child", link=child)
    if module is not None:
        ET.SubElement(element, "axis", xyz=decimals(module.axis))
        limits = {key: decimals([getattr(module, key)]) for key in ("lower", "upper", "effort", "velocity")}
        ET.SubElement(element, "limit", limits)
    return element


_PAPER = """\
Paper: Detesan, "The dynamic model of RTTRR serial robot - iterations outwards and inwards the robot's
mechanical structure", Acta Technica Napocensis.
"""
_OURS_OF_RTTRR = f"""\
From the paper: the order, types and axes of the joints; that l2, l3, l4 exist and no other length in the plane;
that all frames are parallel at q = 0. From us: every number (the paper prints none) and every solid.
{_PAPER}"""
_OURS_OF_THE_FAMILY = f"""\
A modular arm of the same family, built from the same modules by the same script. The paper cites an arm with these
letters and prints nothing of its geometry: axes, numbers and solids are all ours, not published.
{_PAPER}"""
_OURS_ALONE = """\
A modular arm like RTTRR, built from the same modules by the same script. No paper describes it: axes, numbers and
solids are all ours.
"""
_HEADER = """\
{code}, a serial arm of {count} joints (R revolute, T prismatic).
{origin}
Each inertial block is that of the link's visuals, homogeneous, overlaps counted twice, rounded to 6 significant
digits. ixy, ixz and iyz are the matrix elements. Base: no inertial, since it does not move. Densities [kg/m^3]:
{densities}
{written}
"""
_BUNDLED = "Written by `python docs/arms.py urdf`: do not edit. Every number is in urdf/README.md."
_NEW = "Written by `rttrr-pin new {code}`. Every number of its modules is in urdf/README.md of rttrr-pin."


def _header(code: str, is_bundled: bool) -> str:
    origin = _OURS_OF_RTTRR if code == "RTTRR" else _OURS_OF_THE_FAMILY if code in CODES else _OURS_ALONE
    densities = "\n".join(f"  {material.name}: {decimals([material.density])}" for material in MATERIALS)
    written = _BUNDLED if is_bundled else _NEW.format(code=code)
    return _HEADER.format(code=code, count=len(code), origin=origin, densities=densities, written=written)
