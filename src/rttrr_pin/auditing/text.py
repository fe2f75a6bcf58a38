"""Sums of terms as text, in the language and in the letters of a publication."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from rttrr_pin.auditing.match import Numeral
from rttrr_pin.derivation.latex import in_order, latex_sum
from rttrr_pin.derivation.symbols import Factors, Role, Symbol

INDEXED = re.compile(r"(\\mathrm\s*\{|)([csCS])(\}?)\s*_")
"""A cosine or sine whose angle is an index: s_2."""

Writing = Callable[[Sequence[Numeral]], list[str]]
"""Turns terms into text."""


def spelled(
    symbols: Mapping[str, Symbol], spellings: Mapping[str, str], language: str, used: Mapping[str, str]
) -> dict[str, Symbol]:
    """The symbols as a publication spells them; sines and cosines that it has not, after those that it has.

    Args:
        symbols: by name.
        spellings: the name that each spelling stands for; of several, the first is taken.
        language: "latex" or "python".
        used: how the text spells symbols, by name; what stands first is followed first.
    """
    first: dict[str, str] = {}
    for spelling, name in spellings.items():
        first.setdefault(name, spelling)
    first |= used
    shown = {}
    for name, symbol in symbols.items():
        text = first.get(name, symbol.latex)
        angle = [first.get(f"q_{k}", "") for k in name[2:].split("_")]
        if name not in used and symbol.role in (Role.COSINE, Role.SINE) and all(angle):
            text = _function(language, symbol, angle, _example(symbols, used, len(angle)))
        shown[name] = replace(symbol, latex=text)
    return shown


def _example(symbols: Mapping[str, Symbol], used: Mapping[str, str], angles: int) -> str:
    """How the text spells a sine or cosine, if it can be of as many angles; empty where it has none."""
    known = [name for name in used if name in symbols and symbols[name].role in (Role.COSINE, Role.SINE)]
    alike = [name for name in known if name.count("_") == angles]
    return used[(alike or known)[0]] if known else ""


def _function(language: str, symbol: Symbol, angle: Sequence[str], example: str) -> str:
    """A sine or cosine of an angle or of a sum of angles, in the manner of an example."""
    cosine, summed = symbol.role is Role.COSINE, " + ".join(angle)
    word = "cos" if cosine else "sin"
    if language == "python":
        module = example.partition("(")[0].rpartition(".")[0]
        return f"{module}.{word}({summed})" if module else f"{word}({summed})"
    if indexed := INDEXED.match(example):
        before, printed, behind = indexed.groups()
        letter = before + (symbol.name[0].upper() if printed.isupper() else symbol.name[0]) + behind
        index = symbol.name[2:] if len(symbol.name) == 3 else f"{{{symbol.name[2:]}}}"
        return letter + (symbol.latex[1:] if len(angle) > 1 else f"_{index}")
    if example.startswith(("\\cos", "\\sin")):
        bracket = "(" in example or len(angle) > 1
        return rf"\{word}({summed})" if bracket else rf"\{word} {summed}"
    return f"{symbol.name[0]}{summed}" if len(angle) == 1 else symbol.latex


def in_language(language: str, numerals: Sequence[Numeral], symbols: Mapping[str, Symbol]) -> list[str]:
    """A sum, term by term with signs, as the readers of the package read it."""
    return LANGUAGES[language](numerals, symbols)


def _python(numerals: Sequence[Numeral], symbols: Mapping[str, Symbol]) -> list[str]:
    texts = [("- " if x < 0 else "+ ") + _python_product(abs(x), factors, symbols) for x, factors in numerals]
    return [texts[0].removeprefix("+ "), *texts[1:]] if texts else ["0"]


def _python_product(coefficient: Fraction, factors: Factors, symbols: Mapping[str, Symbol]) -> str:
    parts = [symbols[name].latex + (f"**{power}" if power > 1 else "") for name, power in in_order(factors, symbols)]
    if coefficient != 1 or not parts:
        parts.insert(0, str(coefficient))
    return "*".join(parts)


LANGUAGES: Mapping[str, Callable[[Sequence[Numeral], Mapping[str, Symbol]], list[str]]] = {
    "latex": latex_sum,
    "python": _python,
}
"""How each language writes a sum."""
