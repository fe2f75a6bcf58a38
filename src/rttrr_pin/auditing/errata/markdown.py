"""Errata sheets as Markdown with GitHub's mathematics: $`...`$ in lines, blocks fenced as math; changed terms boxed."""

from __future__ import annotations

import re
from collections.abc import Iterable

from rttrr_pin.auditing.errata.sheet import (
    Block,
    Bullets,
    Display,
    Heading,
    Line,
    Paragraph,
    Sheet,
    Table,
    Words,
    program,
    written,
)

WIDTH = 90
"""About how many signs of a formula stand in one line."""


def markdown(sheet: Sheet) -> str:
    """The sheet as Markdown."""
    blocks = [f"# {_escaped(sheet.title)}", *(_block(block) for block in sheet.blocks)]
    return "\n\n".join(blocks) + "\n"


def _block(block: Block) -> str:
    match block:
        case Heading(text, level):
            return f"{'#' * (level + 1)} {_escaped(text)}"
        case Paragraph(line):
            return _line(line)
        case Bullets(lines):
            return "\n".join(f"- {_line(line)}" for line in lines)
        case Table():
            return _table(block)
        case Display():
            return _display(block)


def _table(table: Table) -> str:
    rows = [
        _row(table.heads),
        _row("---" for _ in table.heads),
        *(_row(_line(cell).replace("|", r"\|") for cell in row) for row in table.rows),
    ]
    return "\n".join(rows)


def _row(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _line(line: Line) -> str:
    return written(line, _words, lambda tex: f"$`{tex}`$", _code)


def _words(words: Words) -> str:
    text = _escaped(words.text)
    return f"**{text.strip()}**{' ' if text.endswith(' ') else ''}" if words.strong else text


def _escaped(text: str) -> str:
    text = text.replace("\n", " ")
    return re.sub(r"([\\`*_\[\]<>$])", r"\\\1", text)


def _code(text: str) -> str:
    """Text between more backticks than it has in a row."""
    most = max((len(run) for run in re.findall("`+", text)), default=0)
    fence = "`" * (most + 1)
    space = " " if most else ""
    return f"{fence}{space}{' '.join(text.split())}{space}{fence}"


def _display(display: Display) -> str:
    if display.code:
        text = program(display)
        most = max((len(run) for run in re.findall("`+", text)), default=0)
        fence = "`" * max(3, most + 1)
        return f"{fence}python\n{text}\n{fence}"
    lines, length = [""], 0
    for text, changed in display.terms:
        term = rf"\boxed{{{text}}}" if changed else text
        size = len(re.sub(r"\\[A-Za-z]+|[\\{}^_,\s]", "", text)) * 2
        if length and length + size > WIDTH:
            lines.append("")
            length = 0
        lines[-1] += f" {term}"
        length += size
    body = " \\\\\n".join(f"&{line}" for line in lines)
    return f"```math\n\\begin{{aligned}}\n{display.left} ={{}} {body}\n\\end{{aligned}}\n```"
