"""An equation as its text has it: terms, each with its readings where the text leaves room for more than one."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from rttrr_pin.derivation.symbols import Factors


@dataclass(frozen=True, slots=True)
class Reading:
    """What a printed term may say: a coefficient times a product of symbols.

    Attributes:
        coefficient: with its sign.
        factors: names of symbols with their exponents; s^2 stays s^2.
        note: what had to be decided to read it so, in words; empty where nothing had to be.
        unknown: spellings in the term that the table of symbols does not have, as printed.
    """

    coefficient: Fraction
    factors: Factors
    note: str = ""
    unknown: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class PrintedTerm:
    """One term of a sum; where the text has brackets, one term of what they expand to.

    Attributes:
        text: as printed, sign included.
        readings: the most literal first; more than one where a token is ambiguous or stray.
    """

    text: str
    readings: tuple[Reading, ...]


@dataclass(frozen=True, slots=True)
class PrintedComponent:
    """The right-hand side for one component.

    Attributes:
        text: as printed.
        terms: its terms in printed order; empty where it could not be read.
        unparsed: why it could not be read, with the place; empty where it could.
        spellings: names of symbols, each with the spelling that it has where it is printed first.
    """

    text: str
    terms: tuple[PrintedTerm, ...]
    unparsed: str = ""
    spellings: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class Split:
    """One way to divide a display into its components.

    Attributes:
        components: one for each component that the equation states.
        note: what had to be decided; empty where the text shows the boundaries.
    """

    components: tuple[PrintedComponent, ...]
    note: str = ""
