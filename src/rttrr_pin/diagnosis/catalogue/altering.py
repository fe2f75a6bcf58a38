"""How hypotheses alter a program: one link or joint replaced, units told, the line of the file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from rttrr_pin.core.algebra import Matrix, Vector
from rttrr_pin.core.arrays import Array, angles_of, rotation
from rttrr_pin.core.inertia import SpatialInertia
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.model import Link, Model
from rttrr_pin.diagnosis.variants.variant import Variant
from rttrr_pin.urdf.document import UrdfDocument

TEN = 10
"""Inertial parameters of a link."""

SAME = 1e-12
"""Relative: numbers that differ by less are the same, and one of them is rounded."""

UNIT = 1e-3
"""Relative: how near a fitted factor is to that of a unit whose name is told."""

WORDS = {"a million": 1e6, "a millionth": 1e-6, "twice": 2.0, "half": 0.5, "the sign": -1.0}
"""Factors that have a name."""


def with_links(variant: Variant, links: Mapping[int, Link]) -> Variant:
    """The program with other links, by index."""
    own = tuple(links.get(i, link) for i, link in enumerate(variant.model.links))
    return replace(variant, model=replace(variant.model, links=own))


def with_joints(variant: Variant, indices: tuple[int, ...], change: Callable[[Joint], Joint]) -> Variant:
    """The program with some joints changed."""
    own = tuple(change(joint) if i in indices else joint for i, joint in enumerate(variant.model.joints))
    return replace(variant, model=replace(variant.model, joints=own))


def inertial_parameters(link: Link) -> Array:
    """m, m c, and the tensor about the origin of {i} of a link, (10,), as in `Robot.inertial_parameters`."""
    own = SpatialInertia.of(link.mass, Vector.of(link.com), Matrix.of(link.inertia))
    return np.array(own.parameters, dtype=np.float64)


def link_of(link: Link, parameters: Array) -> Link:
    """A link of such parameters, (10,)."""
    mass, *others = parameters.tolist()
    com, tensor = SpatialInertia.of_parameters((mass, *others)).about_com()
    return replace(link, mass=mass, com=np.array([*com], dtype=np.float64), inertia=symmetric(tensor.array))


def spread(model: Model, changes: Mapping[int, Array]) -> Array:
    """Changes of links, (10,), or (fitted, 10), as one of all parameters."""
    some = next(iter(changes.values()))
    total = np.zeros((*some.shape[:-1], TEN * len(model.links)))
    for i, change in changes.items():
        total[..., TEN * i : TEN * (i + 1)] = change
    return total


def moving_axes(R: Array) -> Array:
    """The rotation of the same roll, pitch and yaw about moving axes x, y, z."""
    roll, pitch, yaw = angles_of(R)
    return np.asarray(rotation((roll, 0, 0)) @ rotation((0, pitch, 0)) @ rotation((0, 0, yaw)))


def opposite_angles(R: Array) -> Array:
    """The rotation of roll, pitch and yaw of the opposite sign."""
    return rotation([-angle for angle in angles_of(R)])


def symmetric(tensor: Array) -> Array:
    """A tensor whose two halves are the same to the bit."""
    return np.asarray((tensor + tensor.T) / 2.0)


def differs(x: Array, y: Array, kinds: tuple[slice, ...] = (slice(None),)) -> bool:
    """Whether numbers differ by more than rounding of the largest of their kind."""
    a, b = x.ravel().tolist(), y.ravel().tolist()
    return any(_differ(a[kind], b[kind]) for kind in kinds)


def _differ(a: list[float], b: list[float]) -> bool:
    """The same of one kind; lists, since for few numbers they are faster than arrays."""
    if a == b:
        return False
    gap = max(abs(x - y) for x, y in zip(a, b, strict=True))
    return gap > SAME * max(map(abs, (*a, *b)))


def line_of(model: Model, link: str | None = None, joint: str | None = None) -> str:
    """The line of the file where a link or joint stands; empty where there is no file."""
    document = model.document
    if not isinstance(document, UrdfDocument) or document.made_from:
        return ""
    element = document.links.get(link or "") or document.joints.get(joint or "")
    return "" if element is None else f"line {element.line} of {document.source}"


def unit_of(factor: float, units: Mapping[str, float]) -> str:
    """The unit, or word, whose factor this is, or one over this; empty where there is none."""
    direct = (name for name, own in units.items() if abs(factor / own - 1.0) < UNIT)
    inverse = (name for name, own in units.items() if abs(factor * own - 1.0) < UNIT)
    return next(direct, next(inverse, ""))


def told_factor(factor: float, units: Mapping[str, float]) -> dict[str, float | str]:
    """A factor, and the unit that it is of."""
    unit = unit_of(factor, units)
    return {"factor": factor} | ({"unit": unit} if unit else {})


def with_gravity(variant: Variant, gravity: Array) -> Variant:
    """The program in another gravity field."""
    return replace(variant, model=variant.model.with_gravity(gravity))


def told_first(x: Sequence[float], units: Mapping[str, float]) -> dict[str, float | str]:
    """The same of the only number that is fitted."""
    return told_factor(float(x[0]), units)


def each_and_all(indices: Sequence[int]) -> list[tuple[int, ...]]:
    """Each by itself, then all of them where they are several."""
    return [*((i,) for i in indices), *([tuple(indices)] if len(indices) > 1 else [])]


def named(model: Model, indices: tuple[int, ...], every: str = "every joint") -> tuple[str | None, str]:
    """The joint's name, if it is one, and what a sentence calls them."""
    if len(indices) == 1:
        name = model.joints[indices[0]].name
        return name, name
    return None, every
