"""Faults of files: what cannot change a number is a finding, what can is assumed where it is asked for, and said."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rttrr_pin
from rttrr_pin.core.model import Model
from rttrr_pin.errors import UrdfError
from rttrr_pin.inspection.run import inspect_document
from rttrr_pin.urdf.faults import KINDS, Level
from rttrr_pin.urdf.parser import read_document
from support.faulty import ASSUMPTIONS, AXIS, ERRORS, LIMIT, NOTES, URDF, changed
from support.tolerances import MODEL, ROUNDING, norm_error

pytestmark = pytest.mark.filterwarnings("ignore::rttrr_pin.errors.LoadWarning")

REPORTS = Path(__file__).parents[1] / "data" / "reports"


def numbers(model: Model) -> list[object]:
    """All that a model says."""
    links = [(link.name, link.mass, link.com.tolist(), link.inertia.tolist()) for link in (model.root, *model.links)]
    joints = [
        (joint.name, joint.type.name, joint.parent, joint.p.tolist(), joint.axis.tolist(), joint.limits, joint.mimic)
        for joint in model.joints
    ]
    return [*links, *joints]


def kinds(text: str, level: Level) -> set[str]:
    return {fault.kind for fault in read_document(text, tolerant=True).faults if fault.level is level}


@pytest.mark.parametrize("case", NOTES)
def test_what_cannot_change_a_number_is_a_finding(case: str) -> None:
    old, new, kind = NOTES[case]
    text = changed(old, new)
    document = read_document(text)
    assert {fault.level for fault in document.faults} == {Level.NOTE}
    assert {kind} <= {fault.kind for fault in document.faults} <= {kind, "namespace", "unused"}
    assert numbers(rttrr_pin.load(text).model) == numbers(rttrr_pin.load(URDF).model)
    findings = [finding for finding in inspect_document(document).findings if finding.id.startswith("F")]
    assert {finding.reason for finding in findings} == {fault.message for fault in document.faults}
    assert all(finding.severity != "error" and finding.line > 0 for finding in findings)


@pytest.mark.parametrize("case", ASSUMPTIONS)
def test_what_can_is_refused_and_assumed_where_it_is_asked_for(case: str) -> None:
    """The message names the way on; what was assumed stands in the notes, and in the text for other programs."""
    old, new, kind, meant = ASSUMPTIONS[case]
    text = changed(old, new)
    wanted = changed(old, meant) if meant else URDF[: URDF.index("<inertial>")] + URDF[URDF.index("</inertial>") + 11 :]
    with pytest.raises(UrdfError, match=r"--lenient \(lenient=True\) assumes: ") as caught:
        rttrr_pin.load(text)
    assert caught.value.line
    robot = rttrr_pin.load(text, lenient=True)
    expected = numbers(rttrr_pin.load(wanted).model)
    if case in ("quaternion", "negative-velocity"):  # other words for it, with other roundings
        expected = numbers(robot.model)
    assert numbers(robot.model) == expected
    assert kind in kinds(text, Level.ASSUMPTION)
    assert any("assumed" in note.text for note in robot.model.notes)
    again = rttrr_pin.load(robot.model.urdf, lenient=True).model
    assert numbers(again)[:4] == numbers(robot.model)[:4] and again.joint_names == robot.joint_names


@pytest.mark.parametrize("case", ["no-axis", "reversed", "no-inertia", "no-mass", "unequal-inertials", "two-parents"])
def test_other_programs_are_handed_what_was_assumed(case: str) -> None:
    old, new, *_ = ASSUMPTIONS[case]
    result = rttrr_pin.validate(rttrr_pin.load(changed(old, new), lenient=True), subject="recursion", n_states=5)
    assert result.passed
    assert any("assumed" in note for note in result.to_dict()["notes"])


def test_limits_that_are_missing_are_told_and_written_out() -> None:
    """Pinocchio refuses the file, and takes what was assumed: nothing is limited."""
    for old, new in ((LIMIT, ""), (' effort="3"', "")):
        robot = rttrr_pin.load(changed(old, new), lenient=True)
        assert robot.model.joints[0].limits.effort == np.inf
        assert any("no" in note.text and "limit" in note.text for note in robot.model.notes)
        assert pinocchio.buildModelFromXML(robot.model.urdf).nv == 2


@pytest.mark.parametrize("case", ERRORS)
def test_what_makes_no_robot_is_refused_always_and_inspected(case: str) -> None:
    old, new, kind = ERRORS[case]
    text = changed(old, new)
    for lenient in (False, True):
        with pytest.raises(UrdfError) as caught:
            rttrr_pin.load(text, lenient=lenient)
        assert "--lenient" not in str(caught.value)
    document = read_document(text, tolerant=True)
    assert kind in {fault.kind for fault in document.faults if fault.level is Level.ERROR}
    result = inspect_document(document)
    assert not result.passed and len(result.links) == len(document.links) == len(document.joints) + 1


def test_every_kind_has_a_case() -> None:
    cases = [case[2] for case in (*NOTES.values(), *ASSUMPTIONS.values(), *ERRORS.values())]
    assert set(cases) == set(KINDS) - {"rotations"}


APART = sorted(name for name, case in ASSUMPTIONS.items() if case[3] and case[2] != "products")
"""Without a mass there is no tensor to speak of, and an attribute stands once."""


@given(st.sets(st.sampled_from(sorted(NOTES)), max_size=6), st.sets(st.sampled_from(APART), max_size=3))
@settings(max_examples=100)
def test_all_faults_of_a_file_are_listed(harmless: Iterable[str], assumed: Iterable[str]) -> None:
    """Whatever stands beside them."""
    text, wanted, parts = URDF, set[str](), list[str]()
    for old, new, kind in [NOTES[case] for case in harmless] + [ASSUMPTIONS[case][:3] for case in assumed]:
        apart = not any(old in part or part in old for part in parts)
        if apart and text.count(old) == URDF.count(old) and "robot" not in old and "<inertial>" not in new:
            text = text.replace(old, new, 1)
            wanted.add(kind)
            parts.append(old)
    found = {fault.kind for fault in read_document(text, tolerant=True).faults}
    assert wanted <= found


def test_the_number_of_faults_is_told() -> None:
    text = changed(AXIS, "").replace('ixy="0.01"', 'ixy="0,01"').replace('value="1.5"', 'value="nan"')
    with pytest.raises(UrdfError, match=r"and 2 more: rttrr-pin inspect lists all"):
        rttrr_pin.load(text)


# The reports


PLAINLY = ("c01b", "c03_axis_rpy", "c04_iyx", "c06_xml_version_0", "c07_default_ns", "c11_same_origin_twice",
           "c13_unused_xacro", "l1_loop_joint", "p3_constraint", "t1_dangling_transmission")  # fmt: skip


STILL = [("c07_default_ns", "fixed")]
"""One link: nothing moves."""


@pytest.mark.parametrize(
    ("report", "base"), [case for case in product(PLAINLY, ["fixed", "floating"]) if case not in STILL]
)
def test_files_of_reports_load_and_agree(report: str, base: str) -> None:
    robot = rttrr_pin.load(REPORTS / f"{report}.urdf", base=base)  # type: ignore[arg-type]
    assert rttrr_pin.validate(robot, subject="recursion", n_states=5).passed


def test_a_quaternion_turns_the_frame() -> None:
    """ros/urdfdom, issue 235: without it the torque is -0.024 N m."""
    robot = rttrr_pin.load(REPORTS / "c01b.urdf")
    assert robot.inverse_dynamics([0.3], [0], [0]).tau == pytest.approx(
        pinocchio.rnea(*_pinocchio(robot.model.urdf), np.array([0.3]), np.zeros(1), np.zeros(1)), rel=1e-14
    )


def _pinocchio(text: str) -> tuple[pinocchio.Model, pinocchio.Data]:
    model = pinocchio.buildModelFromXML(text)
    return model, model.createData()


def test_limits_reversed_and_no_axis() -> None:
    for report, kind in (("c09_limits_reversed", "range"), ("c10_no_axis", "axis")):
        with pytest.raises(UrdfError, match="--lenient"):
            rttrr_pin.load(REPORTS / f"{report}.urdf")
        robot = rttrr_pin.load(REPORTS / f"{report}.urdf", lenient=True)
        assert rttrr_pin.validate(robot, subject="recursion", n_states=5).passed
        assert kinds((REPORTS / f"{report}.urdf").read_text(), Level.ASSUMPTION) == {kind}


def test_loops_are_told_where_a_result_is_shown() -> None:
    with pytest.warns(rttrr_pin.errors.LoadWarning, match="<loop_joint> is not modelled"):
        robot = rttrr_pin.load(REPORTS / "l1_loop_joint.urdf")
    assert any("not modelled" in note for note in rttrr_pin.validate(robot, subject="recursion", n_states=5).notes)


# Versions 1.1 and 1.2


quaternions = st.lists(st.sampled_from([0.0, 1.0, -1.0, 0.5, 1e-8, 0.3]) | st.floats(-1, 1), min_size=4, max_size=4)


@given(quaternions.filter(lambda q: np.linalg.norm(q) > 0.1), st.sampled_from([1.0, 1e-30, 1e30, 3.0]))
def test_quaternions_of_any_length_turn_as_pinocchio_has_them(q: list[float], size: float) -> None:
    words = " ".join(repr(x * size) for x in q)
    text = changed('<origin xyz="0 0 0.5"/>', f'<origin xyz="0 0 0.5" quat_xyzw="{words}"/>')
    text = text.replace('<robot name="two">', '<robot name="two" version="1.1">')
    robot = rttrr_pin.load(text)
    if size in (1.0, 3.0):
        built = pinocchio.buildModelFromXML(text).jointPlacements[1].rotation
        assert norm_error(robot.model.joints[0].R, built) <= MODEL
    doubles, exact = (robot.enclose([0.3, 0.1], [1, 2], [3, 4], parameters=p) for p in ("doubles", "text"))  # type: ignore[arg-type]
    assert norm_error(doubles.tau.lower, exact.tau.lower) <= ROUNDING


def test_a_rotation_is_written_once() -> None:
    text = changed('<origin xyz="0 0 0.5"/>', '<origin xyz="0 0 0.5" rpy="1 0 0" quat_xyzw="0 0 0 1"/>')
    text = text.replace('<robot name="two">', '<robot name="two" version="1.2">')
    assert kinds(text, Level.ASSUMPTION) == {"rotations"}
    assert rttrr_pin.load(text, lenient=True).model.joints[0].R.tolist() == np.eye(3).tolist()


def test_limits_of_version_1_2() -> None:
    """Acceleration, deceleration and jerk are read; effort and velocity may be left out."""
    text = URDF.replace('<robot name="two">', '<robot name="two" version="1.2">')
    more = text.replace('effort="3"', 'acceleration="3" deceleration="2" jerk="1"')
    assert read_document(more).faults == ()
    assert rttrr_pin.load(more).model.joints[0].limits.effort == np.inf
    assert kinds(more.replace('jerk="1"', 'jerk="-1"'), Level.NOTE) == {"unused"}
    assert kinds(text.replace('effort="3"', 'acceleratoin="3"'), Level.NOTE) == {"word"}


# mimic, root_joint


FOLLOWER = changed(AXIS, AXIS + '<mimic joint="move" multiplier="2"/>')


def test_followers_move_by_themselves_without_mimic() -> None:
    """As in Pinocchio unless it is asked; other programs are handed a robot without <mimic>."""
    robot = rttrr_pin.load(FOLLOWER, mimic=False)
    assert robot.joint_names == ("turn", "move") and rttrr_pin.load(FOLLOWER).joint_names == ("move",)
    assert "mimic" not in robot.model.urdf
    for reference in ("pinocchio", "mujoco", "lagrange"):
        assert rttrr_pin.validate(robot, subject="recursion", reference=reference, n_states=3).passed
    robot.enclose([0.1, 0.2], [0, 0], [0, 0], parameters="text")


@pytest.mark.one_in(2)
@pytest.mark.parametrize(
    "names", [["turn"], ["grip"], ["arm"], ["base"], ["turn", "arm"], ["turn", "base", "grip"]], ids="-".join
)
def test_a_robot_with_something_called_root_joint_floats(names: list[str]) -> None:
    text = URDF
    for number, name in enumerate(names):
        new = "root_joint" if number == 0 or name in ("arm", "base") else f"root_joint_{number + 1}"
        text = text.replace(f'"{name}"', f'"{new}"')
    robot = rttrr_pin.load(text, base="floating")
    assert len(set(robot.joint_names)) == 3
    for program in ("recursion", "kernel"):
        assert rttrr_pin.validate(robot, subject=program, n_states=20).passed


def test_what_xacro_would_write_is_never_assumed() -> None:
    text = changed('<mass value="1.5"/>', '<mass value="${mass}"/>')
    for lenient in (False, True):
        with pytest.raises(UrdfError, match="this is xacro, which must be expanded") as caught:
            rttrr_pin.load(text, lenient=lenient)
        assert "--lenient" not in str(caught.value)
