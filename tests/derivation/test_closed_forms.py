"""Closed forms: the recursion on polynomials is the recursion, proven by balls; its terms have the right dimensions."""

from __future__ import annotations

from fractions import Fraction

import pytest

import rttrr_pin
from rttrr_pin.auditing.evidence import Witness
from rttrr_pin.auditing.printed import Quotient
from rttrr_pin.derivation.closed_forms import ClosedForms, closed_forms
from rttrr_pin.derivation.latex import latex_number, latex_power, latex_product, latex_sum
from rttrr_pin.derivation.ring import Ring
from rttrr_pin.derivation.symbolic_robot import SymbolicRobot, default_symbols
from rttrr_pin.derivation.symbols import (
    ACCELERATION,
    FORCE,
    LENGTH,
    MOMENT,
    Dimension,
    Role,
    Symbol,
    dimension_of,
    renamed,
)
from rttrr_pin.exact.intervals import INTERVAL, precision
from rttrr_pin.exact.intervals import interval as ball
from support.tolerances import ROUNDING
from support.trees import random_tree

BUNDLED = ("rttrr", "trr", "trtr", "trtrr", "trttr")
VECTORS = {"vC": ACCELERATION, "F": FORCE, "N": MOMENT, "f": FORCE, "n": MOMENT}


def in_letters(source: str) -> ClosedForms:
    model = rttrr_pin.load(source).model
    tool = len(model.links) - 1
    return closed_forms(SymbolicRobot(model, default_symbols(model, tool), tool))


def vectors(forms: ClosedForms, quantity: str):
    return forms.v_dot_C if quantity == "vC" else getattr(forms, quantity)


@pytest.fixture(scope="module", params=BUNDLED)
def arm(request) -> ClosedForms:
    return in_letters(request.param)


def test_every_term_has_the_dimension_of_its_quantity(arm) -> None:
    ring = arm.robot.ring
    wrong = [
        (quantity, i, factors)
        for quantity, dimension in VECTORS.items()
        for i, vector in enumerate(vectors(arm, quantity))
        for component in vector
        for factors in ring.terms(component)
        if dimension_of(factors, ring.symbols) != dimension
    ]
    assert not wrong


def test_no_sine_is_squared(arm) -> None:
    ring = arm.robot.ring
    for vector in (*arm.f, *arm.n):
        for component in vector:
            for factors in ring.terms(component):
                assert not [name for name, power in factors if ring.symbols[name].role is Role.SINE and power > 1]


@pytest.mark.parametrize("seed", range(2))
def test_closed_forms_of_the_arms_are_enclosed_with_the_recursion(arm, seed) -> None:
    compare(arm, Witness(arm.robot, seed))


@pytest.mark.parametrize("seed", range(12))
def test_closed_forms_of_random_trees_are_enclosed_with_the_recursion(seed) -> None:
    kinds = (
        ("revolute", "continuous", "prismatic", "fixed") if seed % 2 else ("planar", "floating", "revolute", "fixed")
    )
    forms = in_letters(random_tree(seed, 2 + seed % 2, kinds))
    compare(forms, Witness(forms.robot, seed))


def compare(forms: ClosedForms, witness: Witness) -> None:
    """Balls of both meet, and are far narrower than rounding; vC only where there is a mass to divide by."""
    model, ring = forms.robot.model, forms.robot.ring
    for quantity in ("vC", "F", "N", "f", "n", "tau"):
        for i in range(model.nv if quantity == "tau" else len(model.links)):
            if quantity == "vC" and not model.links[i].mass:
                continue
            components = [forms.tau[i]] if quantity == "tau" else list(vectors(forms, quantity)[i])
            for axis, component in zip("xyz" if len(components) == 3 else ("",), components, strict=True):
                closed = witness.enclosure(Quotient(ring.terms(component)))
                recursive = witness.recursion(f"{quantity}{i + 1}{axis}")
                assert closed.overlaps(recursive), (quantity, i, axis)
                assert float(closed.rad()) < 1e-50 * max(1.0, abs(float(closed.mid())))


def test_pinocchio_says_the_same(arm) -> None:
    witness = Witness(arm.robot, 3)
    for i in range(arm.robot.model.nv):
        here, there = witness.number(Quotient(arm.robot.ring.terms(arm.tau[i]))), witness.pinocchio(f"tau{i + 1}")
        assert abs(here - there) <= ROUNDING * max(1.0, abs(there)) * 10


def test_a_letter_for_another_is_told_by_the_balls() -> None:
    """The comparison above can fail: one letter exchanged in one term is proven wrong."""
    forms = in_letters("rttrr")
    witness = Witness(forms.robot, 0)
    wrong = renamed(forms.robot.ring.terms(forms.F[4].z), {"r_C5x": "r_C5z"})
    assert not witness.enclosure(Quotient(wrong)).overlaps(witness.recursion("F5z"))


def test_the_paper_s_arm_has_as_many_terms_as_the_paper_prints() -> None:
    """Counted by hand in the paper: (16)-(19) by component, (22), (34); n_1 has over 400 terms a component."""
    forms = in_letters("rttrr")
    count = lambda x: len(forms.robot.ring.terms(x))
    assert [[count(x) for x in vector] for vector in forms.F[:4]] == [[2, 2, 1], [2, 2, 2], [6, 6, 2], [15, 15, 2]]
    assert count(forms.F[4].z) == 25
    assert count(forms.f[3].z) == 10
    assert count(forms.n[0].x) > 400 and count(forms.n[0].y) > 400


def test_a_ring_reduces_and_substitutes() -> None:
    angle = [
        Symbol("s_1", "sq_1", Role.SINE),
        Symbol("c_1", "cq_1", Role.COSINE),
        Symbol("x", "x", Role.PARAMETER, LENGTH),
    ]
    ring = Ring(angle)
    s, c, x = (ring[name] for name in ("s_1", "c_1", "x"))
    assert ring.reduced(s * s + c * c) == ring.lift(1)
    assert ring.reduced(s**3 + s * c**2) == s
    assert ring.substituted(x * s, {"x": s}) == ring.reduced(s * s)
    assert ring.polynomial(ring.terms(2 * x * c - 3)) == 2 * x * c - 3
    assert dimension_of((("x", 2), ("c_1", 1)), ring.symbols) == Dimension(length=2)


def test_numbers_and_products_in_latex() -> None:
    symbols = {
        "M_1": Symbol("M_1", "M_1", Role.PARAMETER),
        "c_5": Symbol("c_5", "cq_5", Role.COSINE),
        "v_1": Symbol("v_1", r"\dot{q}_1", Role.RATE),
        "J": Symbol("J", "{}^5J_x^*", Role.PARAMETER),
    }
    assert latex_number(Fraction(-3)) == "3"
    assert latex_number(Fraction(1, 2)) == r"\frac{1}{2}"
    assert float(latex_number(Fraction(0.1))) == 0.1
    assert latex_power(symbols["c_5"], 2) == "c^2q_5"
    assert latex_power(symbols["v_1"], 2) == r"\dot{q}_1^2"
    assert latex_power(symbols["J"], 2) == r"\left({}^5J_x^*\right)^2"
    assert (
        latex_product(Fraction(2), (("M_1", 1), ("c_5", 1), ("v_1", 2)), symbols) == r"2 \, M_1 \, cq_5 \, \dot{q}_1^2"
    )
    assert latex_sum([(Fraction(1), (("M_1", 1),)), (Fraction(-1), ())], symbols) == ["M_1", "- 1"]
    assert latex_sum([], symbols) == ["0"]


def test_balls_enclose_and_keep_the_precision_as_it_was() -> None:
    from flint import ctx

    before = ctx.prec
    with precision(300):
        assert ctx.prec == 300
        third = ball(Fraction(1, 3))
        assert (third * 3).contains(1) and not (third * 3 - 1 + ball(2.0**-200)).contains(0)
        sine, cosine = INTERVAL.sincos(ball(0.5))
        assert (sine * sine + cosine * cosine).contains(1)
    assert ctx.prec == before
