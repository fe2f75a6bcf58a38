"""The auditor: of the paper, of planted misprints, and of equations that a user brings."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from fuzz import misprint_campaign
from rttrr_pin.auditing import Kind, Verdict, audit, read_publication
from rttrr_pin.auditing.differences import LIMIT, WEIGHT, between_factors, between_numbers
from rttrr_pin.auditing.match import match
from rttrr_pin.auditing.normalise import Normalised, folded, in_printed_form
from rttrr_pin.auditing.printed import PrintedComponent, PrintedTerm, Reading
from rttrr_pin.derivation.symbol_file import PUBLISHED
from rttrr_pin.derivation.symbols import Role, Symbol, expression_of, factors_of
from rttrr_pin.errors import EquationError
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


def test_planted_misprints_are_found_and_named() -> None:
    """As `python -m tests.fuzz.misprint_campaign`, which has 1,000 of them."""
    cases = [misprint_campaign.case(seed) for seed in range(100)]
    assert all(found for _, found, _ in cases)
    errors = [right for named, _, _ in cases for _, right in named]
    assert sum(errors) >= misprint_campaign.WANTED * len(errors)
    assert {kind for named, _, _ in cases for kind, _ in named} == {str(kind) for kind in Kind}


def test_a_clean_copy_is_not_reported() -> None:
    assert misprint_campaign.clean(0) == []


# Slips and pairing

SYMBOLS = {
    name: Symbol(name, name, role, index=index)
    for name, role, index in (
        *((f"{letter}_{k}", role, k) for letter, role in zip("qva", (Role.COORDINATE, Role.RATE, Role.ACCELERATION), strict=True) for k in (1, 2)),
        *((f"{letter}_{k}", role, k) for letter, role in zip("cs", (Role.COSINE, Role.SINE), strict=True) for k in (1, 2)),
        *((name, Role.PARAMETER, 0) for name in "mlrxyz"),
    )
}  # fmt: skip


def product(text: str):
    powers = Counter(text.split())
    return factors_of(dict(powers))


def printed(*terms) -> list[PrintedTerm]:
    return [PrintedTerm("", (Reading(Fraction(x), product(text)),)) for x, text in terms]


def terms(*terms):
    return expression_of((Fraction(x), product(text)) for x, text in terms)


def paired(text, derived):
    return match(Normalised(PrintedComponent("", tuple(text)), derived, SYMBOLS), {}).pairs


@pytest.mark.parametrize(
    ("wrong", "right", "kinds"),
    [
        ("m l v_1", "m l a_1", (Kind.RATE,)),
        ("m l q_1", "m l v_1", (Kind.RATE,)),
        ("m r a_2 a_2", "m r v_2 v_2", (Kind.RATE,)),
        ("m r v_1", "m r v_1 v_1", (Kind.RATE,)),
        ("m r v_1 v_1", "m r v_1 v_2", (Kind.SYMBOL,)),
        ("m r v_1 v_1", "m r v_2 v_2", (Kind.SYMBOL,)),
        ("m r s_1 s_1", "m r c_1 c_1", (Kind.SYMBOL,)),
        ("m l a_1", "m r a_1", (Kind.SYMBOL,)),
        ("m l v_1", "m r a_1", (Kind.RATE, Kind.SYMBOL)),
        ("m l", "m l c_1", (Kind.SYMBOL,)),
        ("m l", "m l", ()),
    ],
)
def test_one_error_in_a_product(wrong, right, kinds) -> None:
    found = between_factors(product(wrong), product(right), SYMBOLS)
    assert found is not None and found[0] == kinds
    assert (found[1] == 0) == (not kinds)


def test_products_with_nothing_in_common_are_no_error() -> None:
    assert between_factors(product("m l a_1"), product("r x y z v_2"), SYMBOLS) is None


@pytest.mark.parametrize(
    ("wrong", "right", "kinds"),
    [(1, 1, ()), (-1, 1, ("sign",)), (2, 1, ("coefficient",)), (-2, 1, ("sign", "coefficient"))],
)
def test_errors_in_a_number(wrong, right, kinds) -> None:
    assert between_numbers(Fraction(wrong), Fraction(right))[0] == kinds


def test_a_pairing_never_weighs_more_than_all_in_excess_and_all_missing() -> None:
    rng = np.random.default_rng(0)
    names = list(SYMBOLS)
    for _ in range(100):
        some = lambda: [
            (int(rng.integers(1, 4)), " ".join(rng.choice(names, 3))) for _ in range(int(rng.integers(1, 6)))
        ]
        text, right = printed(*some()), terms(*some())
        pairs = paired(text, right)
        assert sorted(pair.place for pair in pairs if pair.place is not None) == list(range(len(text)))
        assert sum(pair.weight for pair in pairs) <= LIMIT / 2 * (len(text) + len(right)) + 1e-9
        assert expression_of(pair.derived for pair in pairs if pair.derived) == right


def test_a_copy_is_a_duplicate_and_the_second_one_is_too_many() -> None:
    pairs = paired(printed((1, "m l"), (2, "r x"), (1, "m l")), terms((1, "m l"), (2, "r x")))
    assert [(pair.place, pair.kinds) for pair in pairs] == [(0, ()), (1, ()), (2, (Kind.DUPLICATE,))]


def test_parts_of_a_coefficient_add_up() -> None:
    pairs = paired(printed((1, "m l"), (1, "m l")), terms((2, "m l")))
    assert all(not pair.kinds for pair in pairs)


def test_a_part_of_a_coefficient_may_be_printed_wrongly() -> None:
    pairs = paired(printed((1, "m l v_1"), (1, "m l q_1")), terms((2, "m l v_1")))
    assert [pair.kinds for pair in pairs] == [(), (Kind.RATE,)]


def test_of_two_readings_the_nearer_one_is_taken() -> None:
    two = PrintedTerm(
        "", (Reading(Fraction(1), product("m v_1 v_1 v_1")), Reading(Fraction(1), product("m r v_1"), "note"))
    )
    (pair,) = paired([two], terms((1, "m r v_1")))
    assert pair.kinds == () and pair.reading is not None and pair.reading.note == "note"


def test_weights_say_how_errors_happen() -> None:
    """One error is likelier than a term in excess and another missing; a copy likelier than two errors in one term."""
    assert max(WEIGHT[kind] for kind in (Kind.RATE, Kind.SIGN, Kind.COEFFICIENT, Kind.SYMBOL)) < LIMIT / 2
    assert WEIGHT[Kind.DUPLICATE] + WEIGHT[Kind.MISSING] < 2 * WEIGHT[Kind.RATE]


@pytest.mark.parametrize("text", [((-1, "m s_1 s_1"),), ((1, "m c_1 c_1"), (-1, "m c_1 c_1"), (-1, "m s_1 s_1"))])
def test_the_form_of_squares_is_the_text_s(text) -> None:
    right = terms((1, "m c_1 c_1"), (-1, "m"))
    form = in_printed_form(right, printed(*text), ["1", "2"])
    assert all(not pair.kinds for pair in paired(printed(*text), form)[:1])
    assert form == terms((-1, "m s_1 s_1"))


def test_sums_of_angles_are_folded() -> None:
    right = terms((2, "m c_1 c_2"), (-2, "m s_1 s_2"), (1, "l s_1 c_2"), (1, "l c_1 s_2"), (1, "r c_1 c_2"))
    assert folded(right, ["1_2"]) == terms((2, "m c_1_2"), (1, "l s_1_2"), (1, "r c_1 c_2"))


# Equations that a user brings

CRAIG = """
title = "Two links"
language = "{language}"
{coordinates}
[robot]
gravity = ["0", "-g", "0"]

[[link]]
joint = "revolute about z"
mass = "m_1"
com = ["l_1", "0", "0"]

[[link]]
joint = "revolute about z"
origin = ["l_1", "0", "0"]
mass = "m_2"
com = ["l_2", "0", "0"]

[[symbol]]
name = "m_<k>"
latex = ["m_<k>"]
dimension = "mass"
k = [1, 2]

[[symbol]]
name = "l_<k>"
latex = ["l_<k>"]
dimension = "length"
k = [1, 2]

[[symbol]]
name = "g"
dimension = "acceleration"

[[equation]]
number = 1
quantity = "tau"
joint = 1
{language} = '''{tau_1}'''

[[equation]]
number = 2
quantity = "tau"
joint = 2
{language} = '''{tau_2}'''
"""

THETA = r"""[coordinates]
position = '\theta_<k>'
velocity = '\dot{\theta}_<k>'
acceleration = '\ddot{\theta}_<k>'"""

LATEX = {
    "language": "latex",
    "coordinates": THETA,
    "tau_1": r"""m_2 l_2^2 (\ddot{\theta}_1 + \ddot{\theta}_2) + m_2 l_1 l_2 c_2 (2\ddot{\theta}_1 + \ddot{\theta}_2)
        + (m_1 + m_2) l_1^2 \ddot{\theta}_1 - m_2 l_1 l_2 s_2 \dot{\theta}_2^2
        - 2 m_2 l_1 l_2 s_2 \dot{\theta}_1 \dot{\theta}_2 + m_2 l_2 g c_{12} + (m_1 + m_2) l_1 g c_1""",
    "tau_2": r"""m_2 l_1 l_2 c_2 \ddot{\theta}_1 + m_2 l_1 l_2 s_2 \dot{\theta}_1^2 + m_2 l_2 g c_{12}
        + m_2 l_2^2 (\ddot{\theta}_1 + \ddot{\theta}_2)""",
}
PYTHON = {
    "language": "python",
    "coordinates": "",
    "tau_1": """m_2*l_2**2*(qdd1 + qdd2) + m_2*l_1*l_2*cos(q2)*(2*qdd1 + qdd2) + (m_1 + m_2)*l_1**2*qdd1
        - m_2*l_1*l_2*sin(q2)*qd2**2 - 2*m_2*l_1*l_2*sin(q2)*qd1*qd2 + m_2*l_2*g*cos(q1 + q2)
        + (m_1 + m_2)*l_1*g*cos(q1)""",
    "tau_2": """m_2*l_1*l_2*cos(q2)*qdd1 + m_2*l_1*l_2*sin(q2)*qd1**2 + m_2*l_2*g*cos(q1 + q2)
        + m_2*l_2**2*(qdd1 + qdd2)""",
}
"""The two-link arm of Craig, "Introduction to Robotics", section 6.7."""


def write(folder: Path, name: str = "equations.toml", **texts: str) -> Path:
    path = folder / name
    path.write_text(CRAIG.format(**texts))
    return path


@pytest.mark.parametrize("texts", [LATEX, PYTHON], ids=["latex", "python"])
def test_a_textbook_s_two_links_are_right(tmp_path, texts) -> None:
    result = audit(read_publication(write(tmp_path, **texts)))
    assert [c.quantity for c in result.components] == ["tau1", "tau2"]
    assert result.passed
    assert all(c.proven and c.evidence and c.evidence.enclosed for c in result.components)


@pytest.mark.parametrize(
    ("texts", "old", "new"), [(LATEX, "c_{12}", "s_{12}"), (PYTHON, "cos(q1 + q2)", "sin(q1 + q2)")]
)
def test_an_error_in_a_sum_of_angles_is_named(tmp_path, texts, old, new) -> None:
    wrong = texts | {"tau_2": texts["tau_2"].replace(old, new)}
    result = audit(read_publication(write(tmp_path, **wrong)))
    (finding,) = result.findings
    assert finding.id == "tau2.1" and finding.kind is Kind.SYMBOL and finding.dimension_ok
    assert finding.derived is not None and old in finding.derived
    (component,) = [c for c in result.components if c.findings]
    assert component.proven and component.evidence and component.evidence.excluded


def test_sums_of_angles_may_be_printed_expanded(tmp_path) -> None:
    texts = LATEX | {"tau_2": LATEX["tau_2"].replace("c_{12}", "(c_1 c_2 - s_1 s_2)")}
    assert audit(read_publication(write(tmp_path, **texts))).passed


def test_garbage_is_unparsed_and_the_rest_is_judged(tmp_path) -> None:
    result = audit(read_publication(write(tmp_path, **LATEX | {"tau_2": r"m_2 l_2 ) \foo + 3"})))
    assert [c.verdict for c in result.components] == [Verdict.MATCH, Verdict.UNPARSED]
    assert result.components[1].unparsed and not result.passed


def test_an_undeclared_symbol_is_the_file_s_and_no_error(tmp_path) -> None:
    """The component has no finding; what to declare is said, with what the derivation has there."""
    texts = LATEX | {"tau_2": LATEX["tau_2"].replace("m_2 l_2 g", "m_2 l_2 G")}
    result = audit(read_publication(write(tmp_path, **texts)))
    assert [c.verdict for c in result.components] == [Verdict.MATCH, Verdict.UNDECLARED]
    (message,) = result.components[1].undeclared
    assert "`G`" in message and "`g`" in message and not result.findings and not result.passed


RP = """
[robot]
gravity = ["0", "-g", "0"]
[coordinates]
position = {position}
velocity = {velocity}
acceleration = {acceleration}
[[link]]
joint = "revolute about z"
mass = "m_1"
com = ["l_1", "0", "0"]
[[link]]
joint = "prismatic along x"
mass = "m_2"
[[symbol]]
name = "m_<i>"
dimension = "mass"
[[symbol]]
name = "l_1"
dimension = "length"
[[symbol]]
name = "g"
dimension = "acceleration"
[[equation]]
quantity = "tau"
joint = 2
latex = '\\tau_2 = m_2\\ddot{{d}}_2 - m_2 d_2\\dot{{\\theta}}_1^2 + m_2 g \\sin(\\theta_1)'
"""
"""A right equation of an R-P arm, whose coordinates are called theta_1 and d_2."""


def rp(folder: Path, *coordinates: str) -> Path:
    path = folder / "rp.toml"
    path.write_text(RP.format(**dict(zip(("position", "velocity", "acceleration"), coordinates, strict=True))))
    return path


def test_coordinates_may_each_have_a_letter_of_their_own(tmp_path) -> None:
    path = rp(
        tmp_path,
        r"['\theta_1', 'd_2']",
        r"['\dot{\theta}_1', '\dot{d}_2']",
        r"['\ddot{\theta}_1', '\ddot{d}_2']",
    )
    assert audit(read_publication(str(path))).passed


def test_a_coordinate_s_letter_that_is_not_declared_is_asked_for(tmp_path) -> None:
    path = rp(tmp_path, r"'\theta_<k>'", r"'\dot{\theta}_<k>'", r"'\ddot{\theta}_<k>'")
    (component,) = audit(read_publication(path)).components
    assert component.verdict is Verdict.UNDECLARED and not component.findings
    assert [text.split("`")[1] for text in component.undeclared] == [r"\ddot{d}_2", "d_2"]
    assert all("[coordinates]" in text for text in component.undeclared)


@pytest.mark.parametrize("spelling", [r"'\\theta_<k>'", "['x', 'y', 'z']", "''"])
def test_a_spelling_that_is_no_symbol_names_the_file(tmp_path, spelling) -> None:
    with pytest.raises(EquationError, match=r"rp\.toml"):
        read_publication(rp(tmp_path, spelling, r"'\dot{\theta}_<k>'", r"'\ddot{\theta}_<k>'"))


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('mass = "m_1"', 'mass = "m_3"', "m_3"),
        ('mass = "m_1"', 'mas = "m_1"', "did you mean mass"),
        ('joint = "revolute about z"', 'joint = "revolute"', "revolute about z"),
        ('dimension = "mass"', 'dimension = "weight"', "expected"),
        ('quantity = "tau"', 'quantity = "torque"', "expected"),
        ("joint = 1", "joint = 7", "expected 1 to 2"),
        ('gravity = ["0", "-g", "0"]', 'gravity = ["0", "-g"]', "expected 3"),
        ('language = "latex"', 'language = "tex"', "expected"),
        ("k = [1, 2]", "k = [1, 1]", "declared twice"),
        ("[robot]", "[robot", "TOML"),
        ('joint = 2', 'joint = 1', "leave one"),
    ],
)  # fmt: skip
def test_a_wrong_file_says_what_is_wrong(tmp_path, old, new, told) -> None:
    path = write(tmp_path, **LATEX)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(EquationError, match=told) as caught:
        read_publication(path)
    assert "equations.toml" in str(caught.value)


def test_yaml_is_read_too(tmp_path) -> None:
    import tomllib

    import yaml

    data = tomllib.loads(CRAIG.format(**LATEX))
    path = tmp_path / "equations.yaml"
    path.write_text(yaml.safe_dump(data))
    assert audit(read_publication(path)).passed


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('origin = ["l_2", "l_3", "h_3"]', 'origin = ["l_2", "l_2", "h_3"]', "origin y of link_3"),
        ("prismatic along y", "prismatic along x", "joint_3 is prismatic"),
    ],
)
def test_the_table_of_frames_must_fit_the_urdf(tmp_path, old, new, message) -> None:
    symbols = (PUBLISHED / "rttrr.toml").read_text()
    assert old in symbols
    (tmp_path / "mine.toml").write_text(symbols.replace(old, new))
    (tmp_path / "a.toml").write_text('symbols = "mine.toml"\n[[equation]]\nquantity = "definition"\nlatex = "x"\n')
    with pytest.raises(EquationError, match=message):
        read_publication(tmp_path / "a.toml")


def test_symbols_of_a_robot_that_has_none_name_those_there_are(tmp_path) -> None:
    (tmp_path / "a.toml").write_text('symbols = "nobody"\n[[equation]]\nquantity = "definition"\nlatex = "x"\n')
    with pytest.raises(EquationError, match="one of rttrr"):
        read_publication(tmp_path / "a.toml")


def test_equations_of_one_component_can_be_given_apart(paper) -> None:
    (equation,) = [x for x in paper.equations if x.number == 22]
    result = audit(replace(paper, equations=(equation,), conventions=()))
    assert [c.quantity for c in result.components] == ["F5z"]
    assert (result.components[0].printed_terms, result.components[0].derived_terms) == (25, 25)
