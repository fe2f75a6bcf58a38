"""A publication: its equations as printed, the symbols that they assume, and the robot they are about."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from rttrr_pin.auditing.reading.vocabulary import Vocabulary
from rttrr_pin.derivation.symbolic_robot import SymbolicRobot
from rttrr_pin.derivation.symbols import ACCELERATION, FORCE, MOMENT, Dimension

DEFINITION = "definition"
"""The quantity of an equation that only defines symbols."""


@dataclass(frozen=True, slots=True)
class Equation:
    """One numbered equation.

    Attributes:
        number: as printed.
        quantity: vC, F, N, f, n, tau; or "definition".
        place: index of the link, or of the joint for tau; -1 for a definition.
        components: which axes, such as "xyz" or "z"; empty for a scalar.
        texts: the text as printed, whole, or one for each component.
        line: where it starts in the published text; 0 where that is not known.
    """

    number: int | str
    quantity: str
    place: int
    components: str
    texts: tuple[str, ...]
    line: int = 0

    @property
    def names(self) -> list[str]:
        """Its components as reports name them: F5z, tau2."""
        if self.quantity == DEFINITION:
            return []
        return [f"{self.quantity}{self.place + 1}{axis}" for axis in self.components or ("",)]


def component_of(name: str, quantities: Mapping[str, Any]) -> Any:
    """One component by its name, such as F5z or tau2, of quantities that have a value for each link or joint."""
    quantity, number, axis = re.fullmatch(r"([A-Za-z]+?)(\d+)([xyz]?)", name).groups()  # type: ignore[union-attr]
    value = quantities[quantity][int(number) - 1]
    return tuple(value)["xyz".index(axis)] if axis else value


@dataclass(frozen=True, slots=True)
class Convention:
    """What the text leaves to the reader, and how it is read.

    Attributes:
        title: what it is about.
        text: how it is read.
        equations: the numbers of the equations that it concerns.
        flip: symbols that have the other sign in the other way to read it; empty where there is no other way to try.
    """

    title: str
    text: str
    equations: tuple[int | str, ...] = ()
    flip: tuple[str, ...] = ()


@dataclass(frozen=True)
class Publication:
    """Equations with all that they assume.

    Attributes:
        title: of the publication.
        source: where it was published.
        language: "latex" or "python".
        robot: the robot in its symbols.
        spellings: the name of the symbol that each spelling stands for.
        aliases: symbols that are kept apart from one that they are equal to, as J_yx is from J_xy.
        equations: as printed, in order.
        conventions: what the text leaves to the reader.
    """

    title: str
    source: str
    language: str
    robot: SymbolicRobot
    spellings: Mapping[str, str]
    aliases: Mapping[str, str]
    equations: tuple[Equation, ...]
    conventions: tuple[Convention, ...]

    @cached_property
    def vocabulary(self) -> Vocabulary:
        """The spellings as the LaTeX reader looks them up."""
        return Vocabulary(self.spellings)

    def dimension(self, equation: Equation) -> Dimension:
        """The dimension that every term of an equation should have."""
        if equation.quantity == "tau":
            rotations = [rotation for joint in self.robot.model.moving for rotation in joint.type.rotations]
            return MOMENT if rotations[equation.place] else FORCE
        return {"vC": ACCELERATION, "F": FORCE, "f": FORCE, "N": MOMENT, "n": MOMENT}[equation.quantity]
