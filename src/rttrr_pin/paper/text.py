"""Sums of terms as text, in the language and in the letters of a publication."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from rttrr_pin.paper.match import Numeral
from rttrr_pin.symbolic.latex import latex_sum
from rttrr_pin.symbolic.symbols import Factors, Role, Symbol


def spelled(symbols: Mapping[str, Symbol], spellings: Mapping[str, str], language: str) -> dict[str, Symbol]:
    """The symbols as a publication spells them, sines and cosines after the coordinate that they are of.

    Args:
        symbols: by name.
        spellings: the name that each spelling stands for; of several, the first is taken.
        language: "latex" or "python".
    """
    first: dict[str, str] = {}
    for spelling, name in spellings.items():
        first.setdefault(name, spelling)
    shown = {}
    for name, symbol in symbols.items():
        text = first.get(name, symbol.latex)
        angle = [first.get(f"q_{k}", "") for k in name[2:].split("_")]
        if symbol.role in (Role.COSINE, Role.SINE) and all(angle):
            text = _function(language, symbol, angle)
        shown[name] = replace(symbol, latex=text)
    return shown


def _function(language: str, symbol: Symbol, angle: Sequence[str]) -> str:
    """A sine or cosine of an angle or of a sum of angles."""
    if language == "python":
        return f"{'cos' if symbol.role is Role.COSINE else 'sin'}({' + '.join(angle)})"
    return f"{symbol.name[0]}{angle[0]}" if len(angle) == 1 else symbol.latex


def in_language(language: str, numerals: Sequence[Numeral], symbols: Mapping[str, Symbol]) -> list[str]:
    """A sum, term by term with signs, as the readers of the package read it."""
    return LANGUAGES[language](numerals, symbols)


def _python(numerals: Sequence[Numeral], symbols: Mapping[str, Symbol]) -> list[str]:
    texts = [("- " if x < 0 else "+ ") + _python_product(abs(x), factors, symbols) for x, factors in numerals]
    return [texts[0].removeprefix("+ "), *texts[1:]] if texts else ["0"]


def _python_product(coefficient: Fraction, factors: Factors, symbols: Mapping[str, Symbol]) -> str:
    parts = [symbols[name].latex + (f"**{power}" if power > 1 else "") for name, power in factors]
    if coefficient != 1 or not parts:
        parts.insert(0, str(coefficient))
    return "*".join(parts)


LANGUAGES: Mapping[str, Callable[[Sequence[Numeral], Mapping[str, Symbol]], list[str]]] = {
    "latex": latex_sum,
    "python": _python,
}
"""How each language writes a sum."""
