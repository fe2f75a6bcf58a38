"""One thing that two descriptions of a robot say differently."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from rttrr_pin.diagnosis.descriptions.rigid_tree import RigidTree
from rttrr_pin.diagnosis.descriptions.tolerance import Level

Change = Callable[[RigidTree], RigidTree]
"""The first robot with one number of the second."""

UNITS = {
    "mass": "kg",
    "centre of mass": "m",
    "inertia": "kg m^2",
    "position": "m",
    "orientation": "rad, rpy",
    "gravity": "m/s^2",
    "link": "kg",
}
"""Of the values of a difference, by its kind; of others those of the joint's coordinate."""


ENTRIES = {"ixx": (0, 0), "iyy": (1, 1), "izz": (2, 2), "ixy": (0, 1), "ixz": (0, 2), "iyz": (1, 2)}
"""Of a tensor, by URDF's names."""


@dataclass(frozen=True, slots=True)
class Difference:
    """One thing that two descriptions of a robot say differently.

    Attributes:
        kind: "mass", "centre of mass", "inertia" (about the centre of mass), "link" (only one has it); "position",
            "orientation", "axis", "type", "limits", "mimic", "armature", "damping", "friction"; "gravity".
        link: the link that it is about; None where it is about a joint.
        joint: the joint that carries it, or that it is about; None on the base.
        a: what the first says, in its frames: a number, a list of numbers, a word, or None.
        b: what the second says, in the frames and coordinates of the first.
        relative: the size of the difference; of directions in rad, of anything else relative to the larger number.
        rounding: whether digits that were printed explain it.
        unit: of a and b.
        change: the first robot with this number of the second; None where no torque can depend on it, and in results.
    """

    kind: str
    link: str | None
    joint: str | None
    a: Any
    b: Any
    relative: float
    rounding: bool = False
    unit: str = ""
    change: Change | None = field(default=None, compare=False, repr=False)

    @property
    def where(self) -> str:
        """What it is about, in words; of a tensor with the entries that differ."""
        if self.link is not None:
            entries = [name for name, _, _ in self.entries] if self.kind == "inertia" else []
            kind = f"{self.kind} {', '.join(entries)}" if 0 < len(entries) < len(ENTRIES) else self.kind
            return f"{kind} of {self.link}"
        return self.kind if self.joint is None else f"{self.kind} of {self.joint}"

    @property
    def entries(self) -> list[tuple[str, float, float]]:
        """Of a tensor, the entries that differ by more than a thousandth of what the largest does: name, a and b."""
        if self.kind != "inertia":
            return []
        both = [(name, self.a[i][j], self.b[i][j]) for name, (i, j) in ENTRIES.items()]
        most = max(abs(x - y) for _, x, y in both)
        return [(name, x, y) for name, x, y in both if abs(x - y) > 1e-3 * most]

    def to_dict(self) -> dict[str, Any]:
        """All but the change, as data for JSON."""
        return {own.name: getattr(self, own.name) for own in fields(self) if own.name != "change"}


def difference_of(
    kind: str,
    link: str | None,
    joint: str | None,
    both: tuple[Any, Any],
    level: Level,
    change: Change | None,
    unit: str = "",
) -> Difference:
    """A difference of what both say, arrays as lists."""
    x, y = (own.tolist() if isinstance(own, np.ndarray) else own for own in both)
    return Difference(kind, link, joint, x, y, level.size, level.printed, unit or UNITS.get(kind, ""), change)
