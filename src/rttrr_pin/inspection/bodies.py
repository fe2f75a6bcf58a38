"""The bodies of a robot: the tree, principal moments and axes, equivalent ellipsoids."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.inspection.exact import Shape, shape
from rttrr_pin.urdf.document import UrdfDocument
from rttrr_pin.urdf.inertial import NO_INERTIAL

ROUNDING = 1e-14
"""Of the largest: what is smaller is what diagonalising leaves of a zero. For show; verdicts are decided exactly."""


@dataclass(frozen=True, eq=False)
class LinkRow:
    """A link of the tree and the body that it is.

    Attributes:
        name: its name.
        depth: joints between it and the root.
        joint: the joint that carries it; empty for the root.
        joint_type: URDF's word for it.
        mass: [kg]; 0 for a link without <inertial>.
        com: centre of mass in the link frame, (3,) [m].
        shape: what body has such an inertia, decided exactly.
        moments: principal moments of inertia, ascending, (3,) [kg m^2].
        axes: the principal axes as columns, in the link frame, right-handed, (3, 3).
        semi_axes: of the homogeneous ellipsoid with this mass and inertia, along `axes`, (3,) [m]; NaN where no body
            has them.
        gyration: radii of gyration sqrt(moment / mass), (3,) [m]; NaN where there is no mass.
    """

    name: str
    depth: int
    joint: str
    joint_type: str
    mass: float
    com: Array
    shape: Shape
    moments: Array
    axes: Array
    semi_axes: Array
    gyration: Array


def centre_of_mass(document: UrdfDocument, rows: tuple[LinkRow, ...], mass: float) -> Array:
    """Sum m_i (p_i + R_i c_i) / sum m_i."""
    if not mass:
        return np.full(3, np.nan)
    total = np.zeros(3)
    for row in rows:
        R, p = document.placements[row.name]
        total += row.mass * (p + R @ row.com)
    return total / mass


def tree(document: UrdfDocument) -> Iterator[LinkRow]:
    """The links, parents before children."""
    for depth, name in document.walk():
        joint, inertial = document.carried_by.get(name), document.links[name].inertial or NO_INERTIAL
        mass = float(inertial.mass) + 0.0
        moments, axes = principal(inertial.inertia)
        yield LinkRow(
            name=name,
            depth=depth,
            joint="" if joint is None else joint.name,
            joint_type="" if joint is None else joint.type,
            mass=mass,
            com=inertial.origin.p.copy(),
            shape=shape(inertial),
            moments=moments,
            axes=axes,
            semi_axes=semi_axes(mass, moments),
            gyration=_root(moments / mass) if mass > 0 else np.full(3, np.nan),
        )


def principal(tensor: Array) -> tuple[Array, Array]:
    """Principal moments, ascending [kg m^2], and principal axes as the columns of a rotation matrix."""
    size = float(np.abs(tensor).max())
    if not size or not np.isfinite(size):  # of numbers near 1e308, turning the axes makes infinities
        return tensor.diagonal().copy(), np.eye(3)
    values, axes = np.linalg.eigh(tensor / size)  # scaled: squares of entries below 1e-154 would vanish
    values[np.abs(values) < ROUNDING] = 0.0
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    return values * size, axes


def semi_axes(mass: float, moments: Array) -> Array:
    """Of the homogeneous ellipsoid: I_1 = m (b^2 + c^2) / 5, so a^2 = 5 (I_2 + I_3 - I_1) / (2 m), (3,) [m].

    (Beer and Johnston, the ellipsoid among the mass moments of inertia.) NaN where no body has such moments.
    """
    if mass <= 0:
        return np.full(3, np.nan)
    squares = 2.5 * (moments.sum() - 2.0 * moments) / mass
    squares[np.abs(squares) < ROUNDING * np.abs(squares).max()] = 0.0
    return _root(squares)


def _root(squares: Array) -> Array:
    """Square roots; NaN of what is negative."""
    return np.sqrt(np.where(squares < 0.0, np.nan, squares))
