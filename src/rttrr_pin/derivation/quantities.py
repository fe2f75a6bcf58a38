"""What can be derived: for each quantity what it depends on, how many entries it has, and what each is called."""

from __future__ import annotations

import enum
from collections.abc import Mapping
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
        form: what an entry is called in LaTeX; i and j are its numbers, i_ the first as a script, x its axis.
    """

    extent: Extent
    inputs: str
    payload: bool
    meaning: str
    unit: str
    form: str

    def latex(self, at: Index) -> str:
        """What an entry is called, by its index from 0."""
        axis = AXES[at[1]] if self.extent is Extent.LINKS else ""
        return self.form.format(i=at[0] + 1, i_=index(at[0] + 1), j=at[-1] + 1, x=axis)

    @property
    def sentence(self) -> str:
        """The meaning with a capital letter."""
        return self.meaning[0].upper() + self.meaning[1:]


LINKS, JOINTS, PAIRS = Extent.LINKS, Extent.JOINTS, Extent.PAIRS

QUANTITIES: Mapping[str, Quantity] = {
    "v_dot_C": Quantity(
        LINKS,
        "qva",
        False,
        "acceleration of the centre of mass of each link, gravity included",
        "m/s^2",
        r"{{}}^{i_}\dot{{v}}_{{C_{{{i}{x}}}}}",
    ),
    "F": Quantity(LINKS, "qva", False, "net force on each link", "N", "{{}}^{i_}F_{x}"),
    "N": Quantity(LINKS, "qva", False, "net moment on each link about its centre of mass", "N m", "{{}}^{i_}N_{x}"),
    "f": Quantity(LINKS, "qva", True, "force that the link before exerts on each link", "N", "{{}}^{i_}f_{x}"),
    "n": Quantity(
        LINKS,
        "qva",
        True,
        "moment that the link before exerts on each link, about the origin of the link's frame",
        "N m",
        "{{}}^{i_}n_{x}",
    ),
    "tau": Quantity(
        JOINTS,
        "qva",
        True,
        "driving force of each joint: the component of n or f along its axis, plus joint friction and armature",
        "N m or N",
        r"\tau_{i_}",
    ),
    "M": Quantity(PAIRS, "q", False, "mass matrix, armature included", "kg m^2, kg m or kg", "M_{{{i},{j}}}"),
    "C": Quantity(
        PAIRS,
        "qv",
        False,
        "Coriolis and centrifugal matrix, of Christoffel symbols",
        "N m s, N s or kg/s",
        "C_{{{i},{j}}}",
    ),
    "g": Quantity(JOINTS, "q", False, "driving force that holds the robot still", "N m or N", "g_{i_}"),
}
"""By name; all vectors of links are in the link's own frame {i}."""

DEFAULT = ("n", "tau", "M", "C", "g")
"""What the paper left out, and what comes next."""
