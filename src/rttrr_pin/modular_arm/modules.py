"""The modules as data: materials, solids, ports, limits; from the ground up, every number is an assumption of ours."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from types import MappingProxyType
from typing import Literal

from rttrr_pin.core.solids import Box, Cylinder, Material, Part, Sphere, Triple

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

_MODULES = (
    Module(
        "Rz", entry=(0.0, 0.0, 0.07), exit=(0.0, 0.0, 0.06), lower=-2.97, upper=2.97, velocity=2.5, effort=80.0,
        range_note=_REVOLUTE_RANGE,
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
        "Ry", entry=(0.0, 0.0, 0.09), exit=(0.0, 0.0, 0.252), lower=-1.9, upper=1.9, velocity=2.0, effort=150.0,
        range_note=_TILT_RANGE,
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
        "Tz", entry=(0.0, 0.0, 0.30), exit=(0.14, 0.03, 0.08), lower=-0.20, upper=0.20, velocity=0.8, effort=400.0,
        range_note="rail 0.52 m, less the runner's 0.12 m, halved",
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
        "Ty", entry=(0.0, 0.05, 0.055), exit=(0.0, 0.30, 0.062), lower=-0.08, upper=0.32, velocity=1.0, effort=200.0,
        range_note="the rail, -0.41 m to 0.17 m, stays on both runners, which end 0.085 m from the origin",
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
        "wrist Rz", entry=(0.0, 0.0, 0.05), exit=(0.0, 0.0, 0.03), lower=-2.97, upper=2.97, velocity=4.0, effort=25.0,
        range_note=_REVOLUTE_RANGE,
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
        "wrist Ry", entry=(0.0, 0.0, 0.06), exit=(0.0, 0.0, 0.07), lower=-1.75, upper=1.75, velocity=4.0, effort=25.0,
        range_note=_TILT_RANGE,
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
)  # fmt: skip

MODULES: Mapping[str, Module] = MappingProxyType({module.key: module for module in _MODULES})
"""The modules by key: from the ground up, every number is an assumption of ours."""
