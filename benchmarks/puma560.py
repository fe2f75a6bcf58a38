"""The Puma 560 arm as data, built from numbers so that every placement is a matrix of exact zeros and ones.

A file format that states rotations by angles cannot say this: the cosine of the double next to pi/2 is 6e-17, and an
operation count that skips zeros would meet it as a number. Here `general` has the arm's geometry and links of any
shape, `armstrong` the links as they were measured.

Frames are those of the modified Denavit-Hartenberg convention: joint i sits at Rx(alpha) and (a, -sin(alpha) d,
cos(alpha) d) on the link before it and turns about its own z axis.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints import REVOLUTE
from rttrr_pin.core.model import Link, Model

Array = NDArray[np.float64]


class Row(NamedTuple):
    """One joint by the modified Denavit-Hartenberg convention, without its angle.

    Attributes:
        turns: the twist alpha, in quarter turns.
        a: the offset along the x axis of the link before [m].
        d: the offset along the joint's own axis [m].
    """

    turns: int
    a: float
    d: float


class Body(NamedTuple):
    """One link.

    Attributes:
        mass: [kg].
        com: centre of mass in the link frame [m].
        moments: (xx, yy, zz) about the centre of mass, in the axes of the link frame [kg m^2].
        products: (xy, xz, yz), the matrix elements [kg m^2].
    """

    mass: float
    com: tuple[float, float, float]
    moments: tuple[float, float, float]
    products: tuple[float, float, float] = (0.0, 0.0, 0.0)


CRAIG = (Row(0, 0, 0), Row(-1, 0, 0), Row(0, 0.4318, 0.15005), Row(-1, 0.0203, 0.4318), Row(1, 0, 0), Row(-1, 0, 0))
"""The geometry with the fewest lengths: a2, a3, d3, d4; shoulder offsets added up in d3, as axes 2 and 3 are parallel.
Layout of J. J. Craig, Introduction to Robotics; lengths of the arm as the Robotics Toolbox has them."""

AKB = (Row(0, 0, 0), Row(-1, 0, 0.2435), Row(0, 0.4318, -0.0934), Row(1, -0.0203, 0.4331), Row(-1, 0, 0), Row(1, 0, 0))
"""The geometry that the measured links are given in: frame 2 lies in the middle of the upper arm."""

ANY = (
    Body(13.0, (0.011, -0.036, -0.052), (0.420, 0.390, 0.160), (0.012, -0.008, 0.021)),
    Body(17.4, (0.068, 0.006, -0.016), (0.130, 0.524, 0.539), (0.009, -0.013, 0.007)),
    Body(4.8, (0.004, -0.070, 0.014), (0.081, 0.0195, 0.086), (0.003, -0.001, 0.002)),
    Body(0.82, (0.002, 0.003, -0.019), (1.8e-3, 1.7e-3, 1.3e-3), (8e-5, -6e-5, 5e-5)),
    Body(0.34, (0.001, -0.004, 0.002), (3.1e-4, 2.8e-4, 4.0e-4), (1.5e-5, -9e-6, 1.1e-5)),
    Body(0.09, (-0.001, 0.002, 0.032), (1.5e-4, 1.4e-4, 6.0e-5), (4e-6, -3e-6, 5e-6)),
)
"""Links with all ten inertial parameters; masses like the arm's, the rest chosen, not measured. Each is a possible
body: the largest principal moment is less than the sum of the others."""

MEASURED = (
    Body(0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.35)),
    Body(17.4, (0.068, 0.006, -0.016), (0.130, 0.524, 0.539)),
    Body(4.8, (0.0, -0.070, 0.014), (0.066, 0.0125, 0.086)),
    Body(0.82, (0.0, 0.0, -0.019), (1.8e-3, 1.8e-3, 1.3e-3)),
    Body(0.34, (0.0, 0.0, 0.0), (3e-4, 3e-4, 4e-4)),
    Body(0.09, (0.0, 0.0, 0.032), (1.5e-4, 1.5e-4, 4e-5)),
)
"""B. Armstrong, O. Khatib, J. Burdick, "The explicit dynamic model and inertial parameters of the PUMA 560 arm", IEEE
ICRA 1986, pp. 510-518, as read in the Robotics Toolbox for MATLAB, models/mdl_puma560akb.m; motors and gears left out.
Of link 1 only zz acts. Link 3 has zz 0.086 here, as models/mdl_puma560.m there says (as yy, its axes being turned);
the first file says 0.066. With 0.086 the moments of link 3 are not those of a possible body: 0.066 + 0.0125 < 0.086."""


def quarter_turns(count: int) -> Array:
    """Rx(count * 90 degrees), of exact zeros and ones."""
    c, s = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[count % 4]
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def arm(name: str, rows: tuple[Row, ...], bodies: tuple[Body, ...]) -> Model:
    """A serial arm of revolute joints, one body on each, on a base that stands still."""
    links, joints = [], []
    for i, (row, body) in enumerate(zip(rows, bodies, strict=True)):
        (xx, yy, zz), (xy, xz, yz) = body.moments, body.products
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        links.append(Link(f"link_{i + 1}", body.mass, np.array(body.com), inertia))
        R = quarter_turns(row.turns)
        p = np.array([row.a, 0.0, 0.0]) + row.d * R[:, 2]
        z = np.array([0.0, 0.0, 1.0])
        joints.append(Joint(f"joint_{i + 1}", REVOLUTE, parent=i - 1, R=R, p=p, axis=z))
    return Model(name, Link("base"), tuple(links), tuple(joints))


def general() -> Model:
    """The arm with links of any shape: no inertial parameter is zero, and none equals another of its link."""
    return arm("puma560_general", CRAIG, ANY)


def armstrong() -> Model:
    """The arm as measured by Armstrong, Khatib and Burdick, without motors and gears."""
    return arm("puma560_armstrong", AKB, MEASURED)
