"""The verdict matrix against the programs themselves: Pinocchio, MuJoCo, and Drake (`pytest -m drake`).

Each program loads the file, and what it made of it is compared with what the file says: degrees of freedom, masses, inertias,
limits. A rule of ours that its program does not have, or a rule of a program that we do not have, shows as a difference.
"""

from __future__ import annotations

import math
from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

import rttrr_pin
from rttrr_pin.errors import RttrrError
from rttrr_pin.inspection import PARSERS, RULES, Behaviour, Inspection, inspect
from rttrr_pin.inspection.run import inspect_document
from rttrr_pin.urdf.parser import read_document
from support.faulty import ASSUMPTIONS, ERRORS, GRIP, NOTES, URDF, changed
from support.faulty import LIMIT as LIMIT_TWO
from support.inspected import LIMIT, arm, diagonal, inertial, joint, shape, tip
from support.parsers import PROGRAMS, Program, drake_behaviour, mujoco_behaviour, pinocchio_behaviour, tensor_of
from support.tolerances import CONSUMER, SOFT

GOOD = inertial(1, diagonal(1, 1, 1))
ZERO = (0,) * 6
FULL = ("0.5", "0.01", "-0.02", "0.4", "0.03", "0.3")


def look(text: str) -> Inspection:
    return inspect(text)


def leaf(name: str, parent: str, kind: str = "revolute", more: str = "") -> str:
    """One more link."""
    return f'<link name="{name}">{GOOD}</link>' + joint(f"{name} joint", parent, name, kind, more=more)


def follower(how: str, kind: str = "revolute") -> str:
    """Two moving links; the second follows the first."""
    return arm(GOOD, extra=tip(GOOD, kind, more=f'<mimic joint="swing" {how}/>'))


FILES = {
    "good": arm(GOOD),
    "full tensor": arm(inertial(2, FULL, xyz="0.1 0.2 0.3")),
    "turned ball": arm(inertial(2, diagonal(1, 1, 1), rpy="1 2 3")),
    "turned about its axis": arm(inertial(2, diagonal(1, 1, 0.5), rpy="0 0 1")),
    "half a turn": arm(inertial(2, diagonal(0.5, 0.4, 0.3), rpy=f"0 {math.pi} 0")),
    "half a turn to seven digits": arm(inertial(2, diagonal(0.5, 0.4, 0.3), rpy="3.141593 0 0")),
    "turned base": arm(GOOD, base=inertial(2, FULL, rpy="1 2 3")),
    "negative mass": arm(inertial(-1)),
    "tensor without mass": arm(inertial(0)),
    "frame that moves": arm(inertial(0, ZERO)),
    "no inertial": arm(""),
    "no inertial, prismatic": arm("", kind="prismatic"),
    "point": arm(inertial(1, ZERO)),
    "point off the axis": arm(inertial(1, ZERO, xyz="1 0 0")),
    "point, prismatic": arm(inertial(1, ZERO), kind="prismatic"),
    "negative mass that carries": arm(inertial(-1), extra=tip(inertial(5))),
    "negative moment": arm(inertial(1, diagonal(-1, 1, 1))),
    "indefinite": arm(inertial(1, (1, 2, 0, 1, 0, 1.5))),
    "triangle": arm(inertial(1, diagonal(1, 1, 3))),
    "triangle, full tensor": arm(inertial(1, ("1", "0.1", "0.1", "1", "0.1", "3"))),
    "triangle by a digit": arm(inertial(1, diagonal("0.10000", "0.20000", "0.30001"))),
    "plate in floats": arm(inertial(1, diagonal(0.1, 0.2, 0.3))),
    "plate, not in floats": arm(inertial(1, diagonal(0.1, 0.7, 0.8))),
    "rod": arm(inertial(1, diagonal(1, 1, 0))),
    **{f"ball, {power}": arm(inertial(1, diagonal(*[f"1e{power}"] * 3))) for power in (-18, -16, -15, -13, -12, 3, 6)},
    **{f"triangle, {power}": arm(inertial(1, diagonal(f"1e{power}", f"1e{power}", f"3e{power}")))
       for power in (-18, -15, -14, -12, 6)},
    "tiny mass": arm(inertial("1e-16")),
    "no limit": arm(GOOD, limit=""),
    "no limit, prismatic": arm(GOOD, limit="", kind="prismatic"),
    "no limit, continuous": arm(GOOD, limit="", kind="continuous"),
    "no effort": arm(GOOD, limit='<limit lower="-1" upper="1" velocity="1"/>'),
    "no velocity, continuous": arm(GOOD, limit='<limit effort="1"/>', kind="continuous"),
    "no range": arm(GOOD, limit='<limit effort="1" velocity="1"/>'),
    "no lower": arm(GOOD, limit='<limit upper="1" effort="1" velocity="1"/>'),
    "no upper": arm(GOOD, limit='<limit lower="-1" effort="1" velocity="1"/>'),
    "zero range": arm(GOOD, limit='<limit lower="0" upper="0" effort="1" velocity="1"/>'),
    "empty range": arm(GOOD, limit='<limit lower="0.5" upper="0.5" effort="1" velocity="1"/>'),
    "empty range, continuous": arm(GOOD, limit='<limit lower="0" upper="0" effort="1" velocity="1"/>', kind="continuous"),
    "half a range, continuous": arm(GOOD, limit='<limit upper="1" effort="1" velocity="1"/>', kind="continuous"),
    "negative mass off the axis": arm(inertial(-1, xyz="0.1 0 0")),
    "mass below eps off the axis": arm(inertial("1e-16", xyz="0.1 0 0")),
    "limit without effort on a fixed joint": arm(GOOD, extra=tip(GOOD, more='<limit velocity="1"/>').replace(LIMIT, "")),
    "blank behind the mass": arm(inertial("1 ")),
    "blank before the mass": arm(inertial(" 1")),
    "blank behind a moment": arm(inertial(1, ("2", "0", "0", "2 ", "0", "2"))),
    "tab in the centre of mass": arm(inertial(1, xyz="0.1&#9;0 0")),
    "tab before the centre of mass": arm(inertial(1, xyz="\t0.1 0 0")),
    "line end in the centre of mass": arm(inertial(1, xyz="0.1\n0 0")),
    "line end behind a mass": arm(inertial("1\r\n")),
    "tab in an axis, as written": arm(GOOD).replace('xyz="0 0 1"', 'xyz="0 0\t1"'),
    "tab before a number of an axis": arm(GOOD).replace('xyz="0 0 1"', 'xyz="0 \t0 1"'),
    "spaces in the centre of mass": arm(inertial(1, xyz=" 0.1  0 0 ")),
    "tab in an axis": arm(GOOD).replace('xyz="0 0 1"', 'xyz="0 0&#9;1"'),
    "blank behind a limit": arm(GOOD).replace('upper="1"', 'upper="1 "'),
    "blank behind damping": arm(GOOD, more='<dynamics damping="0.5 "/>'),
    "blank behind a multiplier": follower('multiplier="2 "'),
    "mass on the base": arm(GOOD, base=inertial()),
    "negative mass on the base": arm(GOOD, base=inertial(-1)),
    "triangle on the base": arm(GOOD, base=inertial(1, diagonal(1, 1, 3))),
    "point on the base": arm(GOOD, base=inertial(1, ZERO)),
    "tensor without mass on the base": arm(GOOD, base=inertial(0)),
    "fixed tip": arm(GOOD, extra=tip(inertial(0.5))),
    "fixed tip, only shifted": arm(GOOD, extra=tip(inertial(2, diagonal(0.5, 0.4, 0.3), xyz="0 0 1"), origin='<origin xyz="0.1 0 0"/>')),
    "fixed tip on a frame": arm("", extra=tip(inertial(0.5))),
    "fixed tip, triangle": arm(GOOD, extra=tip(inertial(1, diagonal(1, 1, 3)))),
    "fixed tip, negative mass": arm(GOOD, extra=tip(inertial(-0.1))),
    "fixed tip, more negative mass than the arm has": arm(GOOD, extra=tip(inertial(-2))),
    "fixed tip, tensor without mass": arm(GOOD, extra=tip(inertial(0))),
    "fixed tip, tensor with a tiny mass": arm(GOOD, extra=tip(inertial("1e-16"))),
    "fixed tip, tiny mass": arm(GOOD, extra=tip(inertial("1e-14"))),
    "fixed tip, point": arm(GOOD, extra=tip(inertial(1, ZERO))),
    "fixed tip, frame": arm(GOOD, extra=tip("")),
    "tip makes up for the arm": arm(inertial(1, diagonal(1, 1, 3)), extra=tip(inertial(1, diagonal(5, 5, 5)))),
    "frame that carries mass": arm("", extra=tip(GOOD, kind="revolute")),
    "planar": arm(GOOD, limit="", kind="planar"),
    "floating": arm(GOOD, limit="", kind="floating"),
    "floating on what floats": arm(GOOD, limit="", kind="floating", extra=tip(GOOD, kind="floating")),
    "floating on a frame that moves": arm(GOOD, extra=tip("") + leaf("hand", "tip", "floating")),
    "floating on a fixed base": arm("", limit="", kind="fixed", extra=tip(GOOD, kind="floating")),
    "shape instead of mass": arm(shape('<sphere radius="0.1"/>')),
    "drawing instead of mass": arm(shape('<sphere radius="0.1"/>', role="visual")),
    "shape and no mass": arm(inertial(0, ZERO) + shape('<sphere radius="0.1"/>')),
    "shape on the tip": arm(GOOD, extra=tip(shape('<sphere radius="0.1"/>'))),
    "shape on the base": arm(GOOD, base=shape('<sphere radius="0.1"/>')),
    "planar, damped": arm(GOOD, limit="", kind="planar", more='<dynamics damping="0.5"/>'),
    **{f"axis of {length}": arm(GOOD).replace('xyz="0 0 1"', f'xyz="0 0 {length}"')
       for length in ("2e-7", "9e-8", "2e-8", "9e-9", "1e-30")},
    "mimic": follower('multiplier="2"'),
    "mimic with an offset": follower('multiplier="2" offset="0.5"'),
    "mimic of nothing": follower('multiplier="0"'),
    "mimic that stands": follower('multiplier="0" offset="0.3"'),
    "mimic, prismatic": follower('multiplier="-1"', kind="prismatic"),
    "mimic, continuous": follower("", kind="continuous"),
    "mimic of one that follows": arm(GOOD, extra=tip(GOOD, "revolute", more='<mimic joint="swing"/>')
                                     + leaf("hand", "tip", more='<mimic joint="hold" multiplier="3"/>')),
    "mimic, and a turned tensor": arm(inertial(2, FULL, rpy="1 2 3"),
                                      extra=tip(GOOD, "revolute", more='<mimic joint="swing"/>')),
    "mimic on a fixed joint": arm(GOOD, extra=tip(GOOD, more='<mimic joint="swing" multiplier="2"/>')),
}  # fmt: skip
"""Files for each rule, and for both sides of each threshold."""

SINCE = {
    "small products": ((3, 14), arm(inertial(1, ("2e-9", "9e-13", "0", "2e-9", "0", "3e-9")))),
    "turned": ((3, 14), arm(inertial(2, diagonal(0.5, 0.4, 0.3), rpy="1 2 3"))),
    "turned, full tensor": ((3, 14), arm(inertial(2, FULL, xyz="0.1 0.2 0.3", rpy="1 2 3"))),
    "a quarter turn": ((3, 14), arm(inertial(2, diagonal(0.5, 0.4, 0.3), rpy=f"0 0 {math.pi / 2}"))),
    "half a turn, full tensor": ((3, 14), arm(inertial(2, FULL, rpy=f"0 0 {math.pi}"))),
    "half a turn to three digits": ((3, 14), arm(inertial(2, diagonal(0.5, 0.4, 0.3), rpy="3.14 0 0"))),
    "turned tip": ((3, 14), arm(GOOD, extra=tip(inertial(2, diagonal(0.5, 0.4, 0.3), rpy="1 2 3"), origin=""))),
    "continuous with a range": ((4, 0), arm(GOOD, kind="continuous")),
}
"""Files that MuJoCo reads as written from a version on, and alters before."""

SHIFT = '<origin xyz="0.1 0 0"/>'
BAR = inertial(2, diagonal(0.5, 0.4, 0.3), xyz="0.1 0 0.2")
MERGED = {
    "turned": ((3, 11), arm(GOOD, extra=tip(BAR))),
    "turned, on a frame": ((3, 11), arm("", extra=tip(BAR))),
    "turned ball": ((3, 11), arm(GOOD, extra=tip(inertial(2, diagonal(1, 1, 1), xyz="0.1 0 0.2")))),
    "principal axes": ((3, 11), arm(GOOD, extra=tip(inertial(2, FULL), origin=SHIFT))),
    "order of moments": ((3, 11), arm(GOOD, extra=tip(inertial(2, diagonal(0.3, 0.4, 0.5)), origin=SHIFT))),
    "through a frame": (
        (3, 11),
        arm(GOOD, extra=tip("") + f'<link name="end">{BAR}</link>' + joint("e", "tip", "end", "fixed")),
    ),
    "only turned": ((3, 6), arm(GOOD, extra=tip(inertial(2, diagonal(0.5, 0.4, 0.3)), origin='<origin rpy="1 2 3"/>'))),
}
"""Fixed links that MuJoCo merges wrongly in the versions from 3.3.3 on, and the first that does not."""

UNDECIDED = {
    "small products of a small tensor": arm(inertial(1, ("2e-12", "9e-13", "0", "2e-12", "0", "3e-12"))),
    "plate, turned": arm(inertial(1, ("0.25", "0.05", "0", "0.25", "0", "0.5"))),
}
"""Where a program's rounding decides."""

VERSION = tuple(int(part) for part in mujoco.__version__.split("."))


@pytest.mark.one_in(3)
@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize(("parser", "program"), PROGRAMS)
def test_a_program_does_what_our_rules_say(parser: str, program: Program, name: str) -> None:
    assert look(FILES[name]).verdict(parser).behaviour is program(FILES[name], read_document(FILES[name]))


CASES = {name: changed(*case[:2]) for table in (NOTES, ASSUMPTIONS, ERRORS) for name, case in table.items()}


WARNED = Behaviour.WARN, Behaviour.ACCEPT
"""Ours and theirs: that a program warned is not seen here."""


@pytest.mark.one_in(3)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # yourdfpy divides by the length of an axis
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize(("parser", "program"), PROGRAMS)
def test_a_program_does_with_faults_what_our_rules_say(parser: str, program: Program, name: str) -> None:
    """It is refused or altered as we say; that what is dropped is 0 here too is no reason to keep silent.

    Where we assume a range, yourdfpy keeps what is written, and nobody is asked for the direction of a frame.
    """
    text = CASES[name]
    document = read_document(text, tolerant=True)
    ours, theirs = inspect_document(document).verdict(parser).behaviour, program(text, document)
    assert (ours is Behaviour.REFUSE) == (theirs is Behaviour.REFUSE)
    if (parser, name) not in {("yourdfpy", "reversed"), ("yourdfpy", "above-the-default")}:
        assert theirs is ours or ours is Behaviour.ALTER or (ours, theirs) == WARNED


SECOND = URDF.replace('<robot name="two">', '<robot name="two" version="1.1">')
QUARTER = 'quat_xyzw="0 0 0.6 0.8"'
VERSIONS = {
    "joint": SECOND.replace('<origin xyz="0 0 0.5"/>', f'<origin xyz="0 0 0.5" {QUARTER}/>'),
    "inertial": SECOND.replace('rpy="0 0 0"', QUARTER),
    "both": SECOND.replace('<origin xyz="0 0 0.5"/>', f'<origin xyz="0 0 0.5" rpy="0 0 1" {QUARTER}/>'),
    "both, inertial": SECOND.replace('rpy="0 0 0"', f'rpy="0 0 0" {QUARTER}'),
    "1.2": SECOND.replace('"1.1"', '"1.2"').replace('effort="3"', 'acceleration="3"'),
    "1.2, negative": SECOND.replace('"1.1"', '"1.2"').replace('effort="3"', 'acceleration="-3"'),
    "1.2, no number": SECOND.replace('"1.1"', '"1.2"').replace('effort="3"', 'jerk="x"'),
    "1.1, no effort": SECOND.replace('effort="3"', 'acceleration="-3"'),
    "text behind": URDF + "oops",
    "capsule": URDF.replace(
        '<link name="hand"/>', '<link name="hand">' + shape('<capsule radius="1" length="1"/>') + "</link>"
    ),
}
"""Files of versions 1.1 and 1.2, and what else no fault is."""


@pytest.mark.parametrize("name", VERSIONS)
@pytest.mark.parametrize(("parser", "program"), PROGRAMS)
def test_a_program_does_with_newer_versions_what_our_rules_say(parser: str, program: Program, name: str) -> None:
    """urdfdom knows them, the others do not; an older urdfdom refuses them."""
    text = VERSIONS[name]
    document = read_document(text, tolerant=True)
    ours, theirs = inspect_document(document).verdict(parser).behaviour, program(text, document)
    assert theirs is ours or ours in (Behaviour.EITHER, Behaviour.ALTER) or (ours, theirs) == WARNED
    if theirs is Behaviour.ALTER:
        assert ours in (Behaviour.ALTER, Behaviour.EITHER)


DRIVEN = '<transmission name="t"><type>SimpleTransmission</type><joint name="turn"/><actuator name="a"/></transmission>'
OF_DRAKE = {
    **{f"mass {text}": changed('<mass value="1.5"/>', f'<mass value="{text}"/>')
       for text in ("", "m", "1,5", "1.5kg", "1 2", "1-2", "1e400", "1_5", "inf", "-", " .5 kg")},
    **{f"axis {text}": changed('xyz="0 0 2"', f'xyz="{text}"')
       for text in ("0 0 1m", "0, 0, 1", "0,0,1", "0 0", "1 0 0 0", "0 0 nan", "a")},
    **{f"limit {text}": changed(LIMIT_TWO, f"<limit {text}/>")
       for text in ('lower="1m" upper="2"', 'lower="-1" upper="1" effort="-2"', 'lower="-1" upper="1" effort="x"')},
    **{f"continuous {text}": changed(LIMIT_TWO, f"<limit {text}/>").replace('"revolute"', '"continuous"')
       for text in ("", 'lower="1"', 'lower="-1" upper="1"', 'lower="2" upper="1"', 'velocity="-1"', 'effort="-1"')},
    "driven, negative effort": changed('effort="3"', 'effort="-3"').replace("</robot>", f"{DRIVEN}</robot>"),
    "driven": URDF.replace("</robot>", f"{DRIVEN}</robot>"),
    "fixed, negative damping": changed(GRIP, f'{GRIP}<dynamics damping="-1"/>'),
}  # fmt: skip
"""How Drake reads numbers, ranges and limits."""


@pytest.mark.drake
@pytest.mark.parametrize("name", OF_DRAKE)
def test_drake_reads_numbers_and_ranges_as_our_rules_say(name: str) -> None:
    text = OF_DRAKE[name]
    document = read_document(text, tolerant=True)
    ours, theirs = inspect_document(document).verdict("Drake").behaviour, drake_behaviour(text, document)
    assert (ours is Behaviour.REFUSE) == (theirs is Behaviour.REFUSE)
    assert theirs is ours or ours is Behaviour.ALTER


def test_a_comment_names_no_version() -> None:
    text = URDF.replace("<robot ", '<!-- <robot version="1.0"> --><robot ')
    assert look(text).verdict("Drake").behaviour is look(URDF).verdict("Drake").behaviour is not Behaviour.WARN
    named = text.replace('<robot name="two">', '<robot name="two" version="1.0">')
    assert look(named).verdict("Drake").behaviour is Behaviour.WARN


blanks = st.lists(st.sampled_from(["", " ", "\t", "\n", "\r\n", "  ", " \t", "\n "]), min_size=4, max_size=4)


@given(blanks, st.sampled_from(['xyz="0 0 1"', 'xyz="0.1 0 0"', 'value="1"', 'iyy="1"', 'upper="1"']))
def test_blanks_around_numbers_do_to_pinocchio_what_our_rule_says(between: list[str], attribute: str) -> None:
    name, _, value = attribute.strip('"').partition('="')
    words = value.split()
    inner = [blank or " " for blank in between[1 : len(words)]]
    spread = between[0] + "".join(word + blank for word, blank in zip(words, [*inner, between[3]], strict=True))
    text = arm(inertial(1, diagonal(1, 1, 1), xyz="0.1 0 0"))
    assert attribute in text
    text = text.replace(attribute, f'{name}="{spread}"')
    assert look(text).verdict("Pinocchio").behaviour is pinocchio_behaviour(text, read_document(text))


@pytest.mark.one_in(3)
@pytest.mark.parametrize("power", range(-18, 7))
@pytest.mark.parametrize(("parser", "program"), PROGRAMS)
def test_the_rules_hold_at_every_scale(parser: str, program: Program, power: int) -> None:
    """Consumers' tolerances have a scale, ours in physics have none."""
    for last in ("1.5", "2", "2.5"):
        text = arm(inertial(1, diagonal(f"1e{power}", f"1e{power}", f"{last}e{power}")))
        assert look(text).verdict(parser).behaviour is program(text, read_document(text)), last


@pytest.mark.parametrize("name", UNDECIDED)
def test_where_rounding_decides_we_say_so(name: str) -> None:
    assert look(UNDECIDED[name]).verdict("MuJoCo").behaviour is Behaviour.EITHER
    assert mujoco_behaviour(UNDECIDED[name], read_document(UNDECIDED[name])) in Behaviour


@pytest.mark.parametrize("name", SINCE)
def test_where_the_version_decides_we_say_which(name: str) -> None:
    since, text = SINCE[name]
    verdict = look(text).verdict("MuJoCo")
    (reason,) = {match.reason for match in verdict.matches}
    assert verdict.behaviour is Behaviour.EITHER
    assert reason.startswith(f"before version {'.'.join(map(str, since)).removesuffix('.0')},")
    assert mujoco_behaviour(text, read_document(text)) is (Behaviour.ACCEPT if since <= VERSION else Behaviour.ALTER)


@pytest.mark.parametrize("name", MERGED)
def test_the_versions_that_merge_links_wrongly_are_told(name: str) -> None:
    until, text = MERGED[name]
    verdict = look(text).verdict("MuJoCo")
    assert verdict.behaviour is Behaviour.EITHER and {match.rule for match in verdict.matches} == {"mujoco-fused"}
    wrong = (3, 3, 3) <= VERSION < until
    assert mujoco_behaviour(text, read_document(text)) is (Behaviour.ALTER if wrong else Behaviour.ACCEPT)


angles = st.sampled_from(["0", "1", "-2.5", f"{math.pi}", f"{math.pi / 2}", f"{-math.pi}"])
sigmas = st.sampled_from([0.1, 0.2, 0.35])


@given(st.lists(sigmas, min_size=3, max_size=3), st.sampled_from([0, 0.05]), st.lists(angles, min_size=3, max_size=3))
def test_the_rpy_of_a_tensor_is_told_where_it_matters(sizes: list[float], product: float, rpy: list[str]) -> None:
    """MuJoCo has the tensor in the inertial frame's axes, or as if these were the link's; told where that differs."""
    x, y, z = sizes
    text = arm(inertial(2, (y + z, product, 0, x + z, 0, x + y), rpy=" ".join(rpy)))
    mass = read_document(text).links["arm"].inertial
    assert mass is not None
    theirs = tensor_of(mujoco.MjModel.from_xml_string(text).body("arm"))
    assert np.allclose(theirs, mass.inertia if VERSION >= (3, 14) else mass.tensor, rtol=0, atol=CONSUMER)
    told = "mujoco-rpy" in {match.rule for match in look(text).verdict("MuJoCo").matches}
    assert told is not np.allclose(mass.inertia, mass.tensor, rtol=0, atol=CONSUMER)


@pytest.mark.parametrize("kind", ["revolute", "prismatic", "continuous"])
@pytest.mark.parametrize(("multiplier", "offset"), [(2, 0), (-1, 0.5), (0, 0), (0, 0.3)])
def test_mujoco_s_followers_move_by_themselves(kind: str, multiplier: float, offset: float) -> None:
    """Before 3.13 nothing holds them; then a constraint does, which gives way to a force."""
    model = mujoco.MjModel.from_xml_string(follower(f'multiplier="{multiplier}" offset="{offset}"', kind))
    hold, swing = model.joint("hold").id, model.joint("swing").id
    read = [(model.eq_type[k], model.eq_obj1id[k], model.eq_obj2id[k], *model.eq_data[k, :5]) for k in range(model.neq)]
    constraint = (mujoco.mjtEq.mjEQ_JOINT, hold, swing, offset, multiplier, 0, 0, 0)
    assert read == ([constraint] if VERSION >= (3, 13) else [])
    data = mujoco.MjData(model)
    model.opt.gravity[:] = 0.0
    data.qpos[hold] = offset + multiplier * data.qpos[swing]
    data.qfrc_applied[hold] = 10.0
    for _ in range(200):
        mujoco.mj_step(model, data)
    assert abs(data.qpos[hold] - offset - multiplier * data.qpos[swing]) > SOFT


def test_either_is_said_only_where_it_makes_a_difference() -> None:
    """Of two rules the worse one counts, and an open one by its worst."""
    turned, impossible = inertial(2, FULL, rpy="1 2 3"), inertial(1, diagonal(1, 1, 3), rpy="1 2 3")
    assert look(arm(turned)).verdict("MuJoCo").behaviour is Behaviour.EITHER
    assert look(arm(turned, limit="")).verdict("MuJoCo").behaviour is Behaviour.EITHER
    assert look(FILES["mimic, and a turned tensor"]).verdict("MuJoCo").behaviour is Behaviour.ALTER
    assert look(arm(impossible)).verdict("MuJoCo").behaviour is Behaviour.REFUSE
    plate = arm(
        inertial(1, ("0.25", "0.05", "0", "0.25", "0", "0.5")), limit='<limit upper="1" effort="1" velocity="1"/>'
    )
    assert look(plate).verdict("MuJoCo").behaviour is Behaviour.EITHER  # altered, or refused


def without_shapes(text: str) -> str:
    """What masses and joints say alone: no meshes to be found, no extensions."""
    root = etree.fromstring(text.encode())
    for tag in ("link/visual", "link/collision", "transmission", "gazebo"):
        for element in root.findall(tag):
            element.getparent().remove(element)
    return etree.tostring(root).decode()


def bundled_and_examples() -> dict[str, str | Path]:
    from rttrr_pin.urdf.catalogue import bundled, examples

    try:
        return {**{name: name for name in bundled()}, **examples()}
    except RttrrError:  # the extra `robots` is not installed
        return {name: name for name in bundled()}


@pytest.mark.slow
@pytest.mark.parametrize(("parser", "program"), PROGRAMS)
def test_the_rules_hold_for_real_robots(parser: str, program: Program) -> None:
    wrong, seen = {}, 0
    for name, source in bundled_and_examples().items():
        try:
            text = without_shapes(rttrr_pin.load(source).model.urdf)
        except RttrrError:  # no URDF that the strict reader takes
            continue
        ours, theirs = look(text).verdict(parser).behaviour, program(text, read_document(text))
        seen += 1
        if ours is not theirs and ours is not Behaviour.EITHER:
            wrong[name] = (str(ours), str(theirs))
    assert seen >= 5
    assert wrong == {}


# Consumers that are not run


@pytest.mark.parametrize(
    ("text", "gazebo", "kdl"),
    [
        (arm(GOOD, base=GOOD), "accept", "alter"),
        (arm(GOOD), "refuse", "accept"),
        (arm("", base=GOOD), "alter", "alter"),
        (arm("", base=GOOD, extra=tip(GOOD)), "accept", "alter"),
        (arm(inertial(1, diagonal(1, 1, 3)), base=GOOD), "refuse", "alter"),
        (arm(inertial(1, diagonal(1, 1, 3)), base=GOOD, extra=tip(inertial(1, diagonal(5, 5, 5)))), "accept", "alter"),
        (arm(inertial(1, diagonal(0.1, 0.7, 0.8)), base=GOOD), "accept", "alter"),
        (arm(inertial(1, ("0.25", "0.05", "0", "0.25", "0", "0.5")), base=GOOD), "either", "alter"),
        (arm(GOOD, limit=""), "refuse", "refuse"),
        (arm(GOOD, limit="", kind="planar", base=GOOD), "alter", "alter"),
        (arm(GOOD).replace('"base"', '"world"'), "accept", "accept"),
        (
            f'<robot name="r"><link name="world"/><link name="a">{GOOD}</link>{joint("j", "world", "a", "fixed")}</robot>',
            "accept",
            "accept",
        ),
    ],
)
def test_gazebo_and_kdl_by_their_sources(text: str, gazebo: str, kdl: str) -> None:
    result = look(text)
    assert (result.verdict("Gazebo").behaviour, result.verdict("KDL").behaviour) == (gazebo, kdl)


def test_every_rule_is_met_by_a_file_and_has_a_source() -> None:
    more = [
        *FILES.values(),
        *UNDECIDED.values(),
        *(text for _, text in SINCE.values()),
        *(text for _, text in MERGED.values()),
        arm(inertial(1, ("0.25", "0.05", "0", "0.25", "0", "0.5")), base=GOOD),
    ]
    more += [*CASES.values(), *VERSIONS.values()]
    more.append(arm(inertial(1, diagonal("1e-18", "1e-18", f"{2e-18 + 16 * 2.220446049250313e-16!r}"))))
    met = {match.rule for text in more for verdict in look(text).verdicts for match in verdict.matches}
    assert met == {rule.id for rule in RULES}
    assert all(":" in rule.source and set(rule.parsers) <= set(PARSERS) for rule in RULES)
