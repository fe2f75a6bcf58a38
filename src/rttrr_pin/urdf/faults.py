"""What is wrong with a file, as data: where it stands, and what was read in its place.

`load` goes on or refuses, and with `lenient` tells what it assumed; `inspect` goes on with what is left.

| level | is | `load` | with `lenient` | `inspect` |
|---|---|---|---|---|
| note | something that no number depends on | goes on | goes on | lists it |
| assumption | something that a number depends on, and one can sensibly assume | refuses | goes on | lists it |
| error | something that makes no robot | refuses | refuses | lists it |
"""

from __future__ import annotations

import enum
from collections.abc import Sequence
from dataclasses import dataclass, field

from rttrr_pin.errors import UrdfError, shortened


class Level(enum.StrEnum):
    """What a fault can do."""

    NOTE = "note"
    ASSUMPTION = "assumption"
    ERROR = "error"


KINDS = {
    "declaration": "The XML declaration stands at the start, and names version 1.0.",
    "comment": "No comment holds two hyphens.",
    "behind": "Nothing stands behind the robot.",
    "text": "No text stands between elements: URDF keeps values in attributes.",
    "namespace": "Elements of URDF stand in no namespace, and prefixes are declared.",
    "xacro": "No element of xacro is left over.",
    "word": "No element and no attribute is misspelt, out of place, or unknown where none may be added.",
    "products": "Products of inertia are written once, as ixy, ixz and iyz.",
    "twice": "An element that counts once stands once.",
    "unused": "What belongs to no moving joint can be read all the same.",
    "unnamed": "The robot has a name.",
    "name": "Links and joints have names, and each its own.",
    "version": "The version of the format is 1.0, 1.1 or 1.2.",
    "quaternion": "A quat_xyzw stands in a file of version 1.1 or later, and is not zero.",
    "rotations": "A rotation is written once, by rpy or by quat_xyzw.",
    "number": "Every number is a decimal number that float64 can hold.",
    "mass": "An <inertial> has a <mass>, which is a number.",
    "inertia": "An <inertial> has an <inertia> with six entries.",
    "axis": "A joint that moves has an <axis>.",
    "direction": "An axis is not zero, and that of a planar joint points along +z.",
    "range": "The lower limit is not above the upper one.",
    "limit": "The limits of effort and velocity are not negative.",
    "dynamics": "Damping and friction are not negative.",
    "mimic": "A <mimic> leads to a joint with one coordinate that moves by itself.",
    "joint": "A joint has a type, a parent and a child, which exist.",
    "tree": "Each link but one is the child of one joint.",
    "loop": "No joints form a loop beside the tree.",
    "not-modelled": "No element carries mechanics that a tree of links and joints has not.",
    "transmission": "A transmission drives a joint that exists, by an actuator of its own.",
    "material": "The materials of the robot have names of their own.",
    "asked": "<limit>, <dynamics>, <calibration> and <safety_controller> hold the numbers that urdfdom asks for.",
}
"""By kind, what holds for a file without such a fault."""


@dataclass(frozen=True, slots=True)
class Fault:
    """Something in a file that should not be so.

    Attributes:
        kind: one of `KINDS`.
        level: what it can do.
        tag: `"link"` or `"joint"` that it stands in, or `"robot"`.
        name: of that link or joint.
        line: its line.
        element: the element, such as `"axis"`; empty where it is the text of the file.
        message: what is there, and the fix.
        assumed: what was read in its place; empty for a note.
        attribute: of the element, where it is about one; of a range, the only end that is written. Else empty.
        value: the text of that attribute; None where it is not there.
    """

    kind: str
    level: Level
    tag: str
    name: str
    line: int
    element: str
    message: str
    assumed: str = ""
    attribute: str = ""
    value: str | None = None

    @property
    def missing(self) -> bool:
        """Whether an attribute is not there, rather than wrong."""
        return bool(self.attribute) and self.value is None

    @property
    def label(self) -> str:
        """The element, as messages name it."""
        return f'{self.tag} "{shortened(self.name)}"' if self.name else self.tag

    @property
    def sentence(self) -> str:
        """What is there, and what was assumed."""
        where = f"line {self.line}: {self.label}: " if self.name else f"line {self.line}: "
        return f"{where}{self.message}" + (f"; assumed: {self.assumed}" if self.assumed else "")


@dataclass(slots=True)
class Log:
    """The faults of a file while it is read.

    Attributes:
        source: what to call the file in messages.
        lenient: whether assumptions are asked for.
        faults: so far, in the order in which they were met.
        changed: whether the tree of elements was brought to what was assumed.
        hints: how many unknown names were looked for among those that are known.
    """

    source: str
    lenient: bool = False
    faults: list[Fault] = field(default_factory=list)
    changed: bool = False
    hints: int = 0

    def check(self) -> None:
        """Refuse what may not be gone on with.

        Raises:
            UrdfError: there is an error, or without `lenient` an assumption; the first, with the number of the others.
        """
        levels = (Level.ERROR,) if self.lenient else (Level.ERROR, Level.ASSUMPTION)
        refused = [fault for fault in self.faults if fault.level in levels]
        if not refused:
            return
        first, hopeless = refused[0], any(fault.level is Level.ERROR for fault in refused)
        way_on = "" if hopeless else f"; --lenient (lenient=True) assumes: {first.assumed}"
        raise UrdfError(
            f"{first.message}{way_on}{_more(refused)}", source=self.source, line=first.line, element=first.label
        )


def _more(refused: Sequence[Fault]) -> str:
    if len(refused) == 1:
        return ""
    return f" (and {len(refused) - 1} more: rttrr-pin inspect lists all)"
