"""Closed forms as lines of LaTeX formulas that fit a page, for documents and for Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from rttrr_pin.derivation import QUANTITIES, Derivation, Symbol
from rttrr_pin.derivation.collect import Presenter
from rttrr_pin.derivation.latex import latex_number, latex_power
from rttrr_pin.derivation.writers.printing import Notation, lines, text

ROOM = 47.0
"""Width of a line in em: a page of 210 mm with margins of 20 mm has 48."""

TOKEN = re.compile(r"\\[A-Za-z]+|\\.|[^\\]")

EM = {
    **dict.fromkeys([r"\dot", r"\ddot", r"\mathrm", r"\left", r"\right"], 0.0),
    **dict.fromkeys("{} &", 0.0),
    r"\cdot": 0.73,
    r"\quad": 1.0,
    "+": 1.23,
    "-": 1.23,
    "(": 0.39,
    ")": 0.39,
    ",": 0.45,
    ".": 0.28,
    "=": 1.34,
    "*": 0.5,
    "M": 1.08,
    "N": 0.92,
    "F": 0.79,
    "C": 0.79,
    "J": 0.66,
    r"\omega": 0.63,
    r"\varphi": 0.66,
}
"""Widths in em of ten-point Computer Modern, spaces around operators included; any other letter counts as wide as q."""

LETTER = 0.56

SCRIPT = 0.75
"""A subscript's letters against those of the line; a little is added behind it."""


@dataclass(frozen=True)
class Equation:
    """Name = lines of a sum."""

    name: str
    lines: list[str]


def notation(symbols: Mapping[str, Symbol]) -> Notation:
    """The notation of formulas in these symbols."""
    return Notation(latex_number, lambda name, power: latex_power(symbols[name], power), r" \cdot ", width, r"\quad ")


def width(latex: str) -> float:
    """How wide a formula prints, in em, rather too much than too little."""
    total, scale, pending = 0.0, [1.0], False
    for token in TOKEN.findall(latex):
        if token in "_^":
            pending = True
        elif token == "{":
            scale.append(scale[-1] * (SCRIPT if pending else 1.0))
            pending = False
        elif token == "}":
            scale.pop()
        else:
            total += EM.get(token, LETTER) * scale[-1] * (SCRIPT if pending else 1.0) + 0.05 * pending
            pending = False
    return total


def steps(derivation: Derivation) -> Iterator[Equation]:
    """The steps."""
    presenter, how = Presenter(derivation.symbols), notation(derivation.symbols)
    for step in derivation.steps:
        expression = presenter.expression(step.terms)
        yield Equation(step.symbol.latex, lines(expression, how, ROOM - width(step.symbol.latex) - EM["="]))


def equations(derivation: Derivation, name: str) -> Iterator[Equation]:
    """The entries of a quantity; of a symmetric matrix the upper half, and none that only repeats its own name."""
    presenter, how = Presenter(derivation.symbols), notation(derivation.symbols)
    for at, terms in derivation.quantities[name].terms.items():
        if name == "M" and at[1] < at[0]:
            continue
        latex = QUANTITIES[name].latex(at)
        expression = presenter.expression(terms)
        if text(expression, how) != latex:
            yield Equation(latex, lines(expression, how, ROOM - width(latex) - EM["="]))


def blocks(equations: Iterable[Equation], most_lines: int, split: bool) -> Iterator[list[str]]:
    """Equations as the lines of aligned environments.

    Args:
        equations: in order.
        most_lines: of one environment.
        split: whether an equation that is longer than that goes on in the next.
    """
    block: list[str] = []
    for equation in equations:
        first, *others = equation.lines
        printed = [f"{equation.name} ={{}}& {first}", *(f"& {line}" for line in others)]
        if block and len(block) + len(printed) > most_lines:
            yield block
            block = []
        while split and len(printed) > most_lines:
            yield printed[:most_lines]
            printed = printed[most_lines:]
        block += printed
    if block:
        yield block
