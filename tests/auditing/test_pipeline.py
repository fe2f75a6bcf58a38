"""The audit of the paper, and of planted misprints."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fuzz import misprint_campaign
from rttrr_pin.auditing import Kind, Verdict, audit
from support.tolerances import ROUNDING

BY_HAND = (
    ("vC5y", "rate", r"+ sq_4 \cdot \dot{q}_1 \cdot q_3"),
    ("F3x", "rate", r"\dot{q}_1^3 r_{C_{3y}}"),
    ("F4y", "sign", r"-M_4 s q_4 \cdot \ddot{q}_1 q_3"),
    ("F5y", "rate", r"-M_5 {}^5r_{C_{5y}} \cdot \ddot{q}_4^2"),
    ("N5x", "rate", r"- {}^5J_x^* q_5 c q_5 \cdot \dot{q}_1"),
    ("N5z", "symbol", r"\dot{q}_3 c q_5 \cdot \dot{q}_1"),
    ("f3y", "sign", r"+ M_5\dot{q}_1^2 \cdot l_3"),
    ("f3y", "symbol", r"- 2cq_4M_4\cdot^4r_{C_{4z}}\dot{q}_1\dot{q}_4"),
    ("f2y", "coefficient", r"+ 2 s q_4 c q_5 M_5 \ddot{q}_5"),
    ("f2z", "symbol", r"{}^5 r_{C_{5z}} \dot{q}_5^2"),
    ("f1x", "symbol", r"- 2 M_5 \dot{q}_1 \dot{q}_1"),
)
"""Slips seen by eye in the paper, each against the same term where another equation prints it right."""

RIGHT_BY_HAND = (9, 10, 11, 12, 16, 17, 23, 24, 25, 26, 34, 37)
"""Equations that test_paper evaluates term by term, and finds right in every component."""


def test_all_60_components_are_read_and_judged(of_the_paper) -> None:
    assert len(of_the_paper.components) == 60
    assert len({c.quantity for c in of_the_paper.components}) == 60
    assert {c.equation for c in of_the_paper.components} == {*range(9, 27), *range(28, 44)}
    assert of_the_paper.count(Verdict.UNPARSED) == 0
    assert of_the_paper.count(Verdict.MATCH) + of_the_paper.count(Verdict.DIFFERS) == 60


def test_a_component_differs_exactly_where_balls_lie_apart(of_the_paper) -> None:
    """The verdict comes from terms, the proof from numbers: they must agree."""
    for c in of_the_paper.components:
        assert c.evidence is not None
        assert c.evidence.excluded == (c.verdict is Verdict.DIFFERS), c.quantity
        assert bool(c.findings) == (c.verdict is Verdict.DIFFERS), c.quantity


def test_every_corrected_equation_is_proven(of_the_paper) -> None:
    """Read again it is the derivation, its ball meets the recursion's, and Pinocchio says the same."""
    for c in of_the_paper.components:
        assert c.proven and c.evidence is not None and c.evidence.enclosed, c.quantity
        assert c.evidence.corrected_off <= ROUNDING * max(1.0, abs(c.evidence.pinocchio)), c.quantity


@pytest.mark.parametrize(("quantity", "kind", "text"), BY_HAND)
def test_errors_seen_by_eye_are_found(of_the_paper, quantity, kind, text) -> None:
    squeezed = lambda x: x.replace(" ", "")
    found = [
        f
        for c in of_the_paper.components
        if c.quantity == quantity
        for f in c.findings
        if f.kind == kind and f.printed and squeezed(text) in squeezed(f.printed)
    ]
    assert len(found) == 1


def test_equations_that_are_right_by_hand_match(of_the_paper) -> None:
    verdicts = {(c.equation, c.verdict) for c in of_the_paper.components}
    assert not {(number, Verdict.DIFFERS) for number in RIGHT_BY_HAND} & verdicts


def test_ids_are_unique_and_in_order(of_the_paper) -> None:
    ids = [finding.id for finding in of_the_paper.findings]
    assert len(set(ids)) == len(ids)
    for c in of_the_paper.components:
        assert [f.id for f in c.findings] == [f"{c.quantity}.{k}" for k in range(1, len(c.findings) + 1)]


def test_a_lost_boundary_is_told(of_the_paper) -> None:
    """(31) prints three components in one bracket and no boundary between the last two."""
    notes = [note for c in of_the_paper.components if c.equation == 31 for note in c.notes]
    assert notes and all("boundary" in note for note in notes)


def test_terms_run_together_are_told(of_the_paper) -> None:
    """(13) ends with a product that is two terms without the sign between them."""
    (extra,) = [f for f in of_the_paper.findings if f.id.startswith("vC5x.") and f.kind is Kind.EXTRA]
    assert "sign between them was lost" in extra.note and extra.dimension_ok is False


def test_the_sign_of_the_products_of_inertia_is_tried_both_ways(of_the_paper) -> None:
    (check,) = [c for c in of_the_paper.conventions if c.convention.flip]
    assert check.findings is not None and check.otherwise is not None
    assert check.findings < check.otherwise


def test_the_audit_is_the_same_every_time(of_the_paper, paper) -> None:
    some = [equation for equation in paper.equations if equation.number in (9, 22, 34)]
    again = audit(replace(paper, equations=tuple(some)))
    assert list(again.components) == [x for x in of_the_paper.components if x.equation in (9, 22, 34)]


# Planted misprints


@pytest.mark.slow
def test_planted_misprints_are_found_and_named() -> None:
    """As `python -m tests.fuzz.misprint_campaign`, which has 1,000 of them."""
    cases = [misprint_campaign.case(seed) for seed in range(100)]
    assert all(found for _, found, _ in cases)
    errors = [right for named, _, _ in cases for _, right in named]
    assert sum(errors) >= misprint_campaign.WANTED * len(errors)
    assert {kind for named, _, _ in cases for kind, _ in named} == {str(kind) for kind in Kind}


def test_a_clean_copy_is_not_reported() -> None:
    assert misprint_campaign.clean(0) == []


def test_equations_of_one_component_can_be_given_apart(paper) -> None:
    (equation,) = [x for x in paper.equations if x.number == 22]
    result = audit(replace(paper, equations=(equation,), conventions=()))
    assert [c.quantity for c in result.components] == ["F5z"]
    assert (result.components[0].printed_terms, result.components[0].derived_terms) == (25, 25)
