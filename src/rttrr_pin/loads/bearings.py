"""What a bearing, a guide or a flange carries: the wrench across its joint, seen from the joint's axis."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from rttrr_pin.core.arrays import Array, norm
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
    """The axis of each joint in its own frame, (links, 3); of one that has none z, which a flange's frame has across it
    by the convention of robots' tool frames (ISO 9409, REP 105's tool0).
    """
    own = [joint.axis if joint.type.has_direction else Z for joint in model.joints]
    return np.array(own, dtype=float).reshape(-1, 3)


def parts_of(f: Array, n: Array, u: Array) -> dict[str, Array]:
    """Radial, axial, tilting and torsion of f and n, (N, links, 3), about the axes u, (links, 3), each (links, N)."""
    along_f, across_f = _split(f, u)
    along_n, across_n = _split(n, u)
    return {"radial": across_f, "axial": along_f, "tilting": across_n, "torsion": along_n}


def _split(vectors: Array, u: Array) -> tuple[Array, Array]:
    """The component along an axis, and the size of what is across it."""
    x, y, z = (np.ascontiguousarray(vectors[..., k].T) for k in range(3))
    u_x, u_y, u_z = (u[:, k, None] for k in range(3))
    with np.errstate(over="ignore", invalid="ignore"):
        along = x * u_x + y * u_y + z * u_z
        across = norm(np.stack([x - along * u_x, y - along * u_y, z - along * u_z], axis=-1))
    return along, across
