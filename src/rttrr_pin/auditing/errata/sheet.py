"""What an errata sheet is made of, whatever it is written in: blocks, and pieces of text in them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Words:
    """Plain text."""

    text: str
    strong: bool = False


@dataclass(frozen=True, slots=True)
class Formula:
    """LaTeX that every writer can set: see `typeset.settable`."""

    tex: str


@dataclass(frozen=True, slots=True)
class Code:
    """Text that stands as it is: Python, or LaTeX that cannot be set."""

    text: str


Piece = Words | Formula | Code
Line = tuple[Piece, ...]


@dataclass(frozen=True, slots=True)
class Heading:
    """A heading; level 1 is below the title."""

    text: str
    level: int = 1


@dataclass(frozen=True, slots=True)
class Paragraph:
    """Text."""

    line: Line


@dataclass(frozen=True, slots=True)
class Bullets:
    """A list."""

    lines: tuple[Line, ...]


@dataclass(frozen=True, slots=True)
class Table:
    """A table.

    Attributes:
        heads: of the columns.
        rows: of cells.
        widths: the share of the page that each column may take; none where all cells are short.
    """

    heads: tuple[str, ...]
    rows: tuple[tuple[Line, ...], ...]
    widths: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Display:
    """An equation over several lines: what it gives, and the terms with their signs.

    Attributes:
        left: the left-hand side.
        terms: each term, and whether it was changed.
        code: whether the text is no LaTeX that can be set.
    """

    left: str
    terms: tuple[tuple[str, bool], ...]
    code: bool


Block = Heading | Paragraph | Bullets | Table | Display


@dataclass(frozen=True, slots=True)
class Sheet:
    """An errata sheet."""

    title: str
    blocks: tuple[Block, ...]


def written(line: Sequence[Piece], words: Callable[[Words], str], formula: Callable[[str], str],
            code: Callable[[str], str]) -> str:  # fmt: skip
    """A line, with a function for each kind of piece."""
    parts = []
    for piece in line:
        match piece:
            case Words():
                parts.append(words(piece))
            case Formula(tex):
                parts.append(formula(tex))
            case Code(text):
                parts.append(code(text))
    return "".join(parts)


def program(display: Display) -> str:
    """An equation as code, a term a line, what was changed said in a comment."""
    terms = "\n".join(f"    {text}" + ("  # changed" if changed else "") for text, changed in display.terms)
    return f"{display.left} = (\n{terms}\n)"
