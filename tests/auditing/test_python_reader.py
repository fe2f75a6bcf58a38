"""The reader of Python expressions, and that it reads what the reader of LaTeX does."""

from __future__ import annotations

import re
from fractions import Fraction

import pytest

from rttrr_pin.auditing.printed import PrintedComponent, Reading
from rttrr_pin.auditing.reading.python import read_python
from rttrr_pin.derivation.symbols import factors_of
from rttrr_pin.errors import InputError
from support.printed import COMPARED, PAPER, splits_of, values

NAMES = {
    "q1": "q_1",
    "q2": "q_2",
    "qd1": "v_1",
    "qd[1]": "v_2",
    "self.m2": "M_2",
    "m2": "M_2",
    "l1": "l_1",
    "l2": "l_2",
    "g": "g",
}


def python(text: str) -> list[tuple[Fraction, dict[str, int]]]:
    """The values of a Python expression."""
    component = read_python(text, NAMES)
    assert component.unparsed == ""
    return [(coefficient, dict(factors)) for coefficient, factors in values(component.terms)]


def test_python_expression() -> None:
    text = "-m2*l1*l2*sin(q2)*qd1**2 + 0.5*self.m2*g*np.cos(q2 + q1)/2 - (g - 1e-3*l1)*math.cos(q1)**2 + +qd[1]*-2"
    assert python(text) == [
        (-1, {"M_2": 1, "l_1": 1, "l_2": 1, "s_2": 1, "v_1": 2}),
        (Fraction(1, 4), {"M_2": 1, "g": 1, "c_1_2": 1}),
        (-1, {"g": 1, "c_1": 2}),
        (Fraction(1, 1000), {"l_1": 1, "c_1": 2}),
        (-2, {"v_2": 1}),
    ]
    shown = [term.text for term in read_python(text, NAMES).terms]
    assert shown[:3] == ["-m2*l1*l2*sin(q2)*qd1**2", "+ 0.5*self.m2*g*np.cos(q2 + q1)/2", "- (g ...)*math.cos(q1)**2"]


def test_python_over_lines_and_assignments() -> None:
    assert (
        python("tau = g\\\n  + l1")
        == python("g +\n l1")
        == python("(g # gravity\n + l1)")
        == [(1, {"g": 1}), (1, {"l_1": 1})]
    )
    assert [term.text for term in read_python("(g + l1) - l2*(g)", NAMES).terms] == ["g", "+ l1", "- l2*(g)"]
    assert [term.text for term in read_python("(g) - ((l1)*l2) + q1", NAMES).terms] == ["g", "- ((l1)*l2)", "+ q1"]
    assert python("(g + l1)*(g - l1)") == [
        (1, {"g": 2}),
        (-1, {"g": 1, "l_1": 1}),
        (1, {"g": 1, "l_1": 1}),
        (-1, {"l_1": 2}),
    ]
    assert python("((g*2)**2)**2/(2*4)") == [(2, {"g": 4})]


def test_python_keeps_what_it_does_not_know() -> None:
    (term,) = read_python("foo[2]*M_2", NAMES).terms
    assert term.readings == (Reading(Fraction(1), factors_of({"foo_2": 1, "M_2_": 1}), unknown=("foo[2]", "M_2")),)


@pytest.mark.parametrize(
    ("text", "place"),
    [
        *(
            ("g + sqrt(2)", 5),
            ("g + ", 5),
            ("__import__('os')", 1),
            ("g if g else l1", 1),
            ("sin(q1 - l1)", 5),
            ("", 1),
        ),
        *(
            ("sin(q1/3)", 5),
            ("g/(0*l1)", 4),
            ("g**-1", 4),
            ("g**l1", 4),
            ("g**0.5", 4),
            ("True*g", 1),
            ("g*2j", 3),
            ("g*1e9999999", 3),
        ),
        *(
            ("g//2", 1),
            ("g; l1", 1),
            ("g*10**500", 7),
            ("((g**300)**300)**300", 12),
            ("g/0", 3),
            ("θ + sqrt(g)", 5),
            ("g\0", 1),
        ),
        *(
            ("import os", 1),
            ("sin(q1, q2)", 1),
            ("sin(q1*q1)", 5),
            ("'g'", 1),
            ("[g]", 1),
            ("(g + l1)**400", 1),
            ("tan(q1)", 1),
        ),
    ],
)
def test_python_that_cannot_be_read_is_told_with_its_place(text: str, place: int) -> None:
    component = read_python(text, NAMES)
    assert component.terms == () and component.unparsed.startswith(f"character {place} (line 1, column {place})")


@pytest.mark.parametrize("key", ["2", "q1 + q2", "sin(q1)", "q 1"])
def test_python_variables_are_variables(key: str) -> None:
    with pytest.raises(InputError, match="wanted"):
        read_python("g", {key: "g"})


@pytest.mark.parametrize(
    "number", [number for number in COMPARED if number not in (18, 31, 33, 35, 36, 37, 38, 39, 42)]
)
def test_both_readers_agree(number: int) -> None:
    (split,) = splits_of(number)
    names = {name: name for name in PAPER.names}
    for component in split.components:
        assert values(as_python(component, names).terms) == values(component.terms)


def as_python(component: PrintedComponent, names: dict[str, str]) -> PrintedComponent:
    """The same component, written as Python and read from there."""
    text = ""
    for coefficient, factors in values(component.terms):
        written = [
            re.sub(r"^([cs])_(\d)$", lambda m: f"{ {'c': 'cos', 's': 'sin'}[m[1]] }(q_{m[2]})", name)
            for name, _ in factors
        ]
        text += f" {'-' if coefficient < 0 else '+'} {abs(coefficient)}*" + "*".join(
            f"{name}**{power}" for name, (_, power) in zip(written, factors, strict=True)
        )
    return read_python(text, names)


def test_both_readers_agree_on_equation_17_written_by_hand() -> None:
    text = "-M2*(qdd1*r2y + qd1**2*r2x)"
    names = {"M2": "M_2", "qdd1": "a_1", "qd1": "v_1", "r2y": "r_C2y", "r2x": "r_C2x"}
    (split,) = splits_of(17)
    assert values(read_python(text, names).terms) == values(split.components[0].terms)
