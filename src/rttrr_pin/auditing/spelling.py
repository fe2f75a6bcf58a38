"""Terms as text, in the language and in the symbols of a publication."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache

from rttrr_pin.auditing.publication import Publication
from rttrr_pin.auditing.reading.angles import coordinate_of, multiple_of
from rttrr_pin.derivation.latex import in_order, latex_sum
from rttrr_pin.derivation.numbers import fits
from rttrr_pin.derivation.ring import nearest
from rttrr_pin.derivation.symbols import Role, Symbol, Term

Writing = Callable[[Sequence[Term]], list[str]]
"""Turns terms into text, each with its sign."""

POWER = r"(?:\s*\^\s*(?:\d|\{\s*\d+\s*\}))?"
WORD = re.compile(rf"\\(?:cos|sin)(?![A-Za-z]){POWER}\s*((?:\\left\s*)?\()?")
r"""A sine or cosine by name, and whether a bracket follows: \cos\theta_1, \cos(\theta_1)."""

ONE, SEVERAL = (
    re.compile(rf"(\\mathrm\s*\{{\s*|(?<![A-Za-z\\{{_]))([csCS])(\s*\}}|){POWER}\s*_\s*{index}")
    for index in (r"(?:\d|\{\s*\d\s*\})", r"\{\s*\d[\d,+\s-]*\d\s*\}")
)
"""A sine or cosine whose angle is an index, of one angle, s_2, and of a sum, s_{12}."""

MODULE = re.compile(r"(?:(\w+(?:\.\w+)*)\.)?(?:cos|sin)\(")
"""A sine or cosine of Python, and the module that it is from."""


def writing(publication: Publication, symbols: Mapping[str, Symbol], examples: Sequence[str]) -> Writing:
    """How terms are written: of several spellings that the publication has for a symbol, in the first.

    Sines and cosines are written as in the first of the examples that has any; where none has, as in s q_2.
    """
    preferred: dict[str, str] = {}
    for spelling, name in publication.spellings.items():
        preferred.setdefault(name, spelling)
    spelled = {}
    for name, symbol in symbols.items():
        text = preferred.get(name, symbol.latex)
        parts = name[2:].split("_")
        angle = [preferred.get(f"q_{coordinate_of(part)}", "") for part in parts]
        if symbol.role in (Role.COSINE, Role.SINE) and all(angle):
            function = _python_function if publication.language == "python" else _latex_function
            text = function(symbol, angle, examples)
        spelled[name] = replace(symbol, latex=text)
    sum_in = _python_sum if publication.language == "python" else latex_sum
    return lambda terms: sum_in(terms, spelled)


def _latex_function(symbol: Symbol, angle: Sequence[str], examples: Sequence[str]) -> str:
    """A sine or cosine of an angle or of a sum of angles, in the manner of the first example."""
    several = len(angle) > 1
    summed, word = _summed(symbol, angle, " "), "cos" if symbol.role is Role.COSINE else "sin"
    if len(set(angle)) < len(angle) or "d" in symbol.name[2:]:  # 2 q_1 and q_1 / 2 have no index
        return rf"\{word}({summed})"
    example = next(filter(None, (_example(text, several) for text in examples)), None)
    if example is None:
        return symbol.latex if several else f"{symbol.name[0]}{summed}"
    if example.re is WORD:
        return rf"\{word}({summed})" if example[1] or several else rf"\{word} {summed}"
    before, printed, behind = example.groups()
    letter = f"{before}{symbol.name[0].upper() if printed.isupper() else symbol.name[0]}{behind}"
    index = symbol.name[2:]
    return letter + (symbol.latex[1:] if several else f"_{index}" if len(index) == 1 else f"_{{{index}}}")


@lru_cache(maxsize=256)
def _example(text: str, several: bool) -> re.Match[str] | None:
    """The first sine or cosine of a text, of one angle or of a sum of several."""
    if several:
        return SEVERAL.search(text) or WORD.search(text)
    named = (x for x in WORD.finditer(text) if not (x[1] and "+" in text[x.end() :].partition(")")[0]))
    first = [x for x in (ONE.search(text), next(named, None)) if x]
    return min(first, key=lambda x: x.start(), default=None)


def _python_function(symbol: Symbol, angle: Sequence[str], examples: Sequence[str]) -> str:
    word = "cos" if symbol.role is Role.COSINE else "sin"
    summed = _summed(symbol, angle, "*")
    example = next(filter(None, map(MODULE.search, examples)), None)
    return f"{example[1]}.{word}({summed})" if example and example[1] else f"{word}({summed})"


def _summed(symbol: Symbol, angle: Sequence[str], times: str) -> str:
    """The angle of a sine or cosine, in the letters of its parts: 2 q_1 - q_2."""
    multiples: dict[str, Fraction] = {}
    for letter, part in zip(angle, symbol.name[2:].split("_"), strict=True):
        multiples[letter] = multiples.get(letter, Fraction(0)) + multiple_of(part)
    signed = [f"{'-' if x < 0 else '+'} {_multiplied(abs(x), letter, times)}" for letter, x in multiples.items()]
    return " ".join(signed).removeprefix("+ ")


def _multiplied(multiple: Fraction, letter: str, times: str) -> str:
    n, d = multiple.numerator, multiple.denominator
    return ("" if n == 1 else f"{n}{times}") + letter + ("" if d == 1 else f"/{d}")


def _python_number(x: Fraction) -> str:
    return str(x) if fits(x) else repr(nearest(x))


def _python_sum(terms: Sequence[Term], symbols: Mapping[str, Symbol]) -> list[str]:
    texts = []
    for coefficient, factors in terms:
        parts = [symbols[name].latex + (f"**{n}" if n > 1 else "") for name, n in in_order(factors, symbols)]
        number = [_python_number(abs(coefficient))] if abs(coefficient) != 1 or not parts else []
        texts.append(("- " if coefficient < 0 else "+ ") + "*".join([*number, *parts]))
    return [texts[0].removeprefix("+ "), *texts[1:]] if texts else ["0"]
