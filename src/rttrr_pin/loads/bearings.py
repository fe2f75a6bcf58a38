"""What a bearing, a guide or a flange carries: the wrench across its joint, seen from the joint's axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from rttrr_pin.compile.formula import Formula, Sizes
from rttrr_pin.core.algebra import Scalar, Vector
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.model import Model

PARTS = ("radial", "axial", "tilting", "torsion")
"""Of a wrench at a joint, in the order of `BearingLoad`."""

UNITS: Mapping[str, str] = {"radial": "N", "axial": "N", "tilting": "N m", "torsion": "N m"}

Z = (0.0, 0.0, 1.0)


def kind(joint: Joint) -> str:
    """What the joint is to who builds it."""
    if joint.type.nv == 0:
        return "flange"
    if joint.type.nv == 1:
        return "bearing" if joint.type.rotates else "guide"
    return "plane" if joint.type.has_direction else "free"


def axes(model: Model) -> Array:
    """The axis of each joint in its own frame, (links, 3); z where it has none, as tool frames have it (ISO 9409)."""
    own = [joint.axis if joint.type.has_direction else Z for joint in model.joints]
    return np.array(own, dtype=float).reshape(-1, 3)


class Parts:
    """Radial, axial, tilting and torsion of what crosses the joints of a robot, compiled."""

    def __init__(self, model: Model) -> None:
        own = axes(model).tolist()
        width, links = 3 * len(own), len(own)

        def parts(sizes: Sizes, given: Mapping[str, Sequence[Scalar]]) -> dict[str, list[Scalar]]:
            pairs = [
                [_split(Vector(*axis), given[name][3 * i : 3 * i + 3], sizes) for i, axis in enumerate(own)]
                for name in "fn"
            ]
            columns = [[pair[k] for pair in of] for of in pairs for k in (1, 0)]
            return dict(zip(PARTS, columns, strict=True))

        self._formula = Formula(parts, {"f": width, "n": width}, dict.fromkeys(PARTS, links), f"bearings {own}")

    def __call__(self, f: Array, n: Array) -> dict[str, Array]:
        """The parts of f and n, (N, links, 3), each (links, N)."""
        return self._formula(len(f), {"f": f.reshape(len(f), -1), "n": n.reshape(len(n), -1)})


def _split(u: Vector, components: Sequence[Scalar], sizes: Sizes) -> tuple[Scalar, Scalar]:
    """The component along an axis, and the size of what is across it."""
    vector = Vector(*components)
    along = u.dot(vector)
    return along, sizes.norm(vector - u * along)
