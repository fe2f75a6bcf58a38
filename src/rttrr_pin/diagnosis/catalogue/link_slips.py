"""What a program may make of a link's mass, centre of mass and tensor: known slips, as data."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from rttrr_pin.core.algebra import Vector
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.inertia import point_tensor
from rttrr_pin.core.model import Link
from rttrr_pin.diagnosis.catalogue.altering import moving_axes, opposite_angles, symmetric
from rttrr_pin.inspection.readings import ORDERS
from rttrr_pin.urdf.inertial import ENTRIES
from rttrr_pin.urdf.inertial import symmetric as from_entries

Slipped = Callable[[Link, Array], Link]
"""The link as the program has it, beside R of its inertial frame in the link frame, (3, 3)."""

SLOTS = " ".join(ENTRIES)


@dataclass(frozen=True, slots=True)
class LinkSlip:
    """A known slip.

    Attributes:
        id: what it is called.
        sentence: what the program does to `{link}`.
        repair: what to do about it; `{kg}` is the mass of the link, where there is one link.
        slipped: the link as the program has it.
        everywhere: whether it may be made at every link at once.
        turned: whether it takes a turned inertial frame.
        family: slips that one name is enough for, where they come to the same numbers; empty for none.
    """

    id: str
    sentence: str
    repair: str
    slipped: Slipped
    everywhere: bool = True
    turned: bool = False
    family: str = ""


def _tensor(change: Callable[[Array], Array], in_link: bool = False) -> Slipped:
    """Changes the tensor in the axes of the inertial frame, as the file has it, or in those of the link."""

    def slipped(link: Link, R: Array) -> Link:
        own = np.eye(3) if in_link else R
        return replace(link, inertia=symmetric(own @ change(own.T @ link.inertia @ own) @ own.T))

    return slipped


def _turned(other: Callable[[Array], Array]) -> Slipped:
    """Turns the tensor of the file by another rotation than that of the inertial frame."""

    def slipped(link: Link, R: Array) -> Link:
        own = other(R) @ R.T
        return replace(link, inertia=symmetric(own @ link.inertia @ own.T))

    return slipped


def _com(change: Callable[[Array], Array]) -> Slipped:
    """Changes the centre of mass; the tensor about it stays."""
    return lambda link, R: replace(link, com=change(link.com))


def _parallel(sign: float) -> Slipped:
    """Adds or takes away m (c.c 1 - c c^T) once more."""

    def slipped(link: Link, R: Array) -> Link:
        steiner = link.mass * point_tensor(Vector.of(link.com)).array
        return replace(link, inertia=symmetric(link.inertia + sign * steiner))

    return slipped


def _dropped(link: Link, R: Array) -> Link:
    return Link(link.name)


def _scaled(link: Link, R: Array, factor: float) -> Link:
    return replace(link, mass=factor * link.mass, inertia=factor * link.inertia)


def _products(factor: float) -> Callable[[Array], Array]:
    return lambda J: factor * J + (1.0 - factor) * np.diag(J.diagonal())


def _by_rows(J: Array) -> Array:
    """Xx xy xz yx yy yz in the slots of xx xy xz yy yz zz."""
    return np.array(from_entries(dict(zip(ENTRIES, J[:2].ravel().tolist(), strict=True))))


def _permuted(names: tuple[str, ...]) -> Callable[[Array], Array]:
    """What the slots from ixx to izz hold, in turn."""
    return lambda J: np.array(from_entries({slot: J[ENTRIES[own]] for slot, own in zip(ENTRIES, names, strict=True)}))


def _orders() -> tuple[tuple[str, ...], ...]:
    """Known orders of the six slots, and that which each takes back to the file's."""
    orders = [tuple(order.split()) for order in ORDERS]
    back = [tuple(dict(zip(order, ENTRIES, strict=True))[slot] for slot in ENTRIES) for order in orders]
    return tuple(dict.fromkeys((*orders, *back)))


def _sign(axis: int) -> Callable[[Array], Array]:
    return lambda c: np.where(np.arange(3) == axis, -c, c)


def _exchanged(order: list[int]) -> Callable[[Array], Array]:
    return lambda c: c[order]


AXES = "xyz"

WHOLE = (
    LinkSlip("link ignored", "the mass and inertia of {link} are not counted", "count {link}{kg}", _dropped, False),
    LinkSlip(
        "link counted twice", "the mass and inertia of {link} are counted twice", "count {link} once",
        lambda link, R: _scaled(link, R, 2.0), False,
    ),
    LinkSlip(
        "mass ignored", "the mass of {link} is not counted, its tensor is", "count the mass of {link}{kg}",
        lambda link, R: replace(link, mass=0.0), False,
    ),
    LinkSlip(
        "inertia ignored", "the tensor of {link} is not counted: it is a point mass",
        "count the tensor of {link} about its centre of mass", lambda link, R: replace(link, inertia=np.zeros((3, 3))),
    ),
)  # fmt: skip

CENTRE = (
    LinkSlip(
        "COM ignored", "the mass of {link} is taken to be at the origin of its frame",
        "use the centre of mass of {link}", _com(lambda c: 0.0 * c),
    ),
    LinkSlip(
        "COM negated", "the centre of mass of {link} has the opposite sign",
        "negate the centre of mass of {link}: it points from the origin of the frame to it", _com(lambda c: -c),
    ),
    *(
        LinkSlip(
            f"COM of opposite {AXES[k]}", f"{AXES[k]} of the centre of mass of {{link}} has the opposite sign",
            f"negate {AXES[k]} of the centre of mass of {{link}}", _com(_sign(k)),
        )
        for k in range(3)
    ),
    *(
        LinkSlip(
            f"COM with {AXES[j]} and {AXES[k]} exchanged",
            f"{AXES[j]} and {AXES[k]} of the centre of mass of {{link}} are exchanged",
            f"exchange {AXES[j]} and {AXES[k]} of the centre of mass of {{link}}",
            _com(_exchanged([{j: k, k: j}.get(i, i) for i in range(3)])),
        )
        for j, k in ((0, 1), (0, 2), (1, 2))
    ),
)  # fmt: skip

TENSOR = (
    LinkSlip(
        "products of inertia negated", "the products of inertia of {link} have the opposite sign",
        "negate ixy, ixz and iyz of {link}", _tensor(_products(-1.0)),
    ),
    LinkSlip(
        "products of inertia ignored", "the products of inertia of {link} are not counted",
        "use ixy, ixz and iyz of {link}", _tensor(_products(0.0)),
    ),
    LinkSlip(
        "products of inertia negated in link axes",
        "the products of inertia of {link}, turned to the axes of the link, have the opposite sign",
        "negate the products of inertia of {link}", _tensor(_products(-1.0), in_link=True), turned=True,
    ),
    LinkSlip(
        "products of inertia ignored in link axes",
        "the products of inertia of {link}, turned to the axes of the link, are not counted",
        "use the products of inertia of {link}", _tensor(_products(0.0), in_link=True), turned=True,
    ),
    LinkSlip(
        "parallel axes twice",
        "the tensor of {link} about the origin of its frame is taken for that about the centre of mass",
        "add m (c.c 1 - c c^T) to the tensor of {link} once", _parallel(1.0),
    ),
    LinkSlip(
        "parallel axes ignored",
        "the tensor of {link} about its centre of mass is taken for that about the origin of its frame",
        "add m (c.c 1 - c c^T) to the tensor of {link}", _parallel(-1.0),
    ),
    LinkSlip(
        "inertial rpy ignored", "the tensor of {link} is not turned by the rpy of its inertial frame",
        "turn the tensor of {link}: R I R^T, R of the rpy of its inertial frame", _turned(lambda R: np.eye(3)),
        turned=True,
    ),
    LinkSlip(
        "inertial rpy transposed", "the tensor of {link} is turned by R^T I R, R of the rpy of its inertial frame",
        "turn the tensor of {link} by R I R^T", _turned(lambda R: R.T), turned=True,
    ),
    LinkSlip(
        "inertial rpy about moving axes",
        "the rpy of the inertial frame of {link} turns about moving axes x, y, z: R_x R_y R_z",
        "turn about fixed axes: R = R_z(yaw) R_y(pitch) R_x(roll)", _turned(moving_axes), turned=True,
    ),
    LinkSlip(
        "inertial rpy of opposite sign", "the angles of the inertial frame of {link} have the opposite sign",
        "negate the rpy of the inertial frame of {link}", _turned(opposite_angles), turned=True,
    ),
    LinkSlip(
        "tensor by rows", "of the tensor of {link} the first six of nine entries by rows stand in six slots",
        f"fill the slots {SLOTS} of {{link}}, in this order", _tensor(_by_rows), family="slots",
    ),
    *(
        LinkSlip(
            f"tensor as {' '.join(order)}", f"of {{link}} the slots {SLOTS} hold, in turn, {' '.join(order)}",
            f"fill the slots {SLOTS} of {{link}}, in this order", _tensor(_permuted(order)), family="slots",
        )
        for order in _orders()
    ),
)  # fmt: skip

LINK_SLIPS = (*WHOLE, *CENTRE, *TENSOR)
"""Those made at one link, or at every one."""
