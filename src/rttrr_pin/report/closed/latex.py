"""Closed forms as a LaTeX document that compiles by itself: article and amsmath, lines broken to fit the page."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from rttrr_pin.report.closed import mathematics, words
from rttrr_pin.report.closed.glossary import Entry, glossary
from rttrr_pin.symbolic import Derivation

HEAD = r"""\documentclass[a4paper,10pt]{article}
\usepackage[T1]{fontenc}
\usepackage{amsmath}
\usepackage{longtable}
\usepackage[margin=20mm]{geometry}
\allowdisplaybreaks
\setlength{\parindent}{0pt}
\setlength{\parskip}{1ex}
"""

ESCAPES = {"\\": r"\textbackslash{}", "^": r"\^{}", "~": r"\~{}"}
"""Of signs that a backslash in front does not make printable."""

MOST_LINES = 24
"""Of one environment, unless an equation alone has more."""


def latex(derivation: Derivation, preface: str = "") -> str:
    """A document.

    Args:
        derivation: what to write.
        preface: a paragraph to put before all others.
    """
    model = derivation.robot.model
    parts = [HEAD + r"\begin{document}", rf"\section*{{Dynamic model of {_escaped(words.plain(model.name))}}}"]
    parts += [_escaped(text) for text in (*([preface] if preface else []), *words.conventions(derivation))]
    parts.append(_escaped(f"Links and joints: {words.names_of_links(model)}."))
    if entries := glossary(derivation):  # a longtable without rows does not compile
        parts += [r"\section*{Symbols}", "\n".join(_table(entries))]
    if derivation.steps:
        parts += [rf"\section*{{{words.STEPS}}}", *_blocks(mathematics.steps(derivation))]
    for name in derivation.quantities:
        parts += [rf"\section*{{{_escaped(words.TITLES[name])}}}", _escaped(words.heading(derivation, name))]
        parts += _blocks(mathematics.equations(derivation, name))
    return "\n\n".join([*parts, r"\end{document}"]) + "\n"


def _escaped(text: str) -> str:
    """Text in which TeX sees only letters."""
    return re.sub(r"[\\^~_{}#$%&]", lambda found: ESCAPES.get(found[0], "\\" + found[0]), text)


def _unit(text: str) -> str:
    return re.sub(r"\^(-?\d+)", r"\\textsuperscript{\1}", text)


def _table(entries: Iterable[Entry]) -> Iterator[str]:
    yield r"\begin{longtable}{lp{0.6\textwidth}lr}"
    for entry in entries:
        value = "" if entry.value is None else f"${mathematics.decimal(entry.value)}$"
        meaning = _escaped(entry.meaning)
        yield rf"${entry.symbol.latex}$ & {meaning} & {_unit(entry.unit)} & {value} \\"
    yield r"\end{longtable}"


def _blocks(equations: Iterable[mathematics.Equation]) -> Iterator[str]:
    for block in mathematics.blocks(equations, MOST_LINES, split=False):
        yield "\n".join((r"\begin{align*}", " \\\\\n".join(block), r"\end{align*}"))
