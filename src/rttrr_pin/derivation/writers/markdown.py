"""Documents as Markdown with mathematics: formulas in lines, in `$$` blocks and in fences; changed terms boxed."""

from __future__ import annotations

import re
from collections.abc import Iterable

from rttrr_pin.derivation.writers import document as doc

WIDTH = 90
"""About how many signs of a formula stand in one line."""

MOST_LINES = 16
"""Of one block of equations: renderers in browsers give up on long ones."""


def markdown(document: doc.Document, formula: str = "${}$") -> str:
    """A document as Markdown.

    Args:
        document: what to write.
        formula: how a formula within a line is written. "$`{}`$" is GitHub's way for formulas that mean something to
            Markdown too; other renderers do not have it.
    """

    def block_text(block: doc.Block) -> str:
        match block:
            case doc.Heading(words, level):
                return f"{'#' * (level + 1)} {_escaped(words)}"
            case doc.Paragraph(text):
                return line(text)
            case doc.Bullets(items):
                return "\n".join(f"- {line(item)}" for item in items)
            case doc.Table(heads, rows):
                cells = [[line(cell).replace("|", r"\|") for cell in row] for row in rows]
                return "\n".join([_row(heads), _row("---" for _ in heads), *map(_row, cells)])
            case doc.Display():
                return _display(block)
            case doc.Equations():
                return "\n\n".join(
                    "\n".join(("$$", r"\begin{aligned}", " \\\\\n".join(lines), r"\end{aligned}", "$$"))
                    for lines in block.aligned(MOST_LINES, split=True)
                )

    def line(text: doc.Text) -> str:
        return doc.written(text, _escaped, "**{}**".format, formula.format, _code)

    return "\n\n".join([f"# {_escaped(document.title)}", *map(block_text, document.blocks)]) + "\n"


def _row(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _escaped(text: str) -> str:
    """Text without what means something to Markdown; an underscore within a word means nothing."""
    return re.sub(r"([\\`*\[\]<>$]|(?<![^\W_])_|_(?![^\W_]))", r"\\\1", text.replace("\n", " "))


def _code(text: str) -> str:
    fence = _fence(text, 1)
    space = " " if "`" in text else ""
    return f"{fence}{space}{' '.join(text.split())}{space}{fence}"


def _fence(text: str, least: int) -> str:
    """More backticks than a text has in a row."""
    return "`" * max(least, 1 + max(map(len, re.findall("`+", text)), default=0))


def _display(display: doc.Display) -> str:
    if display.code:
        fence = _fence(display.program(), 3)
        return f"{fence}python\n{display.program()}\n{fence}"
    lines, length = [""], 0
    for text, changed in display.terms:
        size = len(re.sub(r"\\[A-Za-z]+|[\\{}^_,\s]", "", text)) * 2
        if length and length + size > WIDTH:
            lines.append("")
            length = 0
        lines[-1] += rf" \boxed{{{text}}}" if changed else f" {text}"
        length += size
    body = " \\\\\n".join(f"&{line}" for line in lines)
    return f"```math\n\\begin{{aligned}}\n{display.left} ={{}} {body}\n\\end{{aligned}}\n```"
