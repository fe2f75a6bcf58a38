"""The URDF text of a `yourdfpy.URDF`, from which it is read again like any file.

yourdfpy's own writer leaves out mimic joints and safety controllers. This one writes names, tree, inertias, placements,
axes, limits, dynamics and mimics, each number with all its digits. Visuals, collisions and materials, which do not
enter dynamics, stay behind.

What yourdfpy guessed when it read a file, and what it passed over, cannot be told from what the file said, nor does the
object know its file: the user is told so.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import angles_of, rotation
from rttrr_pin.errors import UrdfError
from rttrr_pin.urdf.vocabulary import ATTRIBUTES
from rttrr_pin.urdf.writer import tensor_words, written

ROTATION_TOLERANCE = 8 * float(np.finfo(float).eps)
"""On each element of a rotation matrix, between the object's and the one that the written angles give back."""

UNKNOWN = (
    "yourdfpy keeps nothing that it does not know (quat_xyzw of URDF 1.1, elements that close loops), and fills in "
    "what is missing (1 for ixx, 0 for a mass); the object does not tell where: pass the file instead"
)
"""What can be told of no object."""


def as_urdf(robot: Any, source: str) -> str:
    """The text of a `yourdfpy.Robot`.

    Args:
        robot: its links and joints.
        source: what to call it in messages.

    Returns:
        A URDF that says what the object says: rotations to a few eps (the object has matrices, the text has angles),
        all other numbers exactly.

    Raises:
        UrdfError: a number is no number, a placement is no rotation and translation, or an inertia is not symmetric.
    """
    writer = _Writer(source)
    xml = ET.Element("robot", writer.texts(name=robot.name))
    for link in robot.links:
        writer.link(xml, link)
    for joint in robot.joints:
        writer.joint(xml, joint)
    ET.indent(xml)
    return ET.tostring(xml, encoding="unicode")


class _Writer:
    """Writes elements; `here` is the link or joint that it is at."""

    def __init__(self, source: str) -> None:
        self.source, self.here = source, "robot"

    def error(self, message: str) -> UrdfError:
        return UrdfError(message, source=self.source, element=self.here)

    def link(self, parent: ET.Element, link: Any) -> None:
        self.here = f'link "{link.name}"'
        element = ET.SubElement(parent, "link", self.texts(name=link.name))
        if link.inertial is None:
            return
        inertial = ET.SubElement(element, "inertial")
        self.origin(inertial, link.inertial.origin)
        if link.inertial.mass is not None:
            ET.SubElement(inertial, "mass", value=self.number("mass", link.inertial.mass))
        if link.inertial.inertia is not None:
            tensor = self.array("inertia", link.inertial.inertia, (3, 3))
            if not np.array_equal(tensor, tensor.T, equal_nan=True):
                raise self.error(f"its inertia {tensor.tolist()} is not symmetric: make it so, inertia tensors are")
            ET.SubElement(inertial, "inertia", tensor_words(tensor))

    def joint(self, parent: ET.Element, joint: Any) -> None:
        self.here = f'joint "{joint.name}"'
        element = ET.SubElement(parent, "joint", self.texts(name=joint.name, type=joint.type))
        for tag in ("parent", "child"):
            ET.SubElement(element, tag, self.texts(link=getattr(joint, tag)))
        self.origin(element, joint.origin)
        if joint.axis is not None:
            ET.SubElement(element, "axis", xyz=written(self.array("axis", joint.axis, (3,))))
        self.numbers_of(element, "limit", joint.limit, ATTRIBUTES["limit"])
        self.numbers_of(element, "dynamics", joint.dynamics, ATTRIBUTES["dynamics"])
        mimic = self.numbers_of(element, "mimic", joint.mimic, ("multiplier", "offset"))
        if mimic is not None:
            mimic.attrib.update(self.texts(joint=joint.mimic.joint))

    def numbers_of(self, parent: ET.Element, tag: str, values: Any, keys: Iterable[str]) -> ET.Element | None:
        """An element with those of an object's numbers that are set."""
        if values is None:
            return None
        set_ = {key: value for key in keys if (value := getattr(values, key)) is not None}
        return ET.SubElement(parent, tag, {key: self.number(f"{tag} {key}", value) for key, value in set_.items()})

    def origin(self, parent: ET.Element, matrix: Any) -> None:
        if matrix is None:
            return
        placement = self.array("origin", matrix, (4, 4))
        R, angles = placement[:3, :3], angles_of(placement[:3, :3])
        off = np.abs(rotation(angles) - R).max()
        if not off <= ROTATION_TOLERANCE or placement[3].tolist() != [0.0, 0.0, 0.0, 1.0]:
            raise self.error(
                f"its origin {placement.tolist()} is no rotation and translation ({off:.1g} off): "
                "set a matrix with orthonormal columns"
            )
        ET.SubElement(parent, "origin", xyz=written(placement[:3, 3]), rpy=written(angles))

    def number(self, what: str, value: Any) -> str:
        """A number with all its digits; text (yourdfpy keeps dynamics as text) as it stands."""
        if isinstance(value, str):
            return value
        try:
            return repr(float(value))
        except (TypeError, ValueError):
            raise self.error(f"its {what} is {value!r}, expected a number") from None

    def array(self, what: str, values: Any, shape: tuple[int, ...]) -> NDArray[np.float64]:
        try:
            array = np.array(values, dtype=np.float64)
        except (TypeError, ValueError):
            array = np.empty(0)
        if array.shape != shape:
            raise self.error(f"its {what} is {values!r}, expected {' x '.join(map(str, shape))} numbers")
        return array

    def texts(self, **values: Any) -> dict[str, str]:
        """Those attributes that are set; the reader says what is missing."""
        for key, value in values.items():
            if not isinstance(value, str | None):
                raise self.error(f"its {key} is {value!r}, expected text")
        return {key: value for key, value in values.items() if value is not None}
