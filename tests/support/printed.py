"""Texts of equations read by the reader of printed equations; the paper's equations and letters among them."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from importlib.resources import files
from typing import Any

from rttrr_pin.auditing.printed import PrintedTerm, Split
from rttrr_pin.auditing.read import read_latex
from rttrr_pin.auditing.reading.vocabulary import Vocabulary
from rttrr_pin.derivation.symbols import Factors

AXES = "xyz"


def paper_spellings() -> dict[str, str]:
    """What the paper's letters mean."""
    names = {"g": "g", "l_2": "l_2", "l_3": "l_3", "l_4": "l_4"}
    for i in range(1, 6):
        names |= {f"M_{i}": f"M_{i}", f"q_{i}": f"q_{i}", rf"\dot{{q}}_{i}": f"v_{i}", rf"\ddot{{q}}_{i}": f"a_{i}"}
        names |= {f"{{}}^{i}r_{{C_{{{i}{x}}}}}": f"r_C{i}{x}" for x in AXES}
        names |= {f"{{}}^{i}J_{x}^*": f"J_{i}{x}" for x in AXES}
        names |= {f"{{}}^{i}J_{{{x}{y}}}^*": f"J_{i}{min(x, y)}{max(x, y)}" for x in AXES for y in AXES if x != y}
    return names | {f"{{}}^6{letter}_{x}": f"{letter}_6{x}" for letter in "fn" for x in AXES}


PAPER = Vocabulary(paper_spellings())
TEXTBOOK = Vocabulary(
    {
        r"\theta_1": "q_1",
        r"\theta_2": "q_2",
        r"\dot{\theta}_1": "v_1",
        r"\dot{\theta}_2": "v_2",
        r"\ddot{\theta}_1": "a_1",
    }
    | {name: name for name in ("m_1", "m_2", "l_1", "l_2", "g")}
)
EQUATIONS: dict[int, dict[str, Any]] = {
    equation["number"]: equation
    for equation in tomllib.loads(
        files("rttrr_pin.auditing").joinpath("data/rttrr_2016.toml").read_text(encoding="utf-8")
    )["equation"]
}
COMPARED = [number for number, equation in EQUATIONS.items() if equation["components"]]


@cache
def splits_of(number: int) -> tuple[Split, ...]:
    """An equation of the paper, divided in every way."""
    return read_latex(EQUATIONS[number]["latex"], PAPER, len(EQUATIONS[number]["components"]))


def read(text: str, vocabulary: Vocabulary = PAPER) -> tuple[PrintedTerm, ...]:
    """The terms of one component that must be readable, divided in one way."""
    (split,) = read_latex(text, vocabulary, 1)
    (component,) = split.components
    assert component.unparsed == "" and split.note == ""
    return component.terms


def fault(text: str, vocabulary: Vocabulary = PAPER) -> str:
    """Why one component cannot be read."""
    (split,) = read_latex(text, vocabulary, 1)
    (component,) = split.components
    assert component.terms == () and component.unparsed
    return component.unparsed


def values(terms: Sequence[PrintedTerm]) -> list[tuple[Fraction, Factors]]:
    """What terms say that have one reading each, without notes or unknown symbols."""
    assert all(len(term.readings) == 1 for term in terms)
    assert not any(term.readings[0].note or term.readings[0].unknown for term in terms)
    return [(term.readings[0].coefficient, term.readings[0].factors) for term in terms]


def one(text: str, vocabulary: Vocabulary = PAPER) -> tuple[Fraction, dict[str, int]]:
    """The value of a text that is one plain term."""
    ((coefficient, factors),) = values(read(text, vocabulary))
    return coefficient, dict(factors)


def readings(text: str) -> list[tuple[Fraction, dict[str, int]]]:
    """All readings of a text that is one term; where there are several each says what was decided."""
    (term,) = read(text)
    assert len(term.readings) == 1 or all(reading.note for reading in term.readings)
    return [(reading.coefficient, dict(reading.factors)) for reading in term.readings]
