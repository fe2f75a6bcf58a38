"""An arm as URDF text."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from itertools import pairwise
from xml.etree import ElementTree as ET

from rttrr_pin.core.solids import Part, RigidBody, Triple
from rttrr_pin.errors import InputError
from rttrr_pin.modular_arm.build import build_arm
from rttrr_pin.modular_arm.modules import CODES, MATERIALS, Module


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
        ET.SubElement(element, "color", rgba=given(material.rgba))
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
    header = _header(code, is_bundled=code in CODES and name == code.lower())
    return f'<?xml version="1.0"?>\n<!--\n{header}-->\n{ET.tostring(robot, encoding="unicode")}\n'


def given(values: Iterable[float]) -> str:
    """Numbers of the tables and their sums, to 9 decimals (of a length: a nanometre)."""
    return " ".join(f"{round(value, 9) + 0.0:.9f}".rstrip("0").rstrip(".") for value in values)


def computed(values: Iterable[float]) -> str:
    """Numbers computed from the tables, to 6 significant digits."""
    return " ".join(f"{value:.6g}" for value in values)


def _inertial(body: RigidBody) -> ET.Element:
    element = ET.Element("inertial")
    ET.SubElement(element, "origin", xyz=computed(body.com), rpy="0 0 0")
    ET.SubElement(element, "mass", value=computed([body.mass]))
    entries = {f"i{'xyz'[i]}{'xyz'[j]}": computed([body.inertia[i, j]]) for i in range(3) for j in range(i, 3)}
    ET.SubElement(element, "inertia", entries)
    return element


def _shapes(parts: Iterable[Part]) -> Iterator[ET.Element]:
    """The visuals, then the collisions: the very solids that the inertia is computed from."""
    solids = tuple(parts)
    for tag, suffix in (("visual", ""), ("collision", "_collision")):
        for part in solids:
            element = ET.Element(tag, name=part.name + suffix)
            ET.SubElement(element, "origin", xyz=given(part.xyz), rpy=given(part.rpy))
            shape, sizes = type(part.solid).__name__.lower(), vars(part.solid)
            numbers = {key: given(value if isinstance(value, tuple) else (value,)) for key, value in sizes.items()}
            ET.SubElement(ET.SubElement(element, "geometry"), shape, numbers)
            if tag == "visual":
                ET.SubElement(element, "material", name=part.material.name)
            yield element


def _joint(name: str, kind: str, parent: str, child: str, origin: Triple, module: Module | None = None) -> ET.Element:
    element = ET.Element("joint", name=name, type=kind)
    ET.SubElement(element, "origin", xyz=given(origin), rpy="0 0 0")
    ET.SubElement(element, "parent", link=parent)
    ET.SubElement(element, "child", link=child)
    if module is not None:
        ET.SubElement(element, "axis", xyz=given(module.axis))
        limits = {key: given([getattr(module, key)]) for key in ("lower", "upper", "effort", "velocity")}
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
    densities = "\n".join(f"  {material.name}: {given([material.density])}" for material in MATERIALS)
    written = _BUNDLED if is_bundled else _NEW.format(code=code)
    return _HEADER.format(code=code, count=len(code), origin=origin, densities=densities, written=written)
