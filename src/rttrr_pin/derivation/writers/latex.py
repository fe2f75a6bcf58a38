"""Closed forms as a LaTeX document that compiles by itself, lines broken to fit the page."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

from rttrr_pin.derivation import Derivation
from rttrr_pin.derivation.latex import decimal
from rttrr_pin.derivation.writers import mathematics
from rttrr_pin.derivation.writers import wording as words
from rttrr_pin.derivation.writers.glossary import Entry, glossary
from rttrr_pin.reporting.tex import code, document, escaped

PREAMBLE = r"""\allowdisplaybreaks
"""

COLUMNS = "".join(
    rf">{{\ragged{side}\arraybackslash}}p{{{share}\textwidth}}"
    for side, share in (("right", 0.07), ("right", 0.51), ("right", 0.09), ("left", 0.25))
)
"""Symbol, meaning, unit, value; their widths are given, so that one run of TeX sets them."""

MOST_LINES = 120
"""Of one environment, unless an equation alone has more: TeX holds it whole."""


def latex(derivation: Derivation, preface: str = "") -> str:
    """A document.

    Args:
        derivation: what to write.
        preface: a paragraph to put before all others.
    """
    model = derivation.robot.model
    parts = [rf"{{\raggedright\LARGE\bfseries {_words(f'Dynamic model of {words.plain(model.name)}')}\par}}"]
    parts += [_words(text) for text in (*([preface] if preface else []), *words.conventions(derivation))]
    parts.append(_words(f"Links and joints: {words.names_of_links(model)}."))
    if entries := glossary(derivation):  # a longtable without rows does not compile
        parts += [r"\section*{Symbols}", "\n".join(_table(entries))]
    if derivation.steps:
        parts.append(_section(words.STEPS, words.STEPS_MEANING, mathematics.steps(derivation)))
    for name in derivation.quantities:
        shown = mathematics.equations(derivation, name)
        parts.append(_section(words.TITLES[name], words.heading(derivation, name), shown))
    return document(PREAMBLE, "\n\n".join(parts))


def _words(text: str) -> str:
    """Text, with what stands between backquotes in typewriter; names may be broken behind an underscore."""
    parts = [code(part) if k % 2 else escaped(part) for k, part in enumerate(text.split("`"))]
    return "".join(parts).replace(r"\_", r"\_\allowbreak{}")


def _section(title: str, meaning: str, equations: Iterable[mathematics.Equation]) -> str:
    """A heading, a paragraph, and formulas, without the empty lines that would be paragraphs to TeX."""
    blocks = mathematics.blocks(equations, MOST_LINES, split=False)
    return "\n".join([rf"\section*{{{_words(title)}}}", _words(meaning), *(_aligned(block) for block in blocks)])


def _unit(text: str) -> str:
    return re.sub(r"\^(-?\d+)", r"\\textsuperscript{\1}", text).replace(" ", "~")


def _table(entries: Iterable[Entry]) -> Iterator[str]:
    yield r"{\small\setlength{\LTleft}{0pt}\setlength{\tabcolsep}{4pt}"
    yield rf"\begin{{longtable}}{{{COLUMNS}}}"
    yield r"\toprule" + "\n" + r"symbol & meaning & unit & value \\" + "\n" + r"\midrule" + "\n" + r"\endhead"
    yield r"\bottomrule" + "\n" + r"\endfoot"
    for entry in entries:
        value = "" if entry.value is None else f"${decimal(entry.value)}$"
        yield rf"${entry.symbol.latex}$ & {_words(entry.meaning)} & {_unit(entry.unit)} & {value} \\"
    yield r"\end{longtable}}"


def _aligned(block: Sequence[str]) -> str:
    """Lines of equations, with some room between one equation and the next."""
    ends = [r" \\" if after.startswith("& ") else r" \\[1ex]" for _, after in pairwise(block)]
    body = "\n".join(line + end for line, end in zip(block, [*ends, ""], strict=True))
    return f"\\begin{{align*}}\n{body}\n\\end{{align*}}"
