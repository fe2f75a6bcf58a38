"""Entries of M, C and g, accelerations solved for, quotients, and texts in letters and angles of many kinds."""

from __future__ import annotations

import random
from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest

from rttrr_pin.auditing import Kind, Verdict, audit, read_publication
from rttrr_pin.auditing.derived import derive
from rttrr_pin.auditing.printed import Quotient
from rttrr_pin.auditing.quotients import written
from rttrr_pin.auditing.reading.component import LONGEST
from rttrr_pin.auditing.results import AuditResult
from rttrr_pin.auditing.spelling import writing
from rttrr_pin.errors import InputError
from support.audits import assert_right, assert_wrong, audited, only
from support.two_links import ARM, declared

REPORTS = Path(__file__).parents[1] / "data/reports"

SLIDING = (
    ARM.replace('["0", "-g", "0"]', '["0", "0", "-g"]').replace("about z", "about y", 1).replace("about z", "about -y")
)
"""The second joint turns the other way, so that angles are differences."""


def cart_pole(coordinates: str = "", inertia: str = "m*l*l/3") -> str:
    return f"""language = "python"
{coordinates}
[robot]
gravity = ["0", "0", "-g"]
[[link]]
joint = "prismatic along x"
mass = "M"
[[link]]
joint = "revolute about y"
mass = "m"
com = ["0", "0", "l"]
inertia = ["0", "0", "0", "{inertia}", "0", "0"]
{declared(M="mass", m="mass", l="length", g="acceleration")}"""


PUSHED = '[coordinates]\nforce = ["force", "0"]'


MATRICES = {
    "M": (
        (r"m_2 l_2^2 + 2 m_2 l_1 l_2 c_2 + (m_1 + m_2) l_1^2", "m_2 l_2^2 + m_2 l_1 l_2 c_2"),
        ("m_2 l_2^2 + m_2 l_1 l_2 c_2", "m_2 l_2^2"),
    ),
    "C": (
        (r"- m_2 l_1 l_2 s_2 \dot{q}_2", r"- m_2 l_1 l_2 s_2 (\dot{q}_1 + \dot{q}_2)"),
        (r"m_2 l_1 l_2 s_2 \dot{q}_1", "0"),
    ),
}
G = ("m_2 l_2 g c_{12} + (m_1 + m_2) l_1 g c_1", "m_2 l_2 g c_{12}")


@pytest.mark.parametrize("quantity", MATRICES)
def test_a_matrix_is_right_entry_by_entry_in_rows_and_as_a_whole(quantity: str, tmp_path: Path) -> None:
    rows = MATRICES[quantity]
    about = f'quantity = "{quantity}"\n'
    entries = [(f"{about}row = {i + 1}\ncolumn = {j + 1}", rows[i][j]) for i, j in product(range(2), repeat=2)]
    whole = r"\begin{bmatrix} " + r" \\ ".join(" & ".join(row) for row in rows) + r" \end{bmatrix}"
    lines = [
        (f"{about}row = {i + 1}", r"\begin{bmatrix} " + " & ".join(row) + r"\end{bmatrix}")
        for i, row in enumerate(rows)
    ]
    for equations in (entries, lines, [(about, f"{quantity} = {whole}")]):
        result = audited(tmp_path, ARM, *equations)
        assert [c.quantity for c in result.components] == [f"{quantity}{i},{j}" for i in "12" for j in "12"]
        assert_right(result)


def test_g_is_right_joint_by_joint_and_as_a_whole(tmp_path: Path) -> None:
    assert_right(audited(tmp_path, ARM, *((f'quantity = "g"\njoint = {i}', text) for i, text in enumerate(G, start=1))))
    column = rf"G = \begin{{pmatrix}} {G[0]} \\ {G[1]} \end{{pmatrix}}"
    assert_right(audited(tmp_path, ARM, ('quantity = "g"', column)))


@pytest.mark.parametrize(
    ("about", "text", "old", "new", "kind", "dimension"),
    [
        ('quantity = "M"\nrow = 1\ncolumn = 1', MATRICES["M"][0][0], "2 m_2", "m_2", Kind.COEFFICIENT, True),
        ('quantity = "M"\nrow = "joint_1"\ncolumn = 2', MATRICES["M"][0][1], "c_2", "s_2", Kind.SYMBOL, True),
        ('quantity = "M"\nrow = 2\ncolumn = 2', MATRICES["M"][1][1], "l_2^2", "l_2", Kind.SYMBOL, False),
        ('quantity = "g"\njoint = 1', G[0], "m_2 l_2 g", "- m_2 l_2 g", Kind.SIGN, True),
    ],
)
def test_an_error_in_an_entry_is_named(about, text, old, new, kind, dimension, tmp_path: Path) -> None:
    component = only(audited(tmp_path, ARM, (about, text.replace(old, new, 1))))
    assert_wrong(component)
    (finding,) = component.findings
    assert (finding.kind, finding.dimension_ok) == (kind, dimension)


OTHER_C = (r"- 2 m_2 l_1 l_2 s_2 \dot{q}_2", r"- m_2 l_1 l_2 s_2 \dot{q}_2")


def test_another_matrix_C_is_right_and_a_wrong_one_is_not(tmp_path: Path) -> None:
    """C is not unique: what it gives times the rates is."""
    entry = 'quantity = "C"\nrow = 1\ncolumn = '
    result = audited(tmp_path, ARM, *((f"{entry}{j}", text) for j, text in enumerate(OTHER_C, start=1)))
    assert result.passed and all("Christoffel" in c.notes[-1] for c in result.components)
    alone = only(audited(tmp_path, ARM, (f"{entry}1", OTHER_C[0])))
    assert alone.verdict is Verdict.UNDECLARED and "C1,1 to C1,2" in alone.undeclared[0] and not alone.findings
    wrong = audited(tmp_path, ARM, (f"{entry}1", OTHER_C[0]), (f"{entry}2", OTHER_C[1].replace("s_2", "c_2")))
    assert Verdict.DIFFERS in {c.verdict for c in wrong.components} and not wrong.passed


TEMP = ('quantity = "definition"', "temp = (force + m*l*qd2*qd2*sin(q2))/(M + m)")
SWING = "(g*sin(q2) - cos(q2)*temp)/(l*(4/3 - m*cos(q2)*cos(q2)/(M + m)))"
ACCELERATIONS = {
    "a": ("thetaacc = " + SWING, 2),
    "of the other": ("xacc = temp - m*l*qdd2*cos(q2)/(M + m)", 1),
    "one equation": ("thetaacc = (g*sin(q2) - cos(q2)*qdd1)*3/(4*l)", 2),
    "both put in": (f"xacc = temp - m*l*{SWING}*cos(q2)/(M + m)", 1),
}


@pytest.mark.one_in(2)
@pytest.mark.parametrize("case", ACCELERATIONS)
def test_accelerations_solved_for(case: str, tmp_path: Path) -> None:
    text, joint = ACCELERATIONS[case]
    about = f'quantity = "a"\njoint = {joint}'
    assert_right(audited(tmp_path, cart_pole(PUSHED), TEMP, (about, text), language="python"))
    for old, new in (("cos(q2)*", "sin(q2)*"), ("m*", "M*"), (" - ", " + "), ("g*", "2*g*")):
        if old in text:
            wrong = audited(tmp_path, cart_pole(PUSHED), TEMP, (about, text.replace(old, new, 1)), language="python")
            assert_wrong(only(wrong))


def test_a_corrected_acceleration_put_into_the_file_is_right(tmp_path: Path) -> None:
    about = 'quantity = "a"\njoint = 2'
    wrong = only(audited(tmp_path, cart_pole(PUSHED), TEMP, (about, SWING.replace("4/3", "1")), language="python"))
    ((text, changed),) = wrong.corrected
    assert changed
    assert_right(audited(tmp_path, cart_pole(PUSHED), (about, text), language="python"))
    latex = cart_pole('[coordinates]\nforce = ["f", "0"]').replace('language = "python"', "")
    right = r"\ddot{q}_2 = \frac{g s_2 (M + m) - c_2 (f + m l \dot{q}_2^2 s_2)}{l (\frac{4}{3} (M + m) - m c_2^2)}"
    assert_right(audited(tmp_path, latex, (about, right)))
    slip = only(audited(tmp_path, latex, (about, right.replace("+ m l", "- m l"))))
    assert_wrong(slip)
    assert {finding.kind for finding in slip.findings} == {Kind.SIGN}
    assert_right(audited(tmp_path, latex, (about, slip.corrected[0][0])))


def test_a_driving_force_with_a_divisor(tmp_path: Path) -> None:
    about = 'quantity = "tau"\njoint = 2'
    text = r"\frac{m_2^2 l_2^2 (\ddot{q}_1 + \ddot{q}_2) + m_2^2 l_1 l_2 (c_2 \ddot{q}_1 + s_2 \dot{q}_1^2)}{m_2} + m_2 l_2 g c_{12}"
    assert_right(audited(tmp_path, ARM, (about, text)))
    assert_wrong(only(audited(tmp_path, ARM, (about, text.replace("s_2", "c_2")))))
    assert only(audited(tmp_path, ARM, (about, r"\frac{m_1}{0 l_1}"))).unparsed


ANGLES = {
    "c_{1-2}": r"(m_2 l_2 g c_{1-2} + (m_1 + m_2) l_1 g c_1)",
    "c_{1,-2}": r"(m_2 l_2 g c_{1,-2} + (m_1 + m_2) l_1 g c_1)",
    "cos(q_1 - q_2)": r"m_2 l_2 g \cos(q_1 - q_2) + (m_1 + m_2) l_1 g \cos q_1",
    "cos(q_2 - q_1)": r"m_2 l_2 g \cos(q_2 - q_1) + (m_1 + m_2) l_1 g \cos q_1",
    "cos(-q_1 + q_2)": r"m_2 l_2 g \cos(- q_1 + q_2) + (m_1 + m_2) l_1 g \cos(-q_1)",
    "expanded": r"m_2 l_2 g (c_1 c_2 + s_1 s_2) + (m_1 + m_2) l_1 g c_1",
}


@pytest.mark.parametrize("name", ANGLES)
def test_differences_of_angles(name: str, tmp_path: Path) -> None:
    about = 'quantity = "g"\njoint = 1'
    text = f"- ({ANGLES[name]})"
    assert_right(audited(tmp_path, SLIDING, (about, text)))
    component = only(audited(tmp_path, SLIDING, (about, text.replace("l_2 g", "l_1 g", 1))))
    assert_wrong(component)
    mended = " ".join(term for term, _ in component.corrected)
    assert_right(audited(tmp_path, SLIDING, (about, mended)))


PENDULUM = (
    ARM.split("[[link]]")[0]
    + r"""
[[link]]
joint = "revolute about z"
[[link]]
joint = "revolute about x"
mass = "m"
com = ["0", "l", "0"]
"""
    + declared(m="mass", l="length", g="acceleration")
)

DOUBLE = {
    "sin 2q": r"m l^2 c_2^2 \ddot{q}_1 - m l^2 \sin 2 q_2 \dot{q}_1 \dot{q}_2 - m g l c_2 s_1",
    "sin(2 q)": r"\frac{1}{2} m l^2 (1 + \cos(2 q_2)) \ddot{q}_1 - m l^2 \sin(2 q_2) \dot{q}_1 \dot{q}_2 - m g l c_2 s_1",
    "one angle": r"m l^2 c_2^2 \ddot{q}_1 - 2 m l^2 s_2 c_2 \dot{q}_1 \dot{q}_2 - \frac{m g l}{2} (s_{1+2} + s_{1-2})",
}


@pytest.mark.parametrize("name", DOUBLE)
def test_double_angles(name: str, tmp_path: Path) -> None:
    about = 'quantity = "tau"\njoint = 1'
    assert_right(audited(tmp_path, PENDULUM, (about, DOUBLE[name])))
    component = only(
        audited(tmp_path, PENDULUM, (about, DOUBLE[name].replace("- m l^2", "+ m l^2").replace("- 2 m", "- 3 m")))
    )
    assert_wrong(component)
    (finding,) = component.findings
    assert finding.kind in (Kind.SIGN, Kind.COEFFICIENT)
    assert_right(audited(tmp_path, PENDULUM, (about, " ".join(term for term, _ in component.corrected))))


def test_angles_in_code(tmp_path: Path) -> None:
    head = 'language = "python"\n' + SLIDING
    right = "-(m_2*l_2*g*np.cos(q2 - q1) + (m_1 + m_2)*l_1*g*np.cos(q1))"
    about = 'quantity = "g"\njoint = 1'
    assert_right(audited(tmp_path, head, (about, right), language="python"))
    assert_wrong(only(audited(tmp_path, head, (about, right.replace("q2 - q1", "q2 + q1")), language="python")))


@pytest.mark.parametrize("text", ["m*l*cos(q1)", "m*l*cos(q1 + q2)", "M*qdd1/cos(2*q1)"])
def test_a_length_has_no_cosine(text: str, tmp_path: Path) -> None:
    component = only(audited(tmp_path, cart_pole(), ('quantity = "tau"\njoint = 1', text), language="python"))
    assert component.verdict is Verdict.DIFFERS and component.evidence is not None
    assert component.evidence.excluded is None and component.proven


TAU = (
    r"m_2 l_2^2 (\ddot{q}_1 + \ddot{q}_2) + m_2 l_1 l_2 c_2 \ddot{q}_1 + m_2 l_1 l_2 s_2 \dot{q}_1^2 + m_2 l_2 g c_{12}"
)
SPELLINGS = {
    "as it is": lambda text: text,
    "of time": lambda text: text.replace("q}_1", "q}_1(t)").replace("q}_2", r"q}_2{\left(t \right)}"),
    "c_12": lambda text: text.replace("c_{12}", "c_12"),
    "9.81": lambda text: text.replace("g c", "9.81 c"),
    "2 times 4.905": lambda text: text.replace("m_2 l_2 g c_{12}", "2 m_2 l_2 4.905 c_{12}"),
    "cos(q(t))": lambda text: text.replace("c_2", r"\cos(q_2(t))").replace("c_{12}", r"\cos(q_1(t) + q_2(t))"),
}


@pytest.mark.parametrize("name", SPELLINGS)
def test_spellings_that_are_no_error(name: str, tmp_path: Path) -> None:
    about = 'quantity = "tau"\njoint = 2'
    text = SPELLINGS[name](TAU)
    assert_right(audited(tmp_path, ARM, (about, text)))
    component = only(audited(tmp_path, ARM, (about, text.replace("+ m_2 l_1 l_2 s_2", "- m_2 l_1 l_2 s_2"))))
    assert_wrong(component)
    assert [finding.kind for finding in component.findings] == [Kind.SIGN]


def test_a_lost_gravity_is_no_number_of_it(tmp_path: Path) -> None:
    component = only(audited(tmp_path, ARM, ('quantity = "g"\njoint = 2', "m_2 l_2 c_{12}")))
    assert [finding.kind for finding in component.findings] == [Kind.SYMBOL]
    component = only(audited(tmp_path, ARM, ('quantity = "g"\njoint = 2', "9.18 m_2 l_2 c_{12}")))
    assert component.findings


def test_gravity_without_a_letter_is_the_number_of_the_text(tmp_path: Path) -> None:
    plain = ARM.replace('["0", "-g", "0"]', '["0", "-9.81", "0"]').rsplit("[[symbol]]", 1)[0]
    assert_right(audited(tmp_path, plain, ('quantity = "g"\njoint = 2', "9.81 m_2 l_2 c_{12}")))
    default = plain.replace('gravity = ["0", "-9.81", "0"]', "").replace("about z", "about -y")
    assert_right(audited(tmp_path, default, ('quantity = "g"\njoint = 2', "9.81 m_2 l_2 c_{12}")))


ABBREVIATED = [
    ('quantity = "definition"', r"h = m_2 l_1 l_2 \sin q_2"),
    ('quantity = "definition"', r"\alpha = q_1 + q_2"),
    ('quantity = "definition"', r"H_{12} = m_2 l_2^2 + m_2 l_1 l_2 \cos q_2"),
]
WITH_THEM = r"\tau_2 = H_{12} \ddot{q}_1 + m_2 l_2^2 \ddot{q}_2 + h \dot{q}_1^2 + m_2 l_2 g \cos\alpha"


def test_abbreviations_are_put_in(tmp_path: Path) -> None:
    about = 'quantity = "tau"\njoint = 2'
    assert_right(audited(tmp_path, ARM, *ABBREVIATED, (about, WITH_THEM)))
    component = only(audited(tmp_path, ARM, *ABBREVIATED, (about, WITH_THEM.replace("+ h", "- h"))))
    assert_wrong(component)
    (finding,) = component.findings
    assert finding.printed is not None and finding.printed.startswith("- h") and "(of h:" in finding.printed
    unknown = only(audited(tmp_path, ARM, *ABBREVIATED[1:], (about, WITH_THEM)))
    assert (
        unknown.verdict is Verdict.UNDECLARED
        and "`h`" in unknown.undeclared[0]
        and "definition" in unknown.undeclared[0]
    )


def test_a_cart_pole_in_its_own_letters_is_told_its_lost_mass() -> None:
    component = only(audit(read_publication(REPORTS / "a1_cartpole.toml")))
    assert_wrong(component)
    assert {finding.kind for finding in component.findings} == {Kind.SYMBOL, Kind.MISSING}
    assert {finding.derived for finding in component.findings} == {r"M \, \ddot{x}", r"m \, \ddot{x}"}


def test_a_cart_pole_in_code_is_asked_for_what_its_file_does_not_say(tmp_path: Path) -> None:
    component = only(audit(read_publication(REPORTS / "a2_puffer.toml")))
    assert component.verdict is Verdict.UNDECLARED and not component.findings and not component.unparsed
    assert [text.split("`")[1] for text in component.undeclared] == ["temp"]
    whole = cart_pole(PUSHED)
    text = (REPORTS / "a2_puffer.toml").read_text().split("'''")[1]
    about = 'quantity = "a"\njoint = 2'
    assert_wrong(only(audited(tmp_path, whole, TEMP, (about, text), language="python")))
    assert_right(audited(tmp_path, whole, TEMP, (about, text.replace("/M)", "/(M + m))")), language="python"))


def test_an_arm_whose_second_coordinate_has_another_letter_is_not_accused() -> None:
    result = audit(read_publication(REPORTS / "rp_theta_d.toml"))
    assert {c.verdict for c in result.components} == {Verdict.UNDECLARED} and not result.findings


def test_the_paper_s_corrections_are_spelled_from_the_tables(of_the_paper: AuditResult) -> None:
    """A misprint such as {}^4 before a rate is in no corrected equation, and none has two ways to be read."""
    for component in of_the_paper.components:
        assert not any("{}^4 \\ddot" in text or "{}^4\\ddot" in text for text, _ in component.corrected)


def random_arm(rng: random.Random) -> str:
    """Two or three links that turn or slide about any axes, with a mass each."""
    links = []
    spin = 'inertia = ["I", "0", "0", "I", "0", "I"]\n'
    for i in range(1, rng.choice((3, 4))):
        joint = f"{rng.choice(('revolute about', 'revolute about', 'prismatic along'))} {rng.choice(('', '-'))}{rng.choice('xyz')}"
        origin, com = ([x, "0", "0"][k:] + [x, "0", "0"][:k] for k, x in ((rng.randrange(3), f"l_{i}"),) for _ in "ab")
        links.append(
            f'[[link]]\njoint = "{joint}"\norigin = {origin}\nmass = "m_{i}"\ncom = {com}\n'.replace("'", '"') + spin
        )
    symbols = declared(I="inertia", m_i="mass", l_i="length", g="acceleration")
    return ARM.split("[[link]]")[0] + "".join(links) + symbols


def test_accelerations_of_a_singular_robot_are_refused(tmp_path: Path) -> None:
    turning = ARM.replace("about z", "about x")
    with pytest.raises(InputError, match="singular"):
        audited(tmp_path, turning, ('quantity = "a"\njoint = 1', "0"))


@pytest.mark.one_in(5)
@pytest.mark.parametrize("seed", range(8))
def test_what_is_derived_is_right_and_with_a_sign_turned_it_is_not(seed: int, tmp_path: Path) -> None:
    """Each quantity of random arms, written by the writers of closed forms, read again, and then with an error."""
    rng = random.Random(seed)
    head = random_arm(rng)
    count = head.count("[[link]]")
    about = [f'quantity = "{name}"\njoint = {count}' for name in ("g", "a", "tau")]
    about.append(f'quantity = "M"\nrow = 1\ncolumn = {count}')
    audited(tmp_path, head, *((text, "0") for text in about))
    publication = read_publication(tmp_path / "a.toml")
    derived = derive(publication)[0]
    write = writing(publication, derived.symbols, ())
    for equation, stated in zip(publication.equations, about, strict=True):
        (name,) = equation.names
        right = (derived.solutions.get(name) or [Quotient(derived.expressions.get(name, {}))])[0]
        text = written(right, write, latex=True)
        if not right.numerator or len(text) > LONGEST:
            continue
        assert_right(audited(tmp_path, head, (stated, text)))
        factors = rng.choice(list(right.numerator))
        turned = {**right.numerator, factors: -right.numerator[factors]}
        wrong = written(replace(right, numerator=turned), write, latex=True)
        assert_wrong(only(audited(tmp_path, head, (stated, wrong))))
