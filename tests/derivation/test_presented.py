"""Closed forms as they are written: collected, in lines that fit; nothing is lost by it."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from rttrr_pin.derivation.collect import Power, Presenter, Product, Sum
from rttrr_pin.derivation.latex import latex_number
from rttrr_pin.derivation.ring import Ring
from rttrr_pin.derivation.symbols import Expression, Factors, Role
from rttrr_pin.derivation.writers.content import width
from support.derivations import CASES, IDS, derived


def expanded(ring: Ring, expression: Sum | Power) -> Any:
    """An expression multiplied out again."""
    if isinstance(expression, Power):
        return ring[expression.name] ** expression.exponent
    total = ring.lift(0)
    for term in expression.terms:
        product = ring.lift(term.coefficient)
        for factor in term.factors:
            product = product * expanded(ring, factor)
        total += product
    return total


@pytest.mark.one_in(2)
@pytest.mark.parametrize("case", [CASES[0], CASES[1], CASES[2], CASES[9]], ids=[IDS[0], IDS[1], IDS[2], IDS[9]])
def test_expressions_multiplied_out_are_the_same_polynomials(case: tuple[str, str, str]) -> None:
    """Exactly."""
    derivation = derived(*case)
    presenter, ring = Presenter(derivation.symbols), derivation.ring
    for terms in derivation.all_terms():
        assert ring.reduced(expanded(ring, presenter.expression(terms))) == ring.polynomial(terms)


def factors_of(term: Product) -> Factors:
    return tuple((factor.name, factor.exponent) for factor in term.factors if isinstance(factor, Power))


def test_terms_are_collected_by_rates_in_a_fixed_order() -> None:
    """Accelerations, squares of rates, products of rates, gravity, payload, what is left; each once."""
    derivation = derived("rttrr", "auto", "letters")
    outer = (Role.ACCELERATION, Role.RATE, Role.GRAVITY, Role.PAYLOAD)
    expression = Presenter(derivation.symbols).expression(derivation.quantities["n"].terms[2, 2])
    heads = [
        " ".join(f"{name}^{power}" for name, power in factors_of(term) if derivation.symbols[name].role in outer)
        for term in expression.terms
    ]
    assert heads == [
        *(f"a_{k}^1" for k in (1, 3, 4, 5)),
        *(f"v_{k}^2" for k in (1, 4, 5)),
        *("v_1^1 v_3^1", "v_1^1 v_4^1", "v_1^1 v_5^1", "v_4^1 v_5^1"),
        *("f_tool_x^1", "f_tool_y^1", "f_tool_z^1", "n_tool_x^1", "n_tool_z^1"),
    ]


@pytest.mark.parametrize(
    ("polynomial", "wanted"),
    [
        ({"": 1, "c_4^2": -1}, {"s_4^2": 1}),
        ({"g": 3, "g c_4^2": -3, "c_5^2": 1}, {"g s_4^2": 3, "c_5^2": 1}),
        ({"": 1, "c_4^2": 1}, {"": 1, "c_4^2": 1}),
        ({"": 1, "c_4^2": -1, "c_5^2": -1, "c_4^2 c_5^2": 1}, {"s_4^2 s_5^2": 1}),
        ({"": 2, "c_4^2": -1}, {"": 2, "c_4^2": -1}),
    ],
)
def test_sines_are_squared_where_that_saves_a_term(polynomial: dict[str, int], wanted: dict[str, int]) -> None:
    presenter = Presenter(derived("rttrr", "auto", "letters").symbols)
    assert presenter.shortest(terms(polynomial)) == terms(wanted)


def terms(polynomial: dict[str, int]) -> Expression:
    """Products such as "g c_4^2" with their coefficients."""
    found: Expression = {}
    for product, coefficient in polynomial.items():
        pairs = [word.partition("^") for word in product.split()]
        found[tuple(sorted((name, int(power or 1)) for name, _, power in pairs))] = Fraction(coefficient)
    return found


def test_common_factors_stand_in_front() -> None:
    """(g + q_3) (M_4 s_4 + M_5 c_4), and not its four terms."""
    presenter = Presenter(derived("rttrr", "auto", "letters").symbols)
    found = presenter.expression(terms({"M_4 p_3x s_4": 2, "M_5 p_3x c_4": 2, "M_4 q_3 s_4": 2, "M_5 q_3 c_4": 2}))
    (term,) = found.terms
    assert term.coefficient == 2
    assert [len(factor.terms) for factor in term.factors if isinstance(factor, Sum)] == [2, 2]


def test_numbers_are_read_back_as_the_same_float() -> None:
    for x in (0.1, 1e-7, 123456.789, 2.5e20, 1 / 3, 7.02475):
        latex = latex_number(Fraction(x)).replace(r" \cdot 10^{", "e").rstrip("}")
        assert float(latex) == x
    assert latex_number(Fraction(1, 2)) == r"\frac{1}{2}"


def test_the_estimated_width_is_not_below_the_true_one() -> None:
    """Widths in em of Computer Modern as MathJax sets it."""
    true = {
        r"M_5 \cdot cq_4": 3.44,
        r"{}^5r_{C_{5x}}": 2.07,
        r"\ddot{q}_1 + q_3": 2.99,
        r"{}^5J_{xz}^*": 1.81,
        r"\frac{1}{2} \cdot (M_3 - 2.5)": 6.35,
        r"{}^3\dot{\omega}_{x,\ddot{q}_2}": 2.37,
        r"\mathrm{sgn}(\dot{q}_{12})": 3.46,
        r"1.5 \cdot 10^{-7} \cdot s^2q_4": 6.50,
    }
    for latex, measured in true.items():
        assert width(latex) >= measured
