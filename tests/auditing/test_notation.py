"""Corrections are printed as the publication spells its letters."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import pytest

from rttrr_pin.auditing import AuditResult, ComponentAudit, Kind, Publication, Verdict, audit, read_publication
from rttrr_pin.auditing.read import read_latex
from rttrr_pin.auditing.reading.vocabulary import Vocabulary
from rttrr_pin.derivation.latex import latex_power
from rttrr_pin.derivation.symbols import Role, Symbol
from support.two_links import LINKS

FILE = (
    """
language = "{language}"
[coordinates]
position = {position}
velocity = '{velocity}'
acceleration = '{acceleration}'
"""
    + LINKS
    + """
[[symbol]]
name = "m_<k>"
latex = {masses}
dimension = "mass"
k = [1, 2]
[[symbol]]
name = "l_<k>"
latex = ['l_<k>', 'a_<k>']
dimension = "length"
k = [1, 2]
[[symbol]]
name = "g"
dimension = "acceleration"
"""
)

EQUATION = """
[[equation]]
number = {joint}
quantity = "tau"
joint = {joint}
{language} = '''{text}'''
"""

LATEX = {
    1: r"""m_2 l_2^2 (\ddot{\theta}_1 + \ddot{\theta}_2) + 2 m_2 l_1 l_2 COS2 \ddot{\theta}_1
        + m_2 l_1 l_2 COS2 \ddot{\theta}_2 + m_1 l_1^2 \ddot{\theta}_1
        + m_2 l_1^2 \ddot{\theta}_1
        - m_2 l_1 l_2 SIN2 \dot{\theta}_2^2 - 2 m_2 l_1 l_2 SIN2 \dot{\theta}_1 \dot{\theta}_2
        + m_2 l_2 g COS12 + (m_1 + m_2) l_1 g COS1""",
    2: r"""m_2 l_1 l_2 COS2 \ddot{\theta}_1 + m_2 l_1 l_2 SIN2 \dot{\theta}_1^2 + m_2 l_2 g COS12
        + m_2 l_2^2 \ddot{\theta}_1 + m_2 l_2^2 \ddot{\theta}_2""",
}
PYTHON = {
    1: """M2*L2**2*(A1 + A2) + 2*M2*L1*L2*COS2*A1 + M2*L1*L2*COS2*A2 + M1*L1**2*A1 + M2*L1**2*A1
        - M2*L1*L2*SIN2*V2**2 - 2*M2*L1*L2*SIN2*V1*V2 + M2*L2*g*COS12 + (M1 + M2)*L1*g*COS1""",
    2: "M2*L1*L2*COS2*A1 + M2*L1*L2*SIN2*V1**2 + M2*L2*g*COS12 + M2*L2**2*A1 + M2*L2**2*A2",
}
"""The two-link arm of a textbook."""


@dataclass(frozen=True)
class Notation:
    """How one author writes; `spelled` is put for the words of the texts above."""

    language: str
    spelled: dict[str, str]
    position: str = r"'\theta_<k>'"
    velocity: str = r"\dot{\theta}_<k>"
    acceleration: str = r"\ddot{\theta}_<k>"
    masses: str = "['M_<k>', 'm_<k>']"

    def texts(self) -> dict[int, str]:
        texts = dict(LATEX if self.language == "latex" else PYTHON)
        for word, spelling in sorted(self.spelled.items(), key=lambda pair: -len(pair[0])):
            texts = {joint: text.replace(word, spelling) for joint, text in texts.items()}
        return texts

    def publication(self, folder: Path, texts: dict[int, str]) -> Publication:
        values = {key: value for key, value in vars(self).items() if key != "spelled"}
        equations = (EQUATION.format(joint=k, language=self.language, text=text) for k, text in texts.items())
        (folder / "a.toml").write_text(FILE.format(**values) + "".join(equations))
        return read_publication(folder / "a.toml")


def latex(one: str, summed: str, **changes: str) -> Notation:
    """Spellings with f for the function, c or s, and k for the angle."""
    put = lambda form, f, k: (
        form.replace("FUN", {"c": "cos", "s": "sin"}[f]).replace("F", f.upper()).replace("f", f).replace("k", k)
    )
    spelled = {f"{word}{k}": put(one, f, k) for word, f in (("COS", "c"), ("SIN", "s")) for k in "12"}
    spelled |= {"COS12": put(summed, "c", "12")}
    return Notation("latex", {**spelled, **changes})


def python(module: str, q: str, v: str, a: str, first: int, **changes: str) -> Notation:
    at = lambda form, k: form.replace("<k>", str(k + first))
    spelled = {f"{x}{k + 1}": at(form, k) for x, form in zip("VA", (v, a), strict=True) for k in range(2)}
    spelled |= {
        f"{word}{k + 1}": f"{module}{f}({at(q, k)})" for word, f in (("COS", "cos"), ("SIN", "sin")) for k in range(2)
    }
    spelled |= {
        "COS12": f"{module}cos({at(q, 0)} + {at(q, 1)})",
        **{f"{x}{k}": f"{x.lower()}_{k}" for x in "ML" for k in "12"},
    }
    masses = changes.pop("masses", "['m_<k>']")
    return Notation("python", {**spelled, **changes}, f"'{q}'", v, a, masses)


NOTATIONS = {
    "s_2": latex("f_k", "f_{k}"),
    "s_{2}": latex("f_{k}", "f_{k}"),
    "S_2": latex("F_k", "F_{k}"),
    "s theta_2": latex(r"f\theta_k", "f_{k}"),
    "sin theta_2": latex(r"\FUN\theta_k", r"\FUN(\theta_1 + \theta_2)"),
    "sin(theta_2)": latex(r"\FUN(\theta_k)", r"\FUN(\theta_1+\theta_2)"),
    "a_1": latex("f_k", "f_{k}", **{"l_": "a_"}),
    "rm s_2": latex(r"\mathrm{f}_k", r"\mathrm{f}_{k}"),
    "sin(q2)": python("", "q<k>", "qd<k>", "qdd<k>", 1),
    "np.sin(q2)": python("np.", "q<k>", "qd<k>", "qdd<k>", 1),
}
"""By how each writes the sine of the second angle."""

CASES = [
    (name, joint, place) for name in NOTATIONS for joint, place in ((1, 1), (1, 5), (1, 6), (2, 0), (2, 1), (2, 3))
]


def with_sign_slip(text: str, place: int) -> str:
    """A text with another sign before one of its terms; those in brackets stay."""
    depth, places = 0, []
    for k, letter in enumerate(text):
        depth += {"(": 1, ")": -1}.get(letter, 0)
        places += [k] if letter in "+-" and depth == 0 else []
    k = places[place]
    return text[:k] + {"+": "-", "-": "+"}[text[k]] + text[k + 1 :]


def with_findings(result: AuditResult) -> ComponentAudit:
    (found,) = [component for component in result.components if component.findings]
    return found


def corrected(component: ComponentAudit) -> str:
    return " ".join(text for text, _ in component.corrected)


@pytest.mark.parametrize("name", NOTATIONS)
def test_the_texts_are_right_in_every_notation(name: str, tmp_path: Path) -> None:
    notation = NOTATIONS[name]
    assert audit(notation.publication(tmp_path, notation.texts())).passed


@pytest.mark.one_in(8)
@pytest.mark.parametrize(("name", "joint", "place"), CASES)
def test_a_correction_is_in_the_text_s_notation_and_put_into_the_file_it_is_clean(
    name: str, joint: int, place: int, tmp_path: Path
) -> None:
    notation = NOTATIONS[name]
    texts = notation.texts()
    wrong = texts | {joint: with_sign_slip(texts[joint], place)}
    component = with_findings(audit(notation.publication(tmp_path, wrong)))
    assert {finding.kind for finding in component.findings} == {Kind.SIGN}
    assert component.proven
    right = corrected(component)
    mended = audit(notation.publication(tmp_path, wrong | {joint: right}))
    assert mended.passed
    assert corrected(mended.components[joint - 1]) == right


@pytest.mark.parametrize("name", NOTATIONS)
def test_what_a_text_lacks_is_spelled_like_what_it_has(name: str, tmp_path: Path) -> None:
    """The sine of the second angle stands in no equation; its cosine does."""
    notation = NOTATIONS[name]
    sine, texts = notation.spelled["SIN2"], notation.texts()
    lacking = re.sub(r"\+ \S[^+]*$", "", texts[2][: texts[2].index(sine)])
    rest = texts[2][texts[2].index(sine) :]
    text = lacking + rest[rest.index("+") :]
    assert sine not in text
    component = with_findings(audit(notation.publication(tmp_path, {2: text})))
    (finding,) = component.findings
    assert finding.kind is Kind.MISSING and component.proven
    squeezed = lambda x: re.sub(r"[\s{}]|\\mathrm", "", x)
    assert finding.derived is not None and squeezed(sine) in squeezed(finding.derived)


def test_without_a_spelling_the_tables_is_taken(tmp_path: Path) -> None:
    """No mass and no angle in the text: the first spelling of the tables."""
    component = with_findings(audit(NOTATIONS["s_2"].publication(tmp_path, {2: r"l_2^2 \ddot{\theta}_1"})))
    assert component.verdict is Verdict.DIFFERS and component.proven
    assert "M_2" in corrected(component) and r"s\theta_2" in corrected(component)


def test_a_spelling_that_would_be_read_as_another_letter_is_not_used(tmp_path: Path) -> None:
    """The text has c_2 for the cosine, and s_2 for a length: the sine that it lacks is spelled as the tables do."""
    text = LATEX[2].replace("COS", "c_").replace("c_12", "c_{12}").replace("l_", "s_")
    first, _, rest = text.partition(r"+ m_2 s_1 s_2 SIN2 \dot{\theta}_1^2")
    notation = NOTATIONS["s_2"]
    (tmp_path / "a.toml").write_text(
        FILE.format(**vars(notation)).replace("'l_<k>', 'a_<k>'", "'s_<k>'")
        + EQUATION.format(joint=2, language="latex", text=first + rest)
    )
    component = with_findings(audit(read_publication(tmp_path / "a.toml")))
    assert component.proven
    assert [finding.derived for finding in component.findings] == [
        r"M_2 \, s_1 \, s_2 \, s\theta_2 \, \dot{\theta}_1^2"
    ]


def test_a_misprinted_symbol_is_not_copied_into_the_correction(tmp_path: Path) -> None:
    """The stray superscript before the acceleration is read past; the correction spells it by the table."""
    notation = NOTATIONS["s_2"]
    texts = notation.texts()
    text = texts[2].replace(r"\ddot{\theta}_1", r"{}^4 \ddot{\theta}_1", 1).replace("g c_{12}", "g s_{12}")
    component = with_findings(audit(notation.publication(tmp_path, {2: text})))
    assert component.proven and "^4" not in corrected(component)


@pytest.mark.parametrize(
    ("latex", "power", "wanted"),
    [
        ("cq_5", 2, "c^2q_5"), ("c q_5", 2, "c^2 q_5"), (r"\cos q_5", 2, r"\cos^2 q_5"), ("c_5", 2, "c_5^2"), ("c _{5}", 3, "c _{5}^3"),
        (r"\cos(q_1 + q_2)", 2, r"\cos^2(q_1 + q_2)"), (r"\mathrm{c}_5", 2, r"\mathrm{c}_5^2"), (r"\mathrm{c} q_5", 12, r"\mathrm{c}^{12} q_5"),
    ],
)  # fmt: skip
def test_powers_of_cosines(latex: str, power: int, wanted: str) -> None:
    symbol = Symbol("c_5", latex, Role.COSINE)
    assert latex_power(symbol, power) == wanted
    vocabulary = Vocabulary({"q_1": "q_1", "q_2": "q_2", "q_5": "q_5"})
    (term,) = read_latex(wanted, vocabulary)[0].components[0].terms
    (reading,) = term.readings
    assert reading.coefficient == Fraction(1) and [exponent for _, exponent in reading.factors] == [power]
