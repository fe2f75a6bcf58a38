"""The value of the read stage: an equation as its text has it, each term with every reading that is left open."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction

from rttrr_pin.derivation.symbols import Expression, Factors, Term, renamed_factors


@dataclass(frozen=True, slots=True)
class Reading:
    """One reading of a printed term: a coefficient times a product of symbols.

    Attributes:
        coefficient: with its sign.
        factors: names of symbols with their exponents; s^2 stays s^2.
        note: what had to be decided to read it so; empty where nothing had to be.
        unknown: spellings in the term that the table of symbols does not have, as printed.
    """

    coefficient: Fraction
    factors: Factors
    note: str = ""
    unknown: tuple[str, ...] = ()

    @property
    def term(self) -> Term:
        """Coefficient and product."""
        return self.coefficient, self.factors


@dataclass(frozen=True, slots=True)
class PrintedTerm:
    """One term of a sum; where the text has brackets, one term of what they expand to.

    Attributes:
        text: as printed, sign included.
        readings: the most literal first; more than one where a token is ambiguous or stray.
    """

    text: str
    readings: tuple[Reading, ...]

    @property
    def literal(self) -> Term:
        """The term by its most literal reading."""
        return self.readings[0].term

    def renamed(self, names: Mapping[str, str]) -> PrintedTerm:
        """The same term with other symbols in place of some."""
        readings = (replace(x, factors=renamed_factors(x.factors, names)) for x in self.readings)
        return replace(self, readings=tuple(readings))


ONE: Expression = {(): Fraction(1)}


@dataclass(frozen=True, slots=True)
class Quotient:
    """A quotient of two sums.

    Attributes:
        numerator, denominator: polynomials; s^2 stays s^2. Without a denominator it is a sum.
        unknown: spellings that the table of symbols does not have, as printed.
    """

    numerator: Expression
    denominator: Expression = field(default_factory=lambda: dict(ONE))
    unknown: tuple[str, ...] = ()

    @property
    def names(self) -> set[str]:
        """Of all symbols."""
        return {name for x in (self.numerator, self.denominator) for factors in x for name, _ in factors}


@dataclass(frozen=True, slots=True)
class PrintedComponent:
    """The right-hand side for one component.

    Attributes:
        text: as printed.
        terms: its terms in printed order; empty where it could not be read, and where it is a quotient.
        unparsed: why it could not be read, with the place; empty where it could.
        quotient: where symbols divide.
    """

    text: str
    terms: tuple[PrintedTerm, ...]
    unparsed: str = ""
    quotient: Quotient | None = None


@dataclass(frozen=True, slots=True)
class Split:
    """One way to divide a display into its components.

    Attributes:
        components: one for each component that the equation states.
        note: what had to be decided; empty where the text shows the boundaries.
    """

    components: tuple[PrintedComponent, ...]
    note: str = ""
