"""What no number of the model depends on, and other programs refuse: transmissions, numbers that urdfdom asks for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from rttrr_pin.errors import shortened
from rttrr_pin.urdf.document import UrdfTransmission
from rttrr_pin.urdf.elements import Element

ASKED = {
    "dynamics": ("damping", "friction"),
    "calibration": ("rising", "falling"),
    "safety_controller": ("k_velocity", "k_position", "soft_lower_limit", "soft_upper_limit"),
}
"""Elements of joints in which urdfdom wants numbers: one of those of <dynamics>, k_velocity, and all that are there."""


def transmissions_of(robot: Element, joints: Mapping[str, Element]) -> tuple[UrdfTransmission, ...]:
    """The transmissions; whether their joints exist, and each has an actuator of its own."""
    read, drivers = [], Counter[str]()
    for element in robot.children("transmission"):
        xml, first = element.xml, {tag: element.xml.find(tag) for tag in ("type", "joint", "actuator")}
        type_name = xml.get("type", "") if first["type"] is None else (first["type"].text or "")
        joint, actuator = ("" if first[tag] is None else first[tag].get("name", "") for tag in ("joint", "actuator"))
        transmission = UrdfTransmission(xml.get("name", ""), element.line, type_name.strip(), joint, actuator)
        drivers[actuator] += 1
        what = f"<transmission> {transmission.name!r}"
        for target in (each.get("name", "") for each in xml.findall("joint")):
            if target not in joints:
                fix = element.nearest(target, joints)
                element.note("transmission", f"{what} drives joint {target!r}, which does not exist: {fix}")
        if actuator and drivers[actuator] == 2:
            element.note("transmission", f"{what} has the actuator {actuator!r} of another one: give each its own")
        read.append(transmission)
    return tuple(read)


def check_asked(robot: Element, joints: Mapping[str, Element]) -> None:
    """What urdfdom, and so Pinocchio, Gazebo and KDL, refuse although no number of the model depends on it."""
    materials = Counter(material.text("name") for material in robot.children("material"))
    for name, count in materials.items():
        if name and count > 1:
            robot.note("material", f"<material> {shortened(name)!r} stands {count} times: give each its own name")
    for joint in joints.values():
        for tag, keys in ASKED.items():
            for element in joint.children(tag)[:1]:
                written = [key for key in keys if key in element.xml.attrib]
                needed = written + [key for key in ("k_velocity",) if key in keys and key not in written]
                problem = next(filter(None, map(element.problem, needed)), "") if tag != "dynamics" else ""
                if tag == "dynamics" and not written:
                    problem = "<dynamics> has neither damping nor friction"
                if problem:
                    element.note("asked", problem)
