"""The ellipsoids of links: homogeneous bodies of the same mass and inertia."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.inspection.bodies import LinkRow, principal, semi_axes, tree
from rttrr_pin.inspection.exact import Shape
from rttrr_pin.urdf.document import UrdfDocument

THINNEST = 1e-3
"""Of the largest semi-axis: what is flat is drawn as thick as this."""


@dataclass(frozen=True, slots=True, eq=False)
class Ellipsoid:
    """The body of one link.

    Attributes:
        link: its index.
        centre: the centre of mass, (3,) [m], in the link frame.
        axes: the principal axes as columns, in the link frame, right-handed, (3, 3).
        semi_axes: along them, (3,) [m], finite; what a body with these principal moments has. Of an impossible one the
            radii of gyration, by which it is only marked.
        impossible: whether no body has this inertia.
    """

    link: int
    centre: Array
    axes: Array
    semi_axes: Array
    impossible: bool


@np.errstate(over="ignore", invalid="ignore")  # a ratio of inertia and mass may be beyond doubles
def ellipsoids(model: Model) -> tuple[Ellipsoid, ...]:
    """Of all links with a mass or a tensor; what no body has is decided exactly where there is a file."""
    decided = _decided(model)
    out = []
    for i, link in enumerate(model.links):
        if not (link.mass or link.inertia.any()):
            continue
        moments, axes = principal(link.inertia)
        sizes = semi_axes(link.mass, moments)
        row = decided.get(link.name)
        impossible = not np.isfinite(sizes).all() if row is None else row.shape is Shape.IMPOSSIBLE
        if impossible:
            size = float(np.sqrt(np.divide(np.abs(moments).max(), abs(link.mass)))) if link.mass else 0.0
            sizes = np.full(3, size if np.isfinite(size) else 0.0)
        sizes = np.nan_to_num(sizes, nan=0.0, posinf=0.0)  # rounding of what is flat in truth
        out.append(Ellipsoid(i, link.com, axes, np.maximum(sizes, THINNEST * sizes.max()), impossible))
    return tuple(out)


def _decided(model: Model) -> dict[str, LinkRow]:
    """What `inspect` says of the bodies of the file, by link."""
    if not isinstance(model.document, UrdfDocument):
        return {}
    own = {link.name: link for link in model.links}
    rows = [row for row in tree(model.document) if row.name in own]
    return {row.name: row for row in rows if row.mass == own[row.name].mass}
