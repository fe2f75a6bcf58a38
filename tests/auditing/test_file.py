"""Files of equations that a user brings: what is read, what is refused, and what is asked for."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from rttrr_pin.auditing import Kind, Verdict, audit, read_publication
from rttrr_pin.cli import main
from rttrr_pin.derivation.symbol_file import PUBLISHED
from rttrr_pin.errors import EquationError
from support.two_links import LINKS

CRAIG = (
    """
title = "Two links"
language = "{language}"
{coordinates}
"""
    + LINKS
    + """
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
)

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
        ('latex = ["m_<k>"]', "latex = []", "leave it out"),
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


ARM = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:include filename="$(find parts)/body.xacro"/>
<xacro:arg name="mass" default="1"/>
<link name="base"/>
<xacro:body name="arm" mass="$(arg mass)"/>
<xacro:body name="hand" mass="1"/>
<joint name="turn" type="continuous"><parent link="base"/><child link="arm"/></joint>
<joint name="grip" type="continuous"><parent link="arm"/><child link="hand"/><axis xyz="1 0 0"/>
  <mimic joint="turn"/></joint>
</robot>
"""
BODY = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:macro name="body" params="name mass"><link name="${name}"><inertial><mass value="${mass}"/>
  <inertia ixx="${0.5 * float(mass)}" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></xacro:macro>
</robot>
"""
PAPER = """
language = "python"
[robot]
urdf = "arm.xacro"
[[equation]]
number = 1
quantity = "tau"
joint = 1
python = ["2.5 * qdd1 + 0.5 * qdd2"]
"""


def test_a_robot_s_file_is_read_as_the_options_say(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What was assumed stands in the report, the errata sheet and the JSON."""
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "body.xacro").write_text(BODY)
    (tmp_path / "robot").mkdir()
    (tmp_path / "robot" / "arm.xacro").write_text(ARM)
    (tmp_path / "robot" / "paper.toml").write_text(PAPER)
    sheet = tmp_path / "sheet.md"
    words = ["audit", str(tmp_path / "robot" / "paper.toml"), "--markdown", str(sheet)]
    for option in (["--xacro"], ["--package", f"parts={tmp_path / 'elsewhere'}"], ["--lenient"]):
        assert main(words) == 2
        assert option[0] in capsys.readouterr().err
        words += option
    words += ["--xacro-arg", "mass:=4"]
    assert main([*words, "--no-mimic"]) == 0
    shown = capsys.readouterr()
    assumed = 'assumed: <axis xyz="1 0 0"/>'
    assert assumed in shown.out and assumed in shown.err and "axis" in sheet.read_text()
    assert main([*words, "--no-mimic", "--json", "-"]) == 0
    assert any(assumed in note for note in json.loads(capsys.readouterr().out)["notes"])
    assert main(words) > 0  # the hand follows, and there is no qdd2
