"""Symbols, factors and products as printed, before anything is decided about what they mean."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

from rttrr_pin.auditing.reading.grammar import UnreadableError

LARGEST_POWER = 400
"""Of anything: no equation has a larger one."""


class DividesError(UnreadableError):
    """A symbol divides: the text is no polynomial; it may be a quotient of two."""

    def __init__(self, start: int) -> None:
        super().__init__("only numbers may divide here; write the quotient out as a product", start)


@dataclass(frozen=True, slots=True)
class Atom:
    """A symbol as printed, however it was spelled.

    Attributes:
        letters: the letter or letters, with the backslash of a Greek one.
        subscript: without blanks and without braces that print nothing.
        superscript: stars, primes and letters; powers are not part of a symbol.
        prefix: the superscript that stands before it.
        accents: dots and bars, the outermost first.
    """

    letters: str
    subscript: str = ""
    superscript: str = ""
    prefix: str = ""
    accents: tuple[str, ...] = ()

    def __str__(self) -> str:
        text = self.letters
        for accent in reversed(self.accents):
            text = f"{accent}{{{text}}}"
        prefix = f"{{}}^{braced(self.prefix)}" if self.prefix else ""
        subscript = f"_{braced(self.subscript)}" if self.subscript else ""
        primes = not self.superscript.strip("'")
        superscript = self.superscript if primes else f"^{braced(self.superscript)}"
        return f"{prefix}{text}{subscript}{superscript}"


def braced(text: str) -> str:
    """A script with the braces that it needs."""
    return text.strip() if len(text) == 1 else f"{{{text.strip()}}}"


@dataclass(frozen=True, slots=True)
class Group:
    """A bracket, or the numerator of a fraction.

    Attributes:
        products: the sum inside.
        start, end: where that sum stands.
        divisor: the sum in the denominator.
        abbreviated: the symbol that is printed for it; empty for what is printed itself.
        text: the text that it stands in, where that is another equation's; else empty.
    """

    products: tuple[Product, ...]
    start: int
    end: int
    divisor: tuple[Product, ...] = ()
    abbreviated: str = ""
    text: str = ""


@dataclass(frozen=True, slots=True)
class Named:
    """A symbol, or a sine or cosine with its angle, by name.

    Attributes:
        name: that the robot's symbols have, or one of its own where nothing declares it.
        unknown: the spelling where nothing declares it; else empty.
        note: what had to be decided to read it so.
        sign: -1 where the name is minus what is printed: sin(q_2 - q_1) is -sin(q_1 - q_2).
    """

    name: str
    unknown: str = ""
    note: str = ""
    sign: int = 1


@dataclass(frozen=True, slots=True)
class Factor:
    """One factor of a product.

    Attributes:
        body: what it is.
        start: where it stands.
        exponent: the power printed behind it; None where there is none.
        prefix: the superscript that stands before it.
        operator: the operator printed before it: "", "*" or "/".
        symbol: it has been decided that a `c` or `s` is a symbol, not a function.
    """

    body: Atom | Named | Fraction | Group
    start: int
    exponent: int | None = None
    prefix: str = ""
    operator: str = ""
    symbol: bool = False

    @property
    def power(self) -> int:
        """The exponent; 1 where none is printed."""
        return 1 if self.exponent is None else self.exponent

    def check_power(self) -> None:
        """Raises DividesError where it divides, UnreadableError where its power is none of a symbol or bracket."""
        if self.operator == "/":
            raise DividesError(self.start)
        if not 0 <= self.power <= LARGEST_POWER:
            message = f"wanted a power from 0 to {LARGEST_POWER}, got {self.power}; write the power out"
            raise UnreadableError(message, self.start)

    @property
    def atom(self) -> Atom | None:
        """The symbol with its prefix; None where it is no symbol."""
        return replace(self.body, prefix=self.prefix) if isinstance(self.body, Atom) else None


@dataclass(frozen=True, slots=True)
class Product:
    """One term of a sum.

    Attributes:
        signs: the signs before it, 1 or -1, a tuple for each line that has some.
        factors: in printed order.
        start, end: where it stands, from its last line's sign on.
    """

    signs: tuple[tuple[int, ...], ...]
    factors: tuple[Factor, ...]
    start: int
    end: int

    @property
    def enclosed(self) -> tuple[Product, ...]:
        """The sum in a bracket that stands alone, so that it multiplies nothing; empty where none does."""
        factor = self.factors[0]
        alone = len(self.factors) == 1 and not self.signs and not factor.prefix and factor.exponent is None
        group = factor.body if alone and isinstance(factor.body, Group) else None
        return group.products if group is not None and not group.divisor else ()
