"""Angles with quarter turns, halves and multiples: read exactly, proven, and an error in them is found."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from rttrr_pin.auditing import Verdict
from rttrr_pin.auditing.reading.angles import PI, angle_of
from rttrr_pin.auditing.reading.nodes import Named
from support.audits import assert_right, assert_wrong, audited, only
from support.two_links import ARM

HOLDING = 'quantity = "g"\njoint = 1'
"""Of two links with point masses: m_2 l_2 g c_12 + (m_1 + m_2) l_1 g c_1."""

COSINES = {
    r"\sin(q_1 + \pi/2)": "c_1",
    r"\sin(\frac{\pi}{2} - q_1)": "c_1",
    r"-\cos(\pi - q_1)": "c_1",
    r"-\cos(q_1 + \pi)": "c_1",
    r"-\sin(q_1 - \frac{1}{2}\pi)": "c_1",
    r"\sin(q_1 + 90^\circ)": "c_1",
    r"\sin\left(q_1 + 90^{\circ}\right)": "c_1",
    r"-\cos(180° - q_1)": "c_1",
    r"\cos(q_1 - 2 \pi)": "c_1",
    r"\sin(q_1 + 1.5708)": "c_1",
    r"(2 \cos^2(q_1/2) - 1)": "c_1",
    r"(1 - 2 \sin^2\frac{q_1}{2})": "c_1",
    r"(\cos^2\left(\frac{q_1}{2}\right) - \sin^2\left(\frac{1}{2} q_1\right))": "c_1",
    r"(2 \cos^2(\frac{q_1 + \pi}{2} - \frac{\pi}{2}) - 1)": "c_1",
    r"\sin(q_1 + q_2 + \frac{\pi}{2})": "c_{12}",
    r"-\sin(q_1 + q_2 - \pi/2)": "c_{12}",
    r"\cos(-q_1 - q_2)": "c_{12}",
    r"(2 \cos^2\frac{q_1 + q_2}{2} - 1)": "c_{12}",
    r"(2 \cos^2(q_1/2 + q_2/2) - 1)": "c_{12}",
    r"(\cos(q_1/2) \cos(\frac{q_1}{2} + q_2) - \sin(q_1/2) \sin(\frac{q_1}{2} + q_2))": "c_{12}",
}
CODE = {
    "np.sin(q1 + np.pi/2)": "cos(q1)",
    "math.sin(math.pi/2 - q1)": "cos(q1)",
    "-cos(pi - q1)": "cos(q1)",
    "np.sin(q1 + np.deg2rad(90))": "cos(q1)",
    "np.sin(np.radians(90) + q1)": "cos(q1)",
    "sin(q1 + 1.5707963267948966)": "cos(q1)",
    "(2*cos(0.5*q1)**2 - 1)": "cos(q1)",
    "(1 - 2*sin(q1/2)**2)": "cos(q1)",
    "(8*cos(q1/4)**4 - 8*cos(q1/4)**2 + 1)": "cos(q1)",
    "-np.sin(q1 + q2 - np.pi/2)": "cos(q1 + q2)",
    "(2*np.cos((q1 + q2)/2)**2 - 1)": "cos(q1 + q2)",
}


def holding(spelled: str, replaced: str, plain: str) -> str:
    """The right text with a cosine in another spelling; it is multiplied by a bracket that only it has."""
    assert plain.count(replaced) == 1
    return plain.replace(replaced, f"({spelled})")


PLAIN = {
    "latex": "m_2 l_2 g c_{12} + (m_1 + m_2) l_1 g c_1",
    "python": "m_2*l_2*g*cos(q1 + q2) + (m_1 + m_2)*l_1*g*cos(q1)",
}
CASES = [("latex", *case) for case in COSINES.items()] + [("python", *case) for case in CODE.items()]


@pytest.mark.one_in(5)
@pytest.mark.parametrize(("language", "spelled", "cosine"), CASES)
def test_they_are_exact(language: str, spelled: str, cosine: str, tmp_path: Path) -> None:
    head = ARM if language == "latex" else f'language = "python"\n{ARM}'
    text = holding(spelled, cosine, PLAIN[language])
    assert_right(audited(tmp_path, head, (HOLDING, text), language=language))
    wrong = only(audited(tmp_path, head, (HOLDING, text.replace("+ (m_1", "- (m_1")), language=language))
    assert_wrong(wrong)
    mended = " ".join(term for term, _ in wrong.corrected)
    assert_right(audited(tmp_path, head, (HOLDING, mended), language=language))


@pytest.mark.parametrize(
    "spelled",
    [
        r"\sin(q_1 - \pi/2)",
        r"\cos(q_1 + \pi)",
        r"\sin(q_1 + \pi)",
        r"\cos\frac{q_1}{2}",
        r"\cos(2 q_1)",
        r"\cos(q_1 + 1.571)",
    ],
)
def test_another_angle_is_not_taken_for_it(spelled: str, tmp_path: Path) -> None:
    component = only(audited(tmp_path, ARM, (HOLDING, holding(spelled, "c_1", PLAIN["latex"]))))
    assert_wrong(component)
    assert component.findings
    assert ("1.571" in spelled) == any("1.571 read as" in finding.note for finding in component.findings)


@pytest.mark.parametrize(
    "spelled",
    [
        r"\cos(q_1 + 1)",
        r"\cos(q_1 + 1.58)",
        r"\cos(q_1 + \pi/3)",
        r"\cos(q_1/3)",
        r"\cos(\pi q_1)",
        r"\cos(q_1^2)",
        r"\cos(q_1 q_2)",
        r"\cos(1/q_1)",
        r"\cos(q_1 + 45^\circ)",
        r"\cos(q_1^\circ)",
    ],
)
def test_what_is_not_exact_is_not_read(spelled: str, tmp_path: Path) -> None:
    component = only(audited(tmp_path, ARM, (HOLDING, holding(spelled, "c_1", PLAIN["latex"]))))
    assert component.verdict is Verdict.UNPARSED, component.verdict


def test_a_constant_angle_is_its_number(tmp_path: Path) -> None:
    """DH tables have them: alpha = 90 degrees."""
    text = PLAIN["latex"] + r" + \cos(\frac{\pi}{2}) m_1 g l_1 - (1 - \sin 90^\circ) l_1 m_2 g - \sin(0) m_1"
    assert_right(
        audited(
            tmp_path,
            ARM,
            (HOLDING, text.replace("g c_1", r"g c_1 \cos(0)")),
        )
    )


def test_pi_may_be_a_symbol(tmp_path: Path) -> None:
    head = ARM + '[[symbol]]\nname = "p"\nlatex = \'\\pi\'\ndimension = "mass"\n'
    head = head.replace('mass = "m_1"', 'mass = "p"').replace('name = "m_<i>"', 'name = "m_<i>"\ni = [2]')
    assert_right(audited(tmp_path, head, (HOLDING, r"m_2 l_2 g c_{12} + (\pi + m_2) l_1 g c_1")))
    assert only(audited(tmp_path, head, (HOLDING, r"m_2 l_2 g c_{12} + (\pi + m_2) l_1 g \sin(q_1 + \pi/2)"))).unparsed


def test_names_of_angles() -> None:
    half = Fraction(1, 2)
    assert angle_of("s", {1: half, 2: Fraction(-1)}, 0) == Named("s_1d2_m2")
    assert angle_of("s", {1: -half}, 0) == Named("s_1d2", sign=-1)
    assert angle_of("c", {1: Fraction(-1), PI: half}, 0) == Named("s_1")
    assert angle_of("s", {1: Fraction(3, 2)}, 0) == Named("s_1d2_1d2_1d2")
    assert angle_of("c", {PI: Fraction(3)}, 0) == -1 and angle_of("s", {PI: -half}, 0) == -1
