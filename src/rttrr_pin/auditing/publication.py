"""A publication: its equations as printed, the symbols that they assume, and the robot they are about."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

from rttrr_pin.auditing.reading.abbreviations import collected, defined_in_latex
from rttrr_pin.auditing.reading.nodes import Atom, Group
from rttrr_pin.auditing.reading.python import defined_in_python
from rttrr_pin.auditing.reading.vocabulary import Vocabulary
from rttrr_pin.core.arrays import Rebuilt
from rttrr_pin.derivation.symbolic_robot import SymbolicRobot
from rttrr_pin.derivation.symbols import ACCELERATION, FORCE, LENGTH, MOMENT, Dimension, Role

DEFINITION = "definition"
"""The quantity of an equation that only defines symbols."""

NAME = re.compile(r"([A-Za-z]+?)(\d+)(?:([xyz])|,(\d+))?")
"""Of a component."""


@dataclass(frozen=True, slots=True)
class Equation:
    """One numbered equation.

    Attributes:
        number: as printed.
        quantity: vC, F, N, f, n, tau, M, C, g, a; or "definition".
        index: index of the link, or of the joint; -1 for a definition, and where there are several.
        components: which axes, such as "xyz" or "z"; empty for a scalar.
        texts: the text as printed, whole, or one for each component.
        line: where it starts in the published text; 0 where that is not known.
        indices: those where it states more than one; else empty.
        columns: of an equation about entries of a matrix, indices of their columns; else empty.
    """

    number: int | str
    quantity: str
    index: int
    components: str
    texts: tuple[str, ...]
    line: int = 0
    indices: tuple[int, ...] = ()
    columns: tuple[int, ...] = ()

    @property
    def names(self) -> list[str]:
        """Its components as reports name them: F5z, tau2, M1,2."""
        if self.quantity == DEFINITION:
            return []
        endings = [f",{column + 1}" for column in self.columns] or self.components or ("",)
        return [f"{self.quantity}{index + 1}{end}" for index in self.indices or (self.index,) for end in endings]


def parts_of(name: str) -> tuple[str, int, str]:
    """Quantity, index and what follows it, of a component's name: ("F", 4, "z"), ("M", 0, "2")."""
    quantity, number, axis, column = NAME.fullmatch(name).groups(default="")  # type: ignore[union-attr]
    return quantity, int(number) - 1, axis or column


def component_of(name: str, quantities: Mapping[str, Any]) -> Any:
    """One component by its name, such as F5z or tau2, of quantities that have a value for each link or joint."""
    quantity, index, end = parts_of(name)
    value = quantities[quantity][index]
    if end.isdecimal():
        return value[int(end) - 1]
    return tuple(value)["xyz".index(end)] if end else value


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
class Publication(Rebuilt):
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
        passive: the joints that nothing drives, by index: their force is 0.
        definitions: the texts of equations that only define symbols.
    """

    title: str
    source: str
    language: str
    robot: SymbolicRobot
    spellings: Mapping[str, str]
    aliases: Mapping[str, str]
    equations: tuple[Equation, ...]
    conventions: tuple[Convention, ...]
    passive: tuple[int, ...] = ()
    definitions: tuple[str, ...] = ()

    @cached_property
    def vocabulary(self) -> Vocabulary:
        """The spellings as the LaTeX reader looks them up."""
        return Vocabulary(self.spellings)

    @cached_property
    def latex_abbreviations(self) -> Mapping[Atom, Group]:
        """What symbols stand for that only its definitions explain."""
        define = partial(defined_in_latex, vocabulary=self.vocabulary)
        return collected(self.definitions, define) if self.language == "latex" else {}

    @cached_property
    def python_abbreviations(self) -> Mapping[str, Group]:
        """The same for variables."""
        define = partial(defined_in_python, names=self.spellings)
        return collected(self.definitions, define) if self.language == "python" else {}

    @cached_property
    def gravity(self) -> Mapping[str, str]:
        """How each symbol of gravity is spelled, by name."""
        named = [symbol.name for symbol in self.robot.parameters.symbols if symbol.role is Role.GRAVITY]
        spelled = {name: text for text, name in reversed(list(self.spellings.items()))}
        return {name: spelled[name] for name in named if name in spelled}

    def dimension(self, name: str) -> Dimension:
        """The dimension that every term of a component should have."""
        quantity, index, end = parts_of(name)
        fixed = {"vC": ACCELERATION, "F": FORCE, "f": FORCE, "N": MOMENT, "n": MOMENT}
        if quantity in fixed:
            return fixed[quantity]
        rotations = self.robot.model.rotations
        force, acceleration, rate = MOMENT, Dimension(time=-2), Dimension(time=-1)
        if not rotations[index]:
            force, acceleration = FORCE, ACCELERATION
        if quantity in ("tau", "g"):
            return force
        if quantity == "a":
            return acceleration
        times = rate if quantity == "C" else Dimension(time=-2)
        if not rotations[int(end) - 1]:
            times = times.times(LENGTH)
        return force.times(times, -1)
