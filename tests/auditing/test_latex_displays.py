"""Displays of several components, and texts that are no equation: what is read of them, and what is said."""

from __future__ import annotations

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rttrr_pin.auditing.read import read_latex
from support.printed import PAPER, fault, values


@pytest.mark.parametrize(
    "text",
    [
        r"F = \begin{bmatrix} g \\ -M_5 + \\ + M_4 \\ -q_1 - \\ -q_2 \end{bmatrix}; \quad (3)",
        r"\begin{pmatrix} g & -M_5 + M_4 & -q_1 - q_2 \end{pmatrix}^T = F",
        r"F = \left[ \begin{array}{c} g, \\ -M_5 + M_4, \\ -q_1 - q_2 \end{array} \right] \tag{3}",
        "\\begin{align} F_x &= g, \\\\ F_y &= -M_5 \\\\ & + M_4, \\\\ F_z &= -q_1 - \\\\ &- q_2. \\end{align}",
        r"g \\ -M_5 + M_4 \\ -q_1 - \\ - q_2",
    ],
)
def test_displays_of_three_components(text: str) -> None:
    (split,) = read_latex(text, PAPER, 3)
    assert [values(component.terms) for component in split.components] == [
        [(1, (("g", 1),))],
        [(-1, (("M_5", 1),)), (1, (("M_4", 1),))],
        [(-1, (("q_1", 1),)), (-1, (("q_2", 1),))],
    ]


def test_a_matrix_with_a_row_too_few_is_divided_in_every_way() -> None:
    splits = read_latex(r"\begin{bmatrix} g + \\ + M_5 \\ q_1 - \\ - q_2 \end{bmatrix}", PAPER, 3)
    assert [[len(component.terms) for component in split.components] for split in splits] == [[1, 1, 2], [2, 1, 1]]
    assert all("boundary is not printed" in split.note for split in splits)


@pytest.mark.parametrize(
    ("text", "components", "message"),
    [
        *(
            (r"\begin{bmatrix} g \\ q_1 \end{bmatrix}", 3, "shows 2 components in 2 rows, expected 3"),
            ("", 1, "no equation"),
        ),
        *(
            (r"\begin{cases} g \\ q_1 \end{cases}", 2, "environment `cases`"),
            (r"M \begin{bmatrix} g \end{bmatrix}", 1, "before"),
        ),
        *((r"\begin{bmatrix} g \end{bmatrix} + q_1", 1, "behind the matrix"), ("a = b = c", 1, "second =")),
        *(
            (r"F - g = M_5 q_1", 1, "one symbol"),
            (r"\begin{bmatrix} g & g \\ g & g \end{bmatrix}", 2, "rows and columns"),
        ),
        *((r"F_x = g \\ F_y = q_1", 1, "shows 2 components"), (r"g \\ q_1", 1, "neither does the line before")),
    ],
)
def test_displays_that_are_not_what_was_stated(text: str, components: int, message: str) -> None:
    (split,) = read_latex(text, PAPER, components)
    assert len(split.components) == components
    for component in split.components:
        assert component.terms == () and message in component.unparsed and component.unparsed.startswith("character ")


# --- what is no equation


@pytest.mark.parametrize(
    ("before", "bad", "after"),
    [
        *(
            ("g + ", r"\sqrt{2}", " M_5"),
            ("M_5 ", "? 3", ""),
            ("g + (M_5 ", "]", ""),
            ("", "g + M_5", " = b + q_1 q_2"),
        ),
        *(
            ("q_1 ", r"\quad (3)", " + q_2"),
            ("g + ", r"\sinh q_1", ""),
            ("g ", r"\cdot\cdot", " M_5"),
        ),
        *(("g + ", r"\frac{g}{0 M_5}", " q_1"), ("g - ", "M_5^{-1}", ""), ("g + ", r"\sin", " + g"), ("g ", "< 3", "")),
        *(
            (r"\cos", r"(q_1 - M_5)", " g"),
            ("g_2", "_3", ""),
            ("g + ", "q_1_2", ""),
            ("g ", "| M_5", "| q_1"),
            ("g ", "} g", ""),
        ),
        *(
            ("g + ", "10^{999999999}", ""),
            ("g + ", "{M_5 + g}", " q_1"),
            ("", "(1 + g)^{300}", " + g"),
            ("g + g", "^2^3", ""),
            (r"\cos", "(q_1^2)", " g"),
            ("g ", "/ (M_5 - M_5)", " q_1"),
            (r"\cos", "(q_1 / 3)", ""),
            ("g /", "0", ""),
        ),
    ],
)
def test_what_cannot_be_read_is_told_with_its_place(before: str, bad: str, after: str) -> None:
    message = fault(before + bad + after)
    place = re.match(r"character (\d+) \(line 1, column (\d+)\), at ", message)
    assert place is not None and place[1] == place[2]
    assert len(before) <= int(place[1]) - 1 <= len(before + bad)


def test_what_was_wanted_is_told() -> None:
    assert "got `]`, wanted a symbol, a number, + or -, an operator, an opening bracket" in fault("g + (M_5 ] + g")
    assert "wanted a symbol, a number, an opening bracket, {" in fault("g + M_5 /") and "ends here" in fault(
        "g + M_5 /"
    )


def test_the_place_counts_lines() -> None:
    assert fault("g +\n M_5 + \\sqrt{2}").startswith(r"character 12 (line 2, column 8), at `\sqrt{2}`")


def test_one_component_that_cannot_be_read_leaves_the_others() -> None:
    (split,) = read_latex(r"\begin{bmatrix} g \\ \sqrt{g} \\ q_1 \end{bmatrix}", PAPER, 3)
    assert [len(component.terms) for component in split.components] == [1, 0, 1]
    assert split.components[1].text == r"\sqrt{g}" and "sqrt" in split.components[1].unparsed


def test_a_bracket_without_a_partner_is_told_unless_it_may_be_the_vectors() -> None:
    (split,) = read_latex(r"[g + q_1 \\ M_5 ] - g \\ (M_4 + g)]", PAPER, 3)
    assert [len(component.terms) for component in split.components] == [2, 0, 2]
    assert split.components[1].unparsed.startswith("character 17 ") and split.note.count("no partner") == 2


def test_brackets_nested_without_end_are_told() -> None:
    assert "too many brackets" in fault("(" * 4000 + "g" + ")" * 4000)


@settings(max_examples=150)
@given(
    st.lists(
        st.sampled_from(
            list(r"{}()[]^_+-*/=&,.;123gqcs'")
            + [
                *(r"\\", r"\dot", r"\frac", r"\cos", r"\left[", "{}^5", " "),
                "M_5",
                r"\begin{bmatrix}",
                r"\end{bmatrix}",
                r"\foo",
            ]
        ),
        max_size=14,
    ),
    st.integers(1, 3),
)
def test_no_text_raises(pieces: list[str], components: int) -> None:
    for split in read_latex("".join(pieces), PAPER, components):
        assert len(split.components) == components
        assert all(bool(component.terms) != bool(component.unparsed) for component in split.components)
