"""Documents, whatever they are written in: a title, blocks, and pieces of text in them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Strong:
    """Plain text that stands out."""

    text: str


@dataclass(frozen=True, slots=True)
class Formula:
    """LaTeX that every writer can set: see `typeset.settable`."""

    tex: str


@dataclass(frozen=True, slots=True)
class Code:
    """Text that stands as it is: Python, or LaTeX that cannot be set."""

    text: str


Piece = str | Strong | Formula | Code
Text = Piece | tuple[Piece, ...]


@dataclass(frozen=True, slots=True)
class Heading:
    """A heading; level 1 is below the title."""

    text: str
    level: int = 1


@dataclass(frozen=True, slots=True)
class Paragraph:
    """Text."""

    text: Text


@dataclass(frozen=True, slots=True)
class Bullets:
    """A list."""

    items: tuple[Text, ...]


@dataclass(frozen=True, slots=True)
class Table:
    """A table.

    Attributes:
        heads: of the columns.
        rows: of cells.
        widths: the share of the page that each column may take; none where all cells are short.
    """

    heads: tuple[str, ...]
    rows: tuple[tuple[Text, ...], ...]
    widths: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Display:
    """An equation whose terms are marked one by one.

    Attributes:
        left: the left-hand side.
        terms: each term with its sign, and whether it was changed.
        code: whether the text is no LaTeX that can be set.
    """

    left: str
    terms: tuple[tuple[str, bool], ...]
    code: bool

    def program(self) -> str:
        """The equation as code, a term a line, what was changed said in a comment."""
        terms = "\n".join(f"    {text}" + ("  # changed" if changed else "") for text, changed in self.terms)
        return f"{self.left} = (\n{terms}\n)"


@dataclass(frozen=True, slots=True)
class Equations:
    """Equations below each other, the signs of equality in a column.

    Attributes:
        equations: left-hand side, and lines of the right-hand side that fit a page.
    """

    equations: tuple[tuple[str, list[str]], ...]

    def aligned(self, most_lines: int, split: bool) -> Iterator[list[str]]:
        """The lines of aligned environments.

        Args:
            most_lines: of one environment.
            split: whether an equation that is longer than that goes on in the next.
        """
        block: list[str] = []
        for left, (first, *others) in self.equations:
            lines = [f"{left} ={{}}& {first}", *(f"& {line}" for line in others)]
            if block and len(block) + len(lines) > most_lines:
                yield block
                block = []
            while split and len(lines) > most_lines:
                yield lines[:most_lines]
                lines = lines[most_lines:]
            block += lines
        if block:
            yield block


Block = Heading | Paragraph | Bullets | Table | Display | Equations


@dataclass(frozen=True, slots=True)
class Document:
    """A document."""

    title: str
    blocks: tuple[Block, ...]


def pieces(text: Text) -> tuple[Piece, ...]:
    """The pieces of a text, be it one or several."""
    return text if isinstance(text, tuple) else (text,)


def written(
    text: Text,
    words: Callable[[str], str],
    strong: Callable[[str], str],
    formula: Callable[[str], str],
    code: Callable[[str], str],
) -> str:
    """A text, with a function for each type of piece."""
    parts = []
    for piece in pieces(text):
        match piece:
            case str():
                parts.append(words(piece))
            case Strong(inner):  # blanks stand outside: `**a **b` is not strong in Markdown
                parts.append(strong(words(inner.strip())) + inner[len(inner.rstrip()) :])
            case Formula(tex):
                parts.append(formula(tex))
            case Code(inner):
                parts.append(code(inner))
    return "".join(parts)
