"""A publication: its equations as printed, the symbols that they assume, and the robot they are about."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from rttrr_pin.auditing.printed import Split
from rttrr_pin.auditing.reading.latex import read_latex
from rttrr_pin.auditing.reading.python import read_python
from rttrr_pin.auditing.reading.vocabulary import Vocabulary
from rttrr_pin.derivation.chain import Letters, SymbolicRobot
from rttrr_pin.derivation.symbols import renamed

DEFINITION = "definition"
"""The quantity of an equation that only says what letters mean."""


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


@dataclass(frozen=True, slots=True)
class Convention:
    """What the text leaves to the reader, and how it is read.

    Attributes:
        title: what it is about.
        text: how it is read.
        equations: the numbers of the equations that it concerns.
        flip: letters that have the other sign in the other way to read it; empty where there is no other way to try.
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
        robot: the robot in its letters.
        spellings: the name of the symbol that each spelling stands for.
        twins: letters that are kept apart from one that they are equal to, as J_yx is from J_xy.
        equations: as printed, in order.
        conventions: what the text leaves to the reader.
    """

    title: str
    source: str
    language: str
    robot: SymbolicRobot
    spellings: Mapping[str, str]
    twins: Mapping[str, str]
    equations: tuple[Equation, ...]
    conventions: tuple[Convention, ...]

    @cached_property
    def apart(self) -> SymbolicRobot | None:
        """The robot with the letters below the diagonal of its tensors kept apart; None where the text does not."""
        if not self.twins:
            return None
        letters = self.robot.letters
        other = {main: twin for twin, main in self.twins.items()}
        slots = dict(letters.slots)
        for slot, terms in letters.slots.items():
            if slot[0] == "inertia" and str(slot[2]) > str(slot[3]):
                slots[slot] = renamed(terms, other)
        named = {symbol.name: symbol for symbol in letters.symbols}
        new = [replace(named[main], name=twin, latex=self.spelling_of(twin)) for twin, main in self.twins.items()]
        values = {**letters.values, **{twin: letters.values[main] for twin, main in self.twins.items()}}
        return replace(self.robot, letters=Letters((*letters.symbols, *new), slots, values))

    def spelling_of(self, name: str) -> str:
        """How a symbol is printed."""
        return next(spelling for spelling, stands_for in self.spellings.items() if stands_for == name)

    @cached_property
    def vocabulary(self) -> Vocabulary:
        """The spellings as the LaTeX reader looks them up."""
        return Vocabulary(self.spellings)

    @cached_property
    def notation(self) -> Mapping[str, str]:
        """How the text spells each symbol that it has, by name: as it is printed first."""
        found: dict[str, str] = {}
        for equation in self.equations:
            components = self.read(equation)[0].components if equation.quantity != DEFINITION else ()
            for name, spelling in (pair for component in components for pair in component.spellings):
                found.setdefault(name, spelling)
        return found

    @cached_property
    def _done(self) -> dict[Equation, tuple[Split, ...]]:
        """What has been read."""
        return {}

    def read(self, equation: Equation) -> tuple[Split, ...]:
        """The terms of an equation; several ways where its text does not show where components end."""
        if equation not in self._done:
            self._done[equation] = self._read(equation)
        return self._done[equation]

    def _read(self, equation: Equation) -> tuple[Split, ...]:
        count = max(1, len(equation.components))
        if self.language == "latex" and len(equation.texts) == 1:
            return read_latex(equation.texts[0], self.vocabulary, count)
        if self.language == "latex":
            one = [read_latex(text, self.vocabulary, 1)[0].components[0] for text in equation.texts]
            return (Split(tuple(one)),)
        return (Split(tuple(read_python(text, self.spellings) for text in equation.texts)),)
