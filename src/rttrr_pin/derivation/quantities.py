"""What can be derived: for each quantity what it depends on, how many entries it has, and what each is called."""

from __future__ import annotations

import enum
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from rttrr_pin.core.model import Model
from rttrr_pin.derivation.motion import index
from rttrr_pin.derivation.symbolic_robot import AXES

Index = tuple[int, ...]
"""Where an entry stands in its array, from 0."""


class Extent(enum.Enum):
    """What a quantity has entries for."""

    LINKS = "links, 3"
    JOINTS = "nv,"
    PAIRS = "nv, nv"

    def shape(self, model: Model) -> tuple[int, ...]:
        """Of the array for one state."""
        return {
            Extent.LINKS: (len(model.links), 3),
            Extent.JOINTS: (model.nv,),
            Extent.PAIRS: (model.nv, model.nv),
        }[self]


@dataclass(frozen=True, slots=True)
class Quantity:
    """A quantity that can be derived.

    Attributes:
        extent: what it has entries for.
        inputs: which of q, v, a it depends on.
        payload: whether the payload enters.
        meaning: in words.
        unit: of its entries.
        latex: what an entry is called, by its index from 0.
    """

    extent: Extent
    inputs: str
    payload: bool
    meaning: str
    unit: str
    latex: Callable[[Index], str]

    @property
    def sentence(self) -> str:
        """The meaning with a capital letter."""
        return self.meaning[0].upper() + self.meaning[1:]


def indices(shape: tuple[int, ...]) -> Iterator[Index]:
    """The indices of an array, the last axis fastest."""
    if len(shape) == 1:
        yield from ((i,) for i in range(shape[0]))
    else:
        yield from ((i, j) for i in range(shape[0]) for j in range(shape[1]))


def _of_link(name: str) -> Callable[[Index], str]:
    return lambda at: f"{{}}^{index(at[0] + 1)}{name}_{AXES[at[1]]}"


def _of_joint(name: str) -> Callable[[Index], str]:
    return lambda at: f"{name}_{index(at[0] + 1)}"


def _of_pair(name: str) -> Callable[[Index], str]:
    return lambda at: f"{name}_{{{at[0] + 1},{at[1] + 1}}}"


def _acceleration(at: Index) -> str:
    link = at[0] + 1
    return rf"{{}}^{index(link)}\dot{{v}}_{{C_{{{link}{AXES[at[1]]}}}}}"


LINKS, JOINTS, PAIRS = Extent.LINKS, Extent.JOINTS, Extent.PAIRS

QUANTITIES: Mapping[str, Quantity] = {
    "v_dot_C": Quantity(
        LINKS, "qva", False, "acceleration of the centre of mass of each link, gravity included", "m/s^2", _acceleration
    ),
    "F": Quantity(LINKS, "qva", False, "net force on each link", "N", _of_link("F")),
    "N": Quantity(LINKS, "qva", False, "net moment on each link about its centre of mass", "N m", _of_link("N")),
    "f": Quantity(LINKS, "qva", True, "force that the link before exerts on each link", "N", _of_link("f")),
    "n": Quantity(
        LINKS,
        "qva",
        True,
        "moment that the link before exerts on each link, about the origin of the link's frame",
        "N m",
        _of_link("n"),
    ),
    "tau": Quantity(
        JOINTS,
        "qva",
        True,
        "driving force of each joint: the component of n or f along its axis, plus joint friction and armature",
        "N m or N",
        _of_joint(r"\tau"),
    ),
    "M": Quantity(PAIRS, "q", False, "mass matrix, armature included", "kg m^2, kg m or kg", _of_pair("M")),
    "C": Quantity(
        PAIRS,
        "qv",
        False,
        "Coriolis and centrifugal matrix, of Christoffel symbols",
        "N m s, N s or kg/s",
        _of_pair("C"),
    ),
    "g": Quantity(JOINTS, "q", False, "driving force that holds the robot still", "N m or N", _of_joint("g")),
}
"""By name; all vectors of links are in the link's own frame {i}."""

DEFAULT = ("n", "tau", "M", "C", "g")
"""What the paper left out, and what comes next."""
