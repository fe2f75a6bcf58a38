"""Closed forms as Markdown: a table of symbols, and formulas in `$$` blocks small enough for any renderer."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from rttrr_pin.derivation import Derivation
from rttrr_pin.derivation.writers import mathematics
from rttrr_pin.derivation.writers import wording as words
from rttrr_pin.derivation.writers.glossary import Entry, glossary

MOST_LINES = 16
"""Of one block: renderers in browsers give up on long ones."""


def markdown(derivation: Derivation, preface: str = "") -> str:
    """A page.

    Args:
        derivation: what to write.
        preface: a paragraph to put before all others.
    """
    model = derivation.robot.model
    parts = [f"# Dynamic model of {words.plain(model.name)}", *([preface] if preface else [])]
    parts += [*words.conventions(derivation), f"Links and joints: {words.names_of_links(model)}.", "## Symbols"]
    parts.append("\n".join(_table(glossary(derivation))))
    if derivation.steps:
        parts += [f"## {words.STEPS}", *_blocks(mathematics.steps(derivation))]
    for name in derivation.quantities:
        parts += [f"## {words.TITLES[name]}", words.heading(derivation, name)]
        parts += _blocks(mathematics.equations(derivation, name))
    return "\n\n".join(parts) + "\n"


def _table(entries: Iterable[Entry]) -> Iterator[str]:
    yield "| symbol | meaning | unit | value |"
    yield "|---|---|---|---|"
    for entry in entries:
        value = "" if entry.value is None else repr(entry.value)
        yield f"| ${entry.symbol.latex}$ | {entry.meaning} | {entry.unit} | {value} |"


def _blocks(equations: Iterable[mathematics.Equation]) -> Iterator[str]:
    for block in mathematics.blocks(equations, MOST_LINES, split=True):
        yield "\n".join(("$$", r"\begin{aligned}", " \\\\\n".join(block), r"\end{aligned}", "$$"))
