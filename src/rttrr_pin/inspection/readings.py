"""What else the numbers of a tensor may mean: known slips of exporters and hands (`causes.py` finds the one made)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from rttrr_pin.core.algebra import Vector
from rttrr_pin.core.arrays import Array, rotation
from rttrr_pin.core.inertia import point_tensor
from rttrr_pin.inspection.cases import Case, distance
from rttrr_pin.inspection.exact import DIAGONAL, nearest_possible
from rttrr_pin.urdf.inertial import ENTRIES, Placement, symmetric

DUST = 1e-12, 1e-14
"""Of the largest entry; and of the mass, in m^2, a radius of gyration of 100 nm: rounding of zero."""

CUT = 0.1
"""By how much, at least, a tensor differs from the one that it is cut from."""

SLIGHT = (0.01, 100.0)
"""Between them, a factor may be that of the link and not of its unit, unless its shape is exact."""

ROUND = 1e-4
"""How near a length is to one of three digits to be that."""

TENSOR_UNITS = {
    "g mm^2": 1e-9,
    "g cm^2": 1e-7,
    "kg mm^2": 1e-6,
    "kg cm^2": 1e-4,
    "g m^2": 1e-3,
    "lb in^2": 0.45359237 * 0.0254**2,
    "lb ft^2": 0.45359237 * 0.3048**2,
}
"""How many kg m^2 each is."""

MASS_UNITS = {"g": 1e-3, "lb": 0.45359237}
"""How many kg each is."""

ORDERS = (
    *(" ".join((a, "ixy", "ixz", b, "iyz", c)) for a, b, c in list(permutations(DIAGONAL))[1:]),
    "ixx iyz ixz iyy ixy izz",
    "ixx ixz ixy iyy iyz izz",
    "ixx ixy iyz iyy ixz izz",
    "ixx iyy izz ixy ixz iyz",
    "ixx iyy izz iyz ixz ixy",
    "ixx iyy izz ixy iyz ixz",
    "ixx ixy iyy ixz iyz izz",
)
"""What the slots ixx, ixy, ixz, iyy, iyz, izz hold: moments or products exchanged, moments first, by columns."""


@dataclass(frozen=True, eq=False)
class Variant:
    """A tensor that the numbers may mean.

    Attributes:
        meaning: what is the case then, in a sentence.
        tensor: about the centre of mass, in link axes, (3, 3) [kg m^2]; None where the numbers mean no body's.
        mass: what the mass is multiplied by.
        sure: whether nothing else explains an exact match: a factor of 1000 may be the mass's, slots the drawing's.
        slight: whether the change is less than what tells a link from its filled hull.
    """

    meaning: str
    tensor: Array | None
    mass: float = 1.0
    sure: bool = False
    slight: bool = False


@dataclass(frozen=True)
class Reading:
    """A known slip.

    Attributes:
        name: in one word.
        variants: what the numbers of a link mean if it was made.
    """

    name: str
    variants: Callable[[Case], Iterator[Variant]]


def _turned(case: Case, tensor: Array) -> Array:
    """From the axes of the inertial frame to those of the link."""
    R = case.inertial.origin.R
    return np.asarray(R @ tensor @ R.T)


def _few_digits(value: float) -> bool:
    """Whether one or two digits write it."""
    return len(repr(value).split("e")[0].replace(".", "").strip("-0")) <= 2


def placeholder(case: Case) -> Iterator[Variant]:
    """Three equal moments of one or two digits, and products that are zero, or equal to them."""
    numbers = {float(number) for name, number in case.inertial.entries.items() if name in DIAGONAL}
    products = {float(number) for name, number in case.inertial.entries.items() if name not in DIAGONAL}
    if len(numbers) == 1 and products in ({0.0}, numbers):
        value = numbers.pop()
        if _few_digits(value):
            which = "three moments" if products == {0.0} else "six entries"
            yield Variant(f"all {which} are {value:g}, which is a placeholder", None)


def dust(case: Case) -> Iterator[Variant]:
    """Entries that are the rounding of zero."""
    tensor = case.inertial.tensor
    floor = max(DUST[0] * float(np.abs(tensor).max()), DUST[1] * (abs(case.mass) or 1.0))
    if ((tensor != 0.0) & (np.abs(tensor) < floor)).any():
        cleaned = np.where(np.abs(tensor) < floor, 0.0, tensor)
        which = "what is below" if cleaned.any() else "all of it is below"
        yield Variant(f"{which} {floor:.1g} kg m^2 and means zero", _turned(case, cleaned))


def rows(case: Case) -> Iterator[Variant]:
    """The first six of nine entries by rows: xx, xy, xz, yx, yy, yz; zz is lost, and the larger of the others here."""
    xx, xy, xz, yx, yy, yz = (float(case.inertial.entries[name]) for name in ENTRIES)
    if xy == yx and not _few_digits(xy):
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, max(xx, yy)]])
        yield Variant(
            "the six slots hold the first six of the nine entries by rows, xx xy xz yx yy yz, and izz is lost",
            _turned(case, tensor),
        )


def unit(case: Case) -> Iterator[Variant]:
    """Tensor or mass in another unit."""
    for name, factor in TENSOR_UNITS.items():
        yield Variant(
            f"the inertia is in {name} and not in kg m^2", case.inertial.inertia * factor,
            sure=factor <= 1e-6, slight=SLIGHT[0] < factor < SLIGHT[1],
        )  # fmt: skip
    for name, factor in MASS_UNITS.items():
        yield Variant(
            f"the mass is in {name} and not in kg",
            case.inertial.inertia,
            mass=factor,
            slight=SLIGHT[0] < factor < SLIGHT[1],
        )


def sign(case: Case) -> Iterator[Variant]:
    """Products of inertia as positive integrals, where URDF wants the entries of the matrix."""
    tensor = case.inertial.tensor
    yield Variant(
        "the products of inertia have the other sign", _turned(case, 2.0 * np.diag(tensor.diagonal()) - tensor)
    )


def axes(case: Case) -> Iterator[Variant]:
    """The tensor in the axes of the part, or turned the wrong way."""
    own = case.inertial.origin.R
    if case.inertial.origin.rotated:
        tensor = case.inertial.tensor
        yield Variant("the tensor is in the axes of the link already, and rpy turns it once more", tensor)
        yield Variant("the rpy of the inertial frame turns it the wrong way", own.T @ tensor @ own)
        back = _back(case.inertial.origin)
        yield Variant("the angles of the inertial frame have the wrong sign", back @ tensor @ back.T)
    for shape in case.link.shapes:
        if shape.origin.rotated:
            R, part = shape.origin.R, f"the {shape.role} {shape.tag}"
            turned = R @ case.inertial.inertia @ R.T
            yield Variant(f"the tensor is in the axes of {part}, whose rotation is lost", turned)
            yield Variant(f"the tensor is turned the wrong way out of the axes of {part}", R @ turned @ R.T)
            back = R @ _back(shape.origin).T
            meant = back @ case.inertial.inertia @ back.T
            yield Variant(f"the tensor is turned by the angles of {part} with the wrong sign", meant)


def _back(placement: Placement) -> Array:
    """The rotation by the angles with the other sign, which is the inverse where there is one angle."""
    return rotation([-angle for angle in placement.angles])


def origin(case: Case) -> Iterator[Variant]:
    """I - m (c.c 1 - c c^T) is about the centre of mass."""
    c = case.inertial.origin.p
    shifted = case.inertial.inertia - case.mass * point_tensor(Vector.of(c)).array
    yield Variant("the inertia is about the link's origin and not about the centre of mass", shifted, sure=True)


def order(case: Case) -> Iterator[Variant]:
    """Numbers in each other's slots."""
    values = [float(number) for number in case.inertial.entries.values()]
    for names in ORDERS:
        tensor = symmetric(dict(zip(names.split(), values, strict=True)))
        yield Variant(f"the slots from ixx to izz hold, in turn, {names}", _turned(case, np.array(tensor)))


def decimal(case: Case) -> Iterator[Variant]:
    """One entry with its decimal point one to three places off."""
    values = {name: float(number) for name, number in case.inertial.entries.items()}
    for name, value in values.items():
        for places in (-3, -2, -1, 1, 2, 3) if value else ():
            shifted = value * 10.0**places
            tensor = symmetric(values | {name: shifted})
            far = f"{abs(places)} place{'s' * (abs(places) > 1)}"
            yield Variant(
                f"{name} is {shifted:.7g}, and its decimal point is {far} off", _turned(case, np.array(tensor))
            )


def cut(case: Case) -> Iterator[Variant]:
    """Decimals cut: of all tensors that round to the numbers, that of a solid, or one that a body can have."""
    numbers = case.inertial.entries
    values = {name: float(number) for name, number in numbers.items()}
    halves = {name: float(number.half) for name, number in numbers.items()}
    finest = max((halves[name] for name in numbers if values[name]), default=0.0)
    may = {name: min(half, finest) for name, half in halves.items()}
    tensors, R = list[Array](), case.inertial.origin.R
    for solid in case.solids:
        wanted = R.T @ solid.inertia(case.mass) @ R
        if solid.exact:
            near = {name: _cut_from(values[name], float(wanted[at]), may[name]) for name, at in ENTRIES.items()}
            tensors.append(np.array(symmetric(near)))
    if not case.solids and not case.possible:
        possible = nearest_possible(case.inertial, coarse=True)
        tensors += [] if possible is None else [np.array(symmetric({name: float(x) for name, x in possible.items()}))]
    for tensor in tensors:
        if tensor.any() and distance(case.inertial.tensor, tensor) > CUT:
            yield Variant("its decimals are cut", _turned(case, tensor), slight=True)


def _cut_from(value: float, wanted: float, half: float) -> float:
    """The number nearest to the one wanted that becomes this value when it is rounded, or when its digits are cut."""
    low, high = (-half, 2.0 * half) if value > 0.0 else (-2.0 * half, half) if value < 0.0 else (-half, half)
    return value + min(max(wanted - value, low), high)


def size(case: Case) -> Iterator[Variant]:
    """A cylinder or box of other, round dimensions than those drawn."""
    tensor = case.inertial.tensor
    if case.mass > 0.0 and np.array_equal(tensor, np.diag(tensor.diagonal())):
        x, y, z = edges = np.sqrt(np.maximum(6.0 * (tensor.trace() - 2.0 * tensor.diagonal()) / case.mass, 0.0))
        for axis in range(3):
            across, other = np.delete(tensor.diagonal(), axis)
            radius = np.sqrt(2.0 * max(tensor[axis, axis], 0.0) / case.mass)
            length = np.sqrt(max(12.0 * across / case.mass - 3.0 * radius**2, 0.0))
            if across == other and _round(radius) and _round(length):
                yield Variant(f"it is that of a cylinder of radius {radius:.3g} m and length {length:.3g} m", None)
        if all(map(_round, edges)):
            yield Variant(f"it is that of a box of {x:.3g} x {y:.3g} x {z:.3g} m", None)


def _round(length: float) -> bool:
    """Whether three digits write it, and more would be zeros."""
    return length > 0.0 and abs(float(f"{length:.3g}") - length) < ROUND * length


READINGS = (
    (Reading("placeholder", placeholder),),
    (Reading("dust", dust),),
    (Reading("rows", rows),),
    (Reading("cut", cut),),
    (
        Reading("unit", unit),
        Reading("sign", sign),
        Reading("axes", axes),
        Reading("origin", origin),
        Reading("order", order),
        Reading("decimal", decimal),
    ),
    (Reading("size", size),),
)
"""In tiers: those that the digits themselves show come first, one by one; of a tier, exactly one must suit. Where two
come to the same tensor, the first is named. The tensor of a box to the digits counts before all."""
