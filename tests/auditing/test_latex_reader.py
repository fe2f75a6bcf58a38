"""The readers of printed equations: the paper's own, textbook spellings, doubtful tokens and text that is no equation."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rttrr_pin.auditing.reading.vocabulary import Vocabulary
from rttrr_pin.derivation.symbols import Factors, factors_of
from rttrr_pin.errors import InputError
from support.printed import COMPARED, EQUATIONS, TEXTBOOK, one, read, readings, splits_of, values

# --- the paper


def test_the_file_has_each_equation_once_in_order() -> None:
    assert list(EQUATIONS) == list(range(1, 44))
    assert len(COMPARED) == 34 and sum(len(EQUATIONS[number]["components"]) for number in COMPARED) == 60


@pytest.mark.parametrize("number", COMPARED)
def test_every_component_of_the_paper_is_read(number: int) -> None:
    equation = EQUATIONS[number]
    splits = splits_of(number)
    assert len(splits) == (15 if number == 31 else 1)
    for split in splits:
        assert len(split.components) == len(equation["components"])
        assert [component.unparsed for component in split.components] == [""] * len(equation["components"])
        assert bool(split.note) == (number == 31)


@pytest.mark.parametrize(
    ("number", "counts"),
    [
        *((9, (2, 2, 1)), (11, (6, 6, 2)), (12, (15, 15, 2)), (13, (21,)), (16, (2, 2, 1)), (18, (6, 6, 2))),
        *((22, (25,)), (23, (2, 2, 1)), (26, (5, 5, 2)), (33, (37,)), (34, (10,)), (37, (12,)), (43, (15,))),
    ],
)
def test_as_many_terms_as_counted_by_hand(number: int, counts: tuple[int, ...]) -> None:
    (split,) = splits_of(number)
    assert tuple(len(component.terms) for component in split.components) == counts


def test_the_first_and_last_equation_by_hand() -> None:
    (split,) = splits_of(16)
    x, y, z = (values(component.terms) for component in split.components)
    assert x == [(-1, factors_of({"M_1": 1, "a_1": 1, "r_C1y": 1})), (-1, factors_of({"M_1": 1, "v_1": 2, "r_C1x": 1}))]
    assert y == [(1, factors_of({"M_1": 1, "a_1": 1, "r_C1x": 1})), (-1, factors_of({"M_1": 1, "v_1": 2, "r_C1y": 1}))]
    assert z == [(1, factors_of({"M_1": 1, "g": 1}))]
    terms = read(EQUATIONS[43]["latex"])
    assert terms[5].text == r"+ s q_5 M_5 \cdot {}^5 r_{C_{5z}} \dot{q}_5^2" and terms[0].text == "M_5 g"
    assert values(terms)[5] == (1, factors_of({"s_5": 1, "M_5": 1, "r_C5z": 1, "v_5": 2}))
    assert values(terms)[-1] == (1, factors_of({"M_1": 1, "g": 1}))


def test_the_lost_boundary_of_31_is_one_of_its_splits() -> None:
    splits = splits_of(31)
    counted = [
        split for split in splits if tuple(len(component.terms) for component in split.components) == (23, 22, 26)
    ]
    (split,) = counted
    assert [component.terms[0].text for component in split.components] == [
        *("{}^6 f_x", "{}^6 f_y", r"- M_5 c q_5 \cdot g")
    ]
    assert r"component 3 begins with row 12, `- M_5 c q_5 \cdot g -" in split.note
    assert "left out" in split.note and r"`\right]` of component 3" in split.note
    assert all(sum(len(component.terms) for component in split.components) == 71 for split in splits)


def test_the_symbols_that_the_paper_has_only_by_misplaced_superscripts() -> None:
    unknown = {
        (number, spelling)
        for number in COMPARED
        for split in splits_of(number)
        for component in split.components
        for term in component.terms
        for reading in term.readings
        for spelling in reading.unknown
    }
    centres = [("r_{C_{5x}}", (35, 36, 37, 38)), ("r_{C_{5z}}", (35, 36, 37, 38))]
    expected = {(number, spelling) for spelling, numbers in centres for number in numbers}
    assert unknown == expected | {(18, "r_{C_{3x}}"), (18, "r_{C_{3y}}")}


def test_the_doubtful_terms_of_the_paper_are_these() -> None:
    doubtful = {}
    for number in COMPARED:
        split = splits_of(number)[0]
        terms = [term for component in split.components for term in component.terms]
        doubtful[number] = sum(len(term.readings) > 1 for term in terms)
        assert all(len(term.readings) == 2 for term in terms if term.readings[0].note)
    assert {number: count for number, count in doubtful.items() if count} == {
        **{18: 2, 33: 1, 35: 2, 36: 2, 37: 2, 38: 2, 39: 4, 42: 4}
    }


# --- spellings


@pytest.mark.parametrize(
    "text",
    [
        *(
            r"c q_4",
            r"cq_4",
            r"c q_{4}",
            r"\cos q_4",
            r"\cos(q_4)",
            r"\cos\left( q_4 \right)",
            r"c_4",
            r"C_4",
            r"c_{4}",
        ),
        *(r"\mathrm{c}_4", r"\mathrm{c}q_4", r"c_{q_4}", r"\operatorname{cos} q_4", r"\mathrm{cos}\,q_4", r"cos(q_4)"),
        *(r"{c}q_4", r"\cos{q_4}", r"\cos [q_4]", r"\text{c}q_4"),
    ],
)
def test_spellings_of_a_cosine(text: str) -> None:
    assert one(text) == (1, {"c_4": 1})
    assert one(f"2 {text} l_2") == (2, {"c_4": 1, "l_2": 1})


@pytest.mark.parametrize("text", [r"s^2 q_5", r"s^2q_5", r"\sin^2 q_5", r"\sin^{2}(q_5)", r"s_5^2", r"\sin(q_5)^2"])
def test_spellings_of_a_sine_squared(text: str) -> None:
    assert one(text) == (1, {"s_5": 2})


@pytest.mark.parametrize(
    "text",
    [
        *(r"\cos(q_1+q_2)", r"\cos(q_2 + q_1)", r"c(q_1+q_2)", r"c_{12}", r"C_{12}", r"c_{1,2}", r"c_{1+2}"),
        *(r"c_{q_1+q_2}", r"\cos{(q_1 + q_2)}"),
    ],
)
def test_spellings_of_the_cosine_of_a_sum(text: str) -> None:
    assert one(text) == (1, {"c_1_2": 1})


def test_indices_past_nine_are_separated() -> None:
    many = Vocabulary({f"q_{{{k}}}": f"q_{k}" for k in range(1, 13)})
    assert one("c_{1,12}", many) == (1, {"c_1_12": 1})
    assert one("c_{12}", many) == (1, {"c_1_2": 1})
    assert one(r"\sin q_{12}", many) == (1, {"s_12": 1})


@pytest.mark.parametrize(
    "text",
    [
        r"\dot{q}_1^2",
        r"\dot{q}_{1}^{2}",
        r"\dot q_1^2",
        r"\dot{q_1}^2",
        r"\dot{q}^2_1",
        r"{\dot{q}_1}^2",
        r"(\dot q_1)^2",
    ],
)
def test_spellings_of_a_squared_rate(text: str) -> None:
    assert one(text) == (1, {"v_1": 2})
    assert one(f"{text}2") == (2, {"v_1": 2})


@pytest.mark.parametrize(
    "text",
    [
        *(r"{}^5J_{xy}^*", r"{}^5J^*_{xy}", r"{}^{5}J_{yx}^{*}", r"{}^5 J_{x y}^\ast", r"2 \cdot^5J_{xy}^* / 2"),
        *(r"{ }^5 J^{*}_{ xy }", r"{}^5\mathrm{J}_{xy}^*", r"^5J_{xy}^*"),
    ],
)
def test_spellings_of_a_product_of_inertia(text: str) -> None:
    assert one(text) == (1, {"J_5xy": 1})


@pytest.mark.parametrize(
    ("text", "value"),
    [
        *(
            (r"\frac{1}{2}", "1/2"),
            (r"\frac12", "1/2"),
            (r"1/2", "1/2"),
            (r"0.5", "1/2"),
            (r"2.5 \cdot 10^{-3}", "1/400"),
        ),
        *((r"-\dfrac{3}{4}", "-3/4"), (r".25", "1/4"), (r"(1+2)/4", "3/4"), (r"\frac{1}{2}\frac{1}{3}", "1/6")),
    ],
)
def test_numbers_are_exact(text: str, value: str) -> None:
    assert sum(coefficient for coefficient, _ in values(read(f"{text} g"))) == Fraction(value)


def test_textbook_equation_of_two_links() -> None:
    text = r"""
    \begin{align}
      \tau_1 &= m_2 l_1 l_2 \sin\theta_2 \, \dot\theta_2^2 - 2 m_2 l_1 l_2 \sin(\theta_2) \dot{\theta}_1 \dot{\theta}_2 \\
        &\quad + m_2 l_2 g \cos(\theta_1+\theta_2) + \left(m_1 + m_2\right) l_1 g c_1 + l_1^2 \ddot\theta_1. \tag{6.58}
    \end{align}"""
    assert values(read(text, TEXTBOOK)) == [
        (1, factors_of({"m_2": 1, "l_1": 1, "l_2": 1, "s_2": 1, "v_2": 2})),
        (-2, factors_of({"m_2": 1, "l_1": 1, "l_2": 1, "s_2": 1, "v_1": 1, "v_2": 1})),
        (1, factors_of({"m_2": 1, "l_2": 1, "g": 1, "c_1_2": 1})),
        (1, factors_of({"m_1": 1, "l_1": 1, "g": 1, "c_1": 1})),
        (1, factors_of({"m_2": 1, "l_1": 1, "g": 1, "c_1": 1})),
        (1, factors_of({"l_1": 2, "a_1": 1})),
    ]


ITEMS: dict[str, tuple[str, ...]] = {
    "M_5": ("M_5", "M_{5}", r"\mathrm{M}_5"),
    "l_3": ("l_3", "l_{3}"),
    "g": ("g", "{g}"),
    "q_3": ("q_3", "q_{3}"),
    "v_1": (r"\dot{q}_1", r"\dot q_1", r"\dot{q_1}", r"\dot{q}_{1}"),
    "a_5": (r"\ddot{q}_5", r"\ddot q_{5}"),
    "r_C5x": ("{}^5r_{C_{5x}}", "{}^{5}r_{C_{5 x}}", "{ }^5 r_{{C}_{5x}}".replace("{C}", "C")),
    "J_5xy": ("{}^5J_{xy}^*", "{}^5J^*_{xy}", "{}^5 J_{yx}^{*}"),
    "f_6z": ("{}^6f_z", "{}^6 f_{z}"),
    "c_4": ("c_4", "c_{4}", r"\mathrm{c}_4", "C_4"),
    "s_1_2": ("s_{12}", "s_{1,2}"),
}
FUNCTIONS: dict[str, tuple[str, ...]] = {
    "c_5": ("c{} q_5", r"\cos{} q_5", r"\cos{}(q_5)", "c{}q_{{5}}"),
    "s_4": ("s{} q_4", r"\sin{}\left(q_4\right)", "s{}q_4"),
}


@st.composite
def formatted(draw: st.DrawFn) -> tuple[list[tuple[Fraction, Factors]], str]:
    """A sum and one of the ways to print it."""
    wanted, text = [], ""
    for n in range(draw(st.integers(1, 5))):
        sign = draw(st.sampled_from("+-" if n else ("", "-")))
        number = draw(st.sampled_from((1, 2)))
        names = draw(st.lists(st.sampled_from((*ITEMS, *FUNCTIONS)), min_size=1, max_size=4, unique=True))
        powers = {name: draw(st.sampled_from((1, 1, 2))) for name in names}
        pieces = ["2"] if number == 2 else []
        for name, power in powers.items():
            above = "" if power == 1 else draw(st.sampled_from(("^2", "^{2}")))
            spelling = draw(st.sampled_from(ITEMS.get(name, FUNCTIONS.get(name, ()))))
            pieces.append(spelling + above if name in ITEMS else spelling.format(above))
        product = pieces[0]
        for piece in pieces[1:]:
            product += draw(st.sampled_from((" ", r"\cdot ", r" \, ", "~", r" \cdot ", r"\times "))) + piece
        broken = (
            draw(st.sampled_from(("{0} ", " {0} ", " {0} \\\\ & {0} ", " {0} \\\\\n", " \\\\ & {0} "))) if n else "{0} "
        )
        text += broken.format(sign) + product
        wanted.append((Fraction(-number if sign == "-" else number), factors_of(powers)))
    around = draw(st.sampled_from(("{}", "{};", "F_x = {}", "\\begin{{aligned}} F = & {} \\end{{aligned}} \\quad (3)")))
    return wanted, around.format(text)


@settings(max_examples=150)
@given(formatted())
def test_formatting_changes_nothing(case: tuple[list[tuple[Fraction, Factors]], str]) -> None:
    wanted, text = case
    assert values(read(text)) == wanted


# --- brackets


def test_brackets_are_expanded_and_say_where_each_term_is_from() -> None:
    terms = read(r"-M_3 (g + \ddot{q}_2 - l_2) l_3 + g")
    assert [term.text for term in terms] == [
        *("-M_3 (g ...) l_3", r"-M_3 (... + \ddot{q}_2 ...) l_3", "-M_3 (... - l_2) l_3", "+ g")
    ]
    assert [coefficient for coefficient, _ in values(terms)] == [-1, -1, 1, 1]
    assert values(terms)[2][1] == factors_of({"M_3": 1, "l_2": 1, "l_3": 1})


def test_brackets_in_brackets_and_powers_of_brackets() -> None:
    assert values(read(r"2[g - (l_2 - l_3)]")) == [(2, (("g", 1),)), (-2, (("l_2", 1),)), (2, (("l_3", 1),))]
    squared = values(read(r"\frac{(l_2 - q_3)^2}{2}"))
    assert sum((c for c, f in squared if f == factors_of({"l_2": 1, "q_3": 1})), Fraction()) == -1
    assert [c for c, f in squared if f == (("q_3", 2),)] == [Fraction(1, 2)]
    spread = read("M_5 \\left( l_2 + \\right. \\\\ & \\left. + l_3 \\right) g")
    assert values(spread) == [(1, factors_of({"M_5": 1, "g": 1, x: 1})) for x in ("l_2", "l_3")]


@pytest.mark.parametrize(
    "text",
    [
        r"M_3 \cdot \\ & \cdot g",
        r"M_3 \cdot \\ g",
        r"M_3 \\ & \times g",
        r"M_3 g = F_3",
        r"{}^5\bar{f}_5 \\ & = M_3 g",
        r"F = \\ M_3 g",
    ],
)
def test_a_product_over_lines_and_names_on_either_side(text: str) -> None:
    assert one(text) == (1, {"M_3": 1, "g": 1})


def test_a_plain_term_is_shown_as_printed() -> None:
    terms = read("M_5   g -  \\\\ & - 2 M_4\n g + l_2")
    assert [term.text for term in terms] == ["M_5 g", "- 2 M_4 g", "+ l_2"]


# --- what the print leaves open


def test_a_power_may_be_a_frame() -> None:
    literal, moved = readings(r"\dot{q}_1^3 r_{C_{3y}}")
    assert literal == (1, {"v_1": 3, "r_C3y_": 1}) and moved == (1, {"v_1": 1, "r_C3y": 1})
    (term,) = read(r"\dot{q}_1^3 r_{C_{3y}}")
    assert term.readings[0].unknown == ("r_{C_{3y}}",) and term.readings[1].unknown == ()
    assert "power 3" in term.readings[0].note and "{}^3r_{C_{3y}}" in term.readings[1].note
    assert readings(r"M_5\ddot{q}_5^5r_{C_{5x}}")[1] == (1, {"M_5": 1, "a_5": 1, "r_C5x": 1})
    assert len(readings(r"\ddot{q}_5^5r_{C_{5x}} \dot{q}_1^3 r_{C_{3y}}")) == 4


def test_a_power_stays_one_where_no_symbol_takes_it_as_frame() -> None:
    assert one(r"\dot{q}_1^2 l_3 q_1^2") == (1, {"v_1": 2, "l_3": 1, "q_1": 2})
    assert len(readings(r"\dot{q}_1^3 \cdot r_{C_{3y}}")) == 1
    assert len(readings(r"\dot{q}_1^4 r_{C_{3y}}")) == 1


def test_a_superscript_before_what_has_no_frame() -> None:
    ignored, power = readings(r"c q_5 \cdot {}^4 \dot{q}_4")
    assert ignored == (1, {"c_5": 1, "v_4": 1}) and power == (1, {"c_5": 4, "v_4": 1})
    assert "power 4 of cq_5" in read(r"c q_5 \cdot {}^4 \dot{q}_4")[0].readings[1].note
    assert readings(r"M_5 \cdot {}^5 s q_4") == [(1, {"M_5": 1, "s_4": 1}), (1, {"M_5": 5, "s_4": 1})]
    assert readings(r"M_5 \cdot^5 2 g") == [(2, {"M_5": 1, "g": 1}), (2, {"M_5": 5, "g": 1})]
    assert readings(r"{}^4 M_5") == [(1, {"M_5": 1})] and "ignored" in read(r"{}^4 M_5")[0].readings[0].note
    assert readings(r"\dot{q}_1^2 \cdot {}^4 \dot{q}_4") == [(1, {"v_1": 2, "v_4": 1})]


def test_signs_that_disagree_around_a_line_break() -> None:
    assert [term.readings[0].coefficient for term in read(r"g - \\ & - M_5 + \\ + M_4")] == [1, -1, 1]
    assert readings(r"+ \\ & - g") == [(-1, {"g": 1}), (1, {"g": 1})]
    assert readings(r"- \\ & + g") == [(1, {"g": 1}), (-1, {"g": 1})]


def test_two_signs_in_one_line() -> None:
    assert readings("+ - g") == [(-1, {"g": 1}), (1, {"g": 1})]
    assert readings("- - g") == [(1, {"g": 1}), (-1, {"g": 1})]
    assert readings("+ + g") == [(1, {"g": 1})]


def test_an_angle_is_also_a_factor() -> None:
    assert one("q_5 c q_5") == (1, {"q_5": 1, "c_5": 1})
    assert one(r"s q_5 \cdot q_5") == (1, {"s_5": 1, "q_5": 1})
    assert read(r"s \cdot q_5")[0].readings[0].unknown == ("s",)
    (reading,) = read("c q_4^2")[0].readings
    assert reading.factors == (("c_4", 2),) and "power 2" in reading.note


def test_a_c_that_is_a_symbol_of_the_text() -> None:
    damped = Vocabulary({"c": "c", "q_1": "q_1", r"\dot{q}_1": "v_1"})
    assert one(r"c \dot{q}_1", damped) == (1, {"c": 1, "v_1": 1})
    (term,) = read("c q_1", damped)
    assert [dict(reading.factors) for reading in term.readings] == [{"c": 1, "q_1": 1}, {"c_1": 1}]
    assert all(reading.note for reading in term.readings)


def test_readings_of_a_bracket_and_of_what_it_is_multiplied_by_are_combined() -> None:
    first, second = read(r"+ - M_5 (g + \dot{q}_1^3 r_{C_{3y}})")
    assert len(first.readings) == 2 and len(second.readings) == 4
    assert {reading.coefficient for reading in second.readings} == {1, -1}


# --- unknown symbols


def test_an_unknown_symbol_is_kept_by_a_name_of_its_own() -> None:
    bare = Vocabulary({"q_1": "q_1"})
    (term,) = read(r"{}^5J_x^* {}^5r_{C_{5x}} \dot{x}_3 \omega", bare)
    (reading,) = term.readings
    assert reading.factors == factors_of({"J_5x": 1, "r_C5x": 1, "dot_x_3": 1, "omega": 1})
    assert reading.unknown == ("{}^5J_x^*", "{}^5r_{C_{5x}}", r"\dot{x}_3", r"\omega")
    clash = Vocabulary({"q_1": "q_1", "I_x": "J_5x"})
    assert read(r"{}^5J_x^*", clash)[0].readings[0].factors == (("J_5x_", 1),)
    assert read("c_9", clash)[0].readings[0].factors == (("c_9_", 1),)


@pytest.mark.parametrize("spelling", ["", "q_1 q_2", "-q_1", "q_1^2", "2", r"\sqrt{x}", "(q_1)"])
def test_a_spelling_is_one_symbol(spelling: str) -> None:
    with pytest.raises(InputError, match="no spelling of a symbol"):
        Vocabulary({spelling: "x"})


def test_two_names_for_one_symbol_are_refused() -> None:
    assert Vocabulary({"J_{xy}^*": "J", "J^*_{x y}": "J"}).names == {"J"}
    with pytest.raises(InputError, match="a symbol has one name"):
        Vocabulary({"J_{xy}^*": "J", "J^*_{x y}": "K"})
