"""Inspection: each check fires on what it is for and on nothing else; files are mended in place; the command line."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.cli import main
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints import REVOLUTE
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.solids import Box, Cylinder, RigidBody
from rttrr_pin.errors import InputError, UnknownNameError, UrdfError
from rttrr_pin.inspection import CHECKS, PARSERS, RULES, Inspection, Severity, inspect, repair
from rttrr_pin.inspection.run import inspect_document
from rttrr_pin.inspection.shapes import find_mesh, looks_of
from rttrr_pin.inspection.telling import count_errors
from rttrr_pin.reporting.files import as_json
from rttrr_pin.urdf.parser import read_document
from support.inspected import arm, diagonal, inertial, joint, mirrored, shape, tip
from support.tolerances import URDF_DIGITS

BOX = (0.4, 0.2, 0.1)
"""m; of aluminium it weighs 21.6 kg."""

MASS = 21.6

DRAWN = shape('<box size="0.4 0.2 0.1"/>', xyz="0.2 0 0")
"""The box, on one side of the joint."""

AT = "0.2 0 0"


def tensor_of(moments: np.ndarray) -> tuple[str, ...]:
    return tuple(f"{float(moments[i, j]):.6g}" for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)))


BODY = RigidBody.of(Box(BOX), MASS / Box(BOX).volume)

GOOD = inertial(MASS, tensor_of(BODY.inertia), xyz=AT) + DRAWN


def box_arm(mass: object = MASS, tensor: tuple[object, ...] | None = None, xyz: str = AT, **words: str) -> str:
    return arm(inertial(mass, tensor_of(BODY.inertia) if tensor is None else tensor, xyz=xyz) + DRAWN, **words)


def scaled(factor: float) -> tuple[str, ...]:
    return tensor_of(BODY.inertia * factor)


def about_origin() -> tuple[str, ...]:
    return tensor_of(BODY.placed((0.2, 0.0, 0.0)).inertia + MASS * np.diag([0.0, 0.04, 0.04]))


PRODUCTS = (0.02, 0.005, 0, 0.02, 0.004, 0.02)
"""That of a body which is not its own mirror image across the plane y = 0."""


COPIED = {"xyz": "0.1 0.2 0"}


def dense(density: float) -> str:
    """An arm of three bodies of one density."""
    box = inertial(density * Box(BOX).volume, scaled(density / 2700.0), xyz=AT) + DRAWN
    return arm(box, base=box, extra=tip(box))


def swapped() -> tuple[str, ...]:
    return tensor_of(BODY.inertia[np.ix_([2, 1, 0], [2, 1, 0])])


MESH = shape('<mesh filename="package://nowhere/meshes/arm.stl"/>')

CASES: dict[str, list[tuple[str, list[str]]]] = {
    "P101": [(arm(inertial(-1)), ["arm"])],
    "P102": [(arm(inertial(0)), ["arm"]), (arm(inertial(0), extra=tip(inertial(0))), ["arm", "tip"])],
    "P103": [
        (arm("", base=inertial()), ["arm"]),
        (arm(inertial(0, (0,) * 6), base=inertial(), extra=tip("")), ["arm"]),
        (arm("", base=inertial(), extra=tip("", kind="revolute")), ["arm"]),
    ],
    "P104": [(arm(inertial(1, (1, 2, 0, 1, 0, 1.5))), ["arm"])],
    "P105": [(arm(inertial(1, diagonal(1, 1, 3))), ["arm"])],
    "P106": [(arm(inertial(1, diagonal("0.1000", "0.2000", "0.3001"))), ["arm"])],
    "P107": [(arm(inertial(1, diagonal(0.1, 0.7, 0.8))), ["arm"]), (arm(inertial(1, diagonal(1, 1, 0))), ["arm"])],
    "P108": [
        (arm(inertial(1, (0,) * 6)), ["arm"]),
        (arm("", extra=tip(inertial(1, (0,) * 6))), ["tip"]),
        (arm(extra=tip(inertial(1, (0,) * 6))), []),
    ],
    "P109": [(arm(""), ["arm"]), (arm(inertial(0, (0,) * 6)), ["arm"])],
    "P110": [
        (arm(inertial(0, (0,) * 6) + DRAWN, extra=tip(inertial(), kind="revolute")), ["arm"]),
        (arm(base=inertial(0, (0,) * 6) + DRAWN), ["base"]),
        (arm(base=DRAWN), []),
        (arm(DRAWN, extra=tip(inertial())), []),
    ],
    "G201": [(box_arm(tensor=scaled(1e3)), ["arm"])],
    "G202": [(box_arm(tensor=scaled(1e-3)), ["arm"])],
    "G203": [(box_arm(MASS * 1e3, scaled(1e3)), ["arm"]), (box_arm(MASS * 1e-4, scaled(1e-4)), ["arm"])],
    "G204": [(box_arm(xyz="200 0 0"), ["arm"])],
    "G205": [
        (box_arm(tensor=tensor), ["arm"])
        for tensor in (about_origin(), swapped(), scaled(1e3), scaled(1e6), scaled(1e9))
    ],
    "G208": [(arm(inertial() + MESH), ["arm"])],
    "G209": [
        (arm(inertial(0.01, diagonal(1, 1, 1))), ["arm"]),
        (arm(inertial(1, diagonal(1e-6, 1e-6, 1e-6))), ["arm"]),
        (arm(inertial(1, diagonal(1e4, 1e4, 0), xyz="0.1 0 0")), ["arm"]),
    ],
    "G210": [(dense(density), where) for density, where in ((7850, ["arm"]), (1000, ["arm"]), (2700, []))],
    "T301": [(mirrored({"mass": 1}, {"mass": 1.05}), ["left_hand"])],
    "T302": [
        (mirrored({}, {"tensor": diagonal(0.02, 0.02, 0.021)}), ["left_hand"]),
        (mirrored({"xyz": "0.1 0.2 0"}, {"xyz": "0.1 -0.21 0"}), ["left_hand"]),
    ],
    "T303": [
        (mirrored({"xyz": "0.1 0.2 0"}, {"xyz": "0.1 0.2 0"}, apart=0.1), ["left_hand"]),
        (mirrored({"tensor": PRODUCTS}, {"tensor": PRODUCTS}, apart=0.1), ["left_hand"]),
        (mirrored({"xyz": "0.1 0 0.2"}, {"xyz": "0.1 0 0.2"}, apart=0.1), []),
        (mirrored(COPIED, COPIED, apart=0.1).replace("</inertial>", f"</inertial>{DRAWN}"), []),
    ],
    "T304": [(mirrored({"mass": 1}, {"mass": 1.005}), ["mirrored"])],
    "J401": [
        (arm(limit='<limit lower="0" upper="0" effort="1" velocity="1"/>'), ["swing"]),
        (arm(limit='<limit effort="1" velocity="1"/>', kind="prismatic"), ["swing"]),
    ],
    "J402": [(arm(limit='<limit lower="0" upper="1" effort="0" velocity="1"/>'), ["swing"])],
    "J403": [
        (arm(limit=""), ["swing"]),
        (arm(limit="", kind="prismatic"), ["swing"]),
        (arm(limit='<limit lower="0" upper="1" velocity="1"/>'), ["swing"]),
    ],
    "J404": [(arm(limit='<limit lower="-1e16" upper="1e16" effort="1" velocity="1"/>', kind="prismatic"), ["swing"])],
    "J405": [(arm(limit='<limit lower="-180" upper="180" effort="1" velocity="1"/>'), ["swing"])],
    "J406": [(arm(limit='<limit upper="1" effort="1" velocity="1"/>'), ["swing"])],
    "C501": [(arm(base=inertial()), ["base"])],
}
"""For each check: files in which it finds something, and where."""

TURNED = "0.5 -0.8 1.1"

BOTH = shape('<box size="0.4 0.2 0.1"/>', xyz="1 0 0", rpy=TURNED)

HEALTHY = {
    "arm": arm(),
    "box": arm(GOOD),
    "box and a frame": arm(GOOD, extra=tip("")),
    "massless link that carries mass": arm("", extra=tip(inertial(), kind="revolute")),
    "continuous without limit": arm(limit="", kind="continuous"),
    "mirrored": mirrored({"xyz": "0.1 0.2 0"}, {"xyz": "0.1 -0.2 0"}),
    "mirrored, without mass on one side": mirrored({}, {"mass": 1}).replace("left_hand", "left_fin"),
    "box, turned": arm(inertial(MASS, tensor_of(BODY.inertia), xyz="1 0 0", rpy=TURNED) + BOTH),
    "mesh-like hull, turned": arm(inertial(MASS, tensor_of(BODY.inertia), xyz="1 0 0", rpy=TURNED) + BOTH + BOTH),
    "cylinder, turned": arm(
        inertial(
            2.0,
            tensor_of(RigidBody.of(Cylinder(0.05, 0.3), 1.0).inertia * (2.0 / Cylinder(0.05, 0.3).volume)),
            rpy="0 1.5707963267948966 0",
        )
        + shape('<cylinder radius="0.05" length="0.3"/>', rpy="0 1.5707963267948966 0")
    ),
}


def test_shapes_stand_where_they_are_placed() -> None:
    """The hull of a turned box is the turned box, whether it is drawn once or twice."""
    for inside in (BOTH, BOTH + BOTH):
        link = read_document(arm(inertial() + inside)).links["arm"]
        looks = looks_of(link, None)
        wanted = RigidBody.of(Box(BOX), 1.0).placed((1.0, 0.0, 0.0), (0.5, -0.8, 1.1))
        for solid in looks.solids:
            assert np.allclose(solid.body.com, wanted.com, rtol=URDF_DIGITS)
            assert np.allclose(solid.body.inertia, wanted.inertia, atol=URDF_DIGITS * np.abs(wanted.inertia).max())
        assert np.isclose(looks.volume, Box(BOX).volume)
        assert len(looks.solids) == 1


def found_by(check: str, text: str) -> list[str]:
    return [found.name for found in inspect(rttrr_pin.load(text), select=[check]).findings]


def test_each_check_has_a_case() -> None:
    """Those of the file itself, F, have theirs in tests/urdf/test_faults.py."""
    assert list(CASES) == [check.id for check in CHECKS if not check.id.startswith("F")]
    assert len({check.id for check in CHECKS}) == len(CHECKS)


@pytest.mark.parametrize(("check", "case"), [(check, k) for check, cases in CASES.items() for k in range(len(cases))])
def test_a_check_finds_what_it_is_for(check: str, case: int) -> None:
    text, where = CASES[check][case]
    assert found_by(check, text) == where
    for found in inspect(rttrr_pin.load(text), select=[check]).findings:
        assert found.reason and found.fix
        assert found.line >= (0 if found.kind == "robot" else 1)


@pytest.mark.parametrize("check", CASES)
def test_errors_are_counted_without_looking_at_meshes(check: str, monkeypatch: pytest.MonkeyPatch) -> None:
    twice = '<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="revolute"><parent link="a"/>'
    twice += '<child link="b"/><axis xyz="1 0 0"/><axis xyz="0 1 0"/></joint></robot>'  # a warning, were they equal
    documents = [read_document(text, tolerant=True) for text in (twice, *(text for text, _ in CASES[check]))]
    wanted = [inspect_document(document).counts[Severity.ERROR] for document in documents]
    monkeypatch.setattr("rttrr_pin.inspection.shapes.looks_of", lambda *_: pytest.fail("a mesh was opened"))
    assert [count_errors(document) for document in documents] == wanted


@pytest.mark.parametrize("name", HEALTHY)
def test_nothing_is_found_in_a_healthy_file(name: str) -> None:
    assert inspect(rttrr_pin.load(HEALTHY[name])).findings == ()


@pytest.mark.parametrize("name", ["rttrr", "trr", "trtr", "trtrr", "trttr"])
def test_the_bundled_arms_are_healthy(name: str, repository: Path) -> None:
    assert inspect(rttrr_pin.load(name), repository / "urdf").findings == ()


@pytest.mark.parametrize(
    ("name", "others"),
    [
        ("left_arm", ["right_arm"]),
        ("arm_Left", ["arm_Right"]),
        ("LEFT_HIP", ["RIGHT_HIP"]),
        ("FL_hip", ["FR_hip"]),
        ("rh_foot", ["lh_foot"]),
        ("l_foot", ["r_foot"]),
        ("L-FOOT", ["R-FOOT"]),
        ("l_gripper_r_tip", ["r_gripper_l_tip", "r_gripper_r_tip"]),
        ("roll_link", []),
        ("pillar", []),
    ],
)
def test_the_other_side_of_a_name(name: str, others: list[str]) -> None:
    from rttrr_pin.inspection.structure import other_side

    assert list(other_side(name)) == others
    for other in others:
        assert name in other_side(other)


def test_the_most_alike_of_two_possible_mirror_images_counts() -> None:
    """The left finger of the left hand may be that of the right hand, or its right finger."""
    masses = {"l_hand_l_tip": 1, "l_hand_r_tip": 2, "r_hand_l_tip": 1, "r_hand_r_tip": 2}
    links = "".join(
        f'<link name="{name}">{inertial(mass)}</link>{joint(name, "base", name)}' for name, mass in masses.items()
    )
    assert found_by("T", f'<robot name="hands"><link name="base"/>{links}</robot>') == []


def test_findings_stand_in_the_order_of_the_file() -> None:
    links = [f'\n<link name="{name}">{inside}</link>' for name, inside in (("b", inertial(0)), ("a", inertial(-1)))]
    joints = [joint(f"j{name}", "base", name) for name in "ab"]
    text = f'<robot name="r"><link name="base"/>{"".join(links + joints)}</robot>'
    assert [(found.name, found.id) for found in look(text, ["P10"]).findings][:1] == [("b", "P102")]
    assert [found.line for found in look(text).findings] == sorted(found.line for found in look(text).findings)


def test_values_carry_units_and_lines() -> None:
    text = "\n".join(re.split("(?=<link|<inertial|<joint)", arm(inertial(1, diagonal(1, 1, 3)))))
    (found,) = inspect(rttrr_pin.load(text), select=["P"]).findings
    assert (found.id, found.severity, found.kind, found.value, found.unit) == ("P105", "error", "link", 1.0, "kg m^2")
    assert '<link name="arm">' in text.splitlines()[found.line - 1]


# Meshes


def write_mesh(path: Path) -> None:
    import trimesh

    path.parent.mkdir(parents=True, exist_ok=True)
    trimesh.creation.box(extents=BOX).export(path)


@pytest.mark.parametrize(
    ("filename", "place"),
    [
        ("package://parts/meshes/arm.stl", "parts/meshes/arm.stl"),
        ("package://parts/meshes/arm.stl", "meshes/arm.stl"),
        ("meshes/arm.stl", "robots/meshes/arm.stl"),
    ],
)
def test_meshes_are_found_and_weighed(filename: str, place: str, tmp_path: Path) -> None:
    """In the URDF's folder, or a package at or above it."""
    top = tmp_path / "parts"
    folder = top / "robots"
    folder.mkdir(parents=True)
    write_mesh((tmp_path if place.startswith("parts") else top) / place)
    mesh = shape(f'<mesh filename="{filename}"/>', xyz=AT)
    good, bad = (arm(inertial(MASS, scaled(factor), xyz=AT) + mesh) for factor in (1, 1e9))
    assert inspect(rttrr_pin.load(good), folder).findings == ()
    assert [(found.id, found.cause) for found in inspect(rttrr_pin.load(bad), folder).findings] == [("G205", "unit")]


@pytest.mark.parametrize(("kept", "share"), [(12, 1.0), (10, 0.0)])
def test_a_closed_mesh_has_a_volume(kept: int, share: float, tmp_path: Path) -> None:
    """Scaled, and moved away from its origin; of a box without a lid nothing is known."""
    import trimesh

    box = trimesh.creation.box(extents=BOX)
    box.apply_translation((5.0, -3.0, 2.0))
    lid = np.argsort(box.triangles_center[:, 2])[:kept]
    trimesh.Trimesh(box.vertices, box.faces[lid]).export(tmp_path / "box.stl")
    link = read_document(arm(inertial() + shape('<mesh filename="box.stl" scale="2 1 -1"/>'))).links["arm"]
    assert np.isclose(looks_of(link, tmp_path).filled, 2.0 * share * Box(BOX).volume)


@pytest.mark.parametrize("content", [b"", b"no mesh", b"solid x\nfacet normal 1 2\n", bytes(200)])
def test_a_damaged_mesh_leaves_the_geometry_unknown(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "arm.stl").write_bytes(content)
    text = arm(inertial(MASS, scaled(1e9)) + shape('<mesh filename="arm.stl"/>'))
    assert {found.id for found in inspect(rttrr_pin.load(text), tmp_path).findings} == {"G208", "G209"}


@pytest.mark.parametrize(
    "tag", ["<box/>", '<box size="1 2"/>', '<sphere radius="-1"/>', '<box size="a b c"/>', "<capsule/>"]
)
def test_a_shape_that_is_none_leaves_the_geometry_unknown(tag: str) -> None:
    assert {found.id for found in look(arm(inertial(MASS, scaled(1e9)) + shape(tag))).findings} == {"G208", "G209"}


def test_no_name_of_a_mesh_breaks_the_search(tmp_path: Path) -> None:
    for name in (
        "",
        ".",
        "a\0b.stl",
        "x" * 5000 + ".stl",
        "package://",
        "package:///.stl",
        "https://example.org/a.stl",
    ):
        assert find_mesh(name, tmp_path) is None


# Repairs

REPAIRABLE = {
    "P106": arm(inertial(1, diagonal("0.1000", "0.2000", "0.3001"))),
    "P106, full tensor": arm(inertial(1, ("0.62961", "-0.12347", "0.07531", "0.37039", "0.24691", "0.84939"))),
    "G205, origin": box_arm(tensor=about_origin()),
    "G205, unit": box_arm(tensor=scaled(1e9)),
}


def look(text: str, select: Iterable[str] = ()) -> Inspection:
    return inspect(rttrr_pin.load(text), select=select)


@pytest.mark.parametrize("name", ["P106", "G205, origin", "G205, unit"])
def test_a_repaired_file_passes(name: str) -> None:
    before = look(REPAIRABLE[name])
    repaired = repair(before)
    assert [found.id for found in repaired.done] == [name.split(",")[0]]
    after = look(repaired.text)
    assert name.split(",")[0] not in {found.id for found in after.findings}
    assert repair(after).done == ()
    rttrr_pin.load(repaired.text)


def test_a_repair_by_rounding_rounds_to_the_digits_that_were_there() -> None:
    before = look(REPAIRABLE["P106"])
    edits = {edit.attribute: edit.text for edit in repair(before).done[0].repair}
    written = {"ixx": "0.1000", "iyy": "0.2000", "izz": "0.3001"}
    assert edits
    assert all(round(Fraction(text), 4) == Fraction(written[name]) for name, text in edits.items())


def test_only_the_values_change() -> None:
    """Comments, blanks, quotation marks, line ends, namesakes elsewhere: byte for byte."""
    nested = '<note><link name="x"/></note>'
    other = '<gazebo><link name="arm"><inertial><inertia ixx="7"/></inertial></link></gazebo>'
    changes = {
        'ixx="0.1000"': "\n\t ixx = '0.1000'",
        '<link name="arm"><inertial>': f'<link name="arm">{nested}<inertial>',
        '<link name="base">': f'{other}<link name="base">',
        "<robot": "<?xml version='1.0'?>\r\n<!-- ixx=\"0.1000\" \u00fc --><robot",
    }
    text = REPAIRABLE["P106"]
    for old, new in changes.items():
        assert text.count(old) == 1
        text = text.replace(old, new)
    repaired = repair(look(text))
    changed = {edit.attribute: edit.text for edit in repaired.done[0].repair}
    expected = text
    for name, value in changed.items():
        old = {"ixx": "0.1000", "iyy": "0.2000", "izz": "0.3001"}[name]
        expected = re.sub(rf"(<inertia [^>]*\b{name}\s*=\s*['\"]){re.escape(old)}", rf"\g<1>{value}", expected)
    assert repaired.text == expected != text


@pytest.mark.parametrize("check", ["P101", "P102", "P104", "P105", "T301", "J401"])
def test_what_is_not_certain_is_left(check: str) -> None:
    """A negative mass is wrong, but which mass is right the file does not say."""
    text = CASES[check][0][0]
    repaired = repair(look(text))
    assert repaired.text == text
    assert repaired.done == ()
    assert check in {found.id for found in repaired.left}


def test_a_factor_that_the_mass_may_explain_is_left() -> None:
    """Inertia 1000 times too large for the mass: or the mass 1000 times too small. Slots: or the drawing is turned."""
    assert repair(look(box_arm(tensor=swapped()))).done == ()
    assert repair(look(box_arm(tensor=scaled(1e3)))).done == ()
    assert repair(look(box_arm(MASS * 1e-6, scaled(1.0)))).done == ()


# Command line


def write(path: Path, text: str) -> str:
    path.write_text(text)
    return str(path)


@pytest.mark.parametrize(
    ("text", "words", "code"),
    [
        (arm(), [], 0),
        (CASES["P105"][0][0], [], 1),
        (CASES["T301"][0][0], [], 0),
        (CASES["T301"][0][0], ["--strict"], 1),
        (CASES["P107"][0][0], ["--strict"], 0),
        (CASES["P105"][0][0], ["--ignore", "P1"], 0),
        (CASES["P105"][0][0], ["--select", "J", "--select", "G"], 0),
        (CASES["P105"][0][0], ["--select", "P105"], 1),
        (arm(), ["--select", "X"], 2),
        ("<robot/>", [], 2),
        (arm().replace('value="1"', 'value="1,5"'), [], 1),
        (arm().replace("</robot>", ""), [], 2),
    ],
)
def test_exit_codes(text: str, words: list[str], code: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["inspect", write(tmp_path / "arm.urdf", text), *words]) == code
    out, err = capsys.readouterr()
    assert bool(err) == (code == 2)
    assert ("FAIL" in out) == (code == 1 and "--strict" not in words)


def test_json_holds_the_whole_inspection(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write(tmp_path / "arm.urdf", CASES["P105"][0][0])
    assert main(["inspect", path, "--json", "-"]) == 1
    data = json.loads(capsys.readouterr().out)
    assert (data["schema"], data["passed"]) == (1, False)
    assert data["counts"] == {"error": 1, "warning": 0, "note": 0}
    (found,) = data["findings"]
    assert set(found) == {"id", "severity", "kind", "name", "line", "value", "unit", "reason", "fix", "repair", "cause"}
    assert list(data["parsers"]) == list(PARSERS)
    assert data["parsers"]["MuJoCo"]["behaviour"] == "refuse"
    assert data["parsers"]["MuJoCo"]["rules"][0]["source"]
    row = data["links"][1]
    assert row["shape"] == "impossible" and len(row["axes"]) == 3 and row["semi_axes"][2] == "nan"
    assert main(["inspect", path, "--json", str(tmp_path / "out.json"), "--quiet"]) == 1
    assert capsys.readouterr() == ("", "")
    assert json.loads((tmp_path / "out.json").read_text()) == data


def test_fix_writes_the_repaired_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, out = write(tmp_path / "arm.urdf", REPAIRABLE["P106"]), tmp_path / "fixed.urdf"
    assert main(["inspect", path, "--fix", str(out), "--strict"]) == 1
    assert "mended P106 arm" in capsys.readouterr().out
    assert Path(path).read_text() == REPAIRABLE["P106"]
    assert main(["inspect", str(out), "--strict"]) == 0
    assert main(["inspect", path, "--fix", str(tmp_path / "no" / "fixed.urdf")]) == 2


def test_the_table_shows_names_as_they_are(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Brackets in names are no markup."""
    monkeypatch.setenv("COLUMNS", "200")
    text = CASES["P105"][0][0].replace('"arm"', '"[red]arm[/red]"').replace('"swing"', '"[/]"')
    assert main(["inspect", write(tmp_path / "arm.urdf", text)]) == 1
    out = capsys.readouterr().out
    assert "[red]arm[/red]" in out and "[/] (revolute)" in out
    assert "base" in out and "P105" in out and "impossible" in out


def test_long_tables_are_cut_unless_full(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    links = "".join(f'<link name="f{k}">{inertial(-1)}</link>{joint(f"j{k}", "base", f"f{k}")}' for k in range(60))
    path = write(tmp_path / "many.urdf", f'<robot name="many"><link name="base"/>{links}</robot>')
    assert main(["inspect", path]) == 1
    assert "--full" in capsys.readouterr().out
    assert main(["inspect", path, "--full"]) == 1
    out = capsys.readouterr().out
    assert "--full" not in out and all(f"f{k} " in out for k in range(60))


def test_names_deep_in_a_chain_are_whole_at_80_columns() -> None:
    names = [f"link_number_{k}_of_the_arm" for k in range(60)]
    links = "".join(f'<link name="{name}">{inertial()}</link>' for name in names)
    joints = "".join(joint(f"j{k}", names[k], names[k + 1]) for k in range(59))
    lines = look(f'<robot name="chain">{links}{joints}</robot>').summary(full=True, width=80).splitlines()
    assert all(len(line) <= 80 for line in lines)
    assert [line.split()[0] for line in lines if line.startswith("link_number")] == names


def test_branches_are_marked_and_indented() -> None:
    links = "".join(f'<link name="{name}">{inertial()}</link>' for name in "abcd")
    joints = joint("ab", "a", "b") + joint("bc", "b", "c") + joint("ad", "a", "d")
    lines = look(f'<robot name="r">{links}{joints}</robot>').summary().splitlines()
    start = next(k for k, line in enumerate(lines) if line.startswith("link"))
    assert [line[:4].rstrip() for line in lines[start + 1 : start + 5]] == ["a", "- b", "  c", "- d"]


def test_inspecting_a_robot_without_meshes_loads_no_large_library() -> None:
    large = ["scipy", "trimesh", "yourdfpy", "pinocchio", "llvmlite", "flint"]
    program = f"from rttrr_pin.cli import main; import sys; main(['inspect']); print([x for x in {large} if x in sys.modules])"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_a_robot_made_from_numbers_has_no_file_to_inspect() -> None:
    made = Robot(Model("made", Link("base"), (Link("arm"),), (Joint("swing", REVOLUTE),)))
    with pytest.raises(InputError, match="made"):
        inspect(made)


def test_unknown_prefixes_are_refused() -> None:
    with pytest.raises(UnknownNameError):
        inspect(rttrr_pin.load("rttrr"), select=["Q"])
    with pytest.raises(UnknownNameError):
        inspect(rttrr_pin.load("rttrr"), ignore=[""])
    with pytest.raises(UnknownNameError):
        inspect(rttrr_pin.load("rttrr")).verdict("Webots")


def test_a_long_chain_is_no_deep_recursion() -> None:
    n = sys.getrecursionlimit() + 100
    links = "".join(f'<link name="l{k}">{inertial()}</link>' for k in range(n))
    joints = "".join(joint(f"j{k}", f"l{k}", f"l{k + 1}") for k in range(n - 1))
    result = look(f'<robot name="chain">{links}{joints}</robot>')
    assert len(result.links) == n and result.mass == n


HUGE = ["0", "-1", "1e308", "-1e308", "5e-324", "1e-300", "1e154", "1e-18", "0.1", "0.7", "0.8"]


@pytest.mark.slow
@settings(max_examples=200)
@given(st.lists(st.sampled_from(HUGE), min_size=14, max_size=14), st.sampled_from(["box", "sphere", "mesh"]))
def test_no_numbers_break_it(v: list[str], kind: str) -> None:
    """Whatever the strict reader lets pass is inspected, repaired, and written as JSON."""
    tag = {"box": f'<box size="{v[0]} {v[1]} {v[2]}"/>', "sphere": f'<sphere radius="{v[0]}"/>', "mesh": "<mesh/>"}[
        kind
    ]
    inside = inertial(v[3], v[4:10], xyz=f"{v[10]} {v[11]} 0", rpy="1 2 3") + shape(tag, xyz=f"{v[12]} 0 0")
    try:
        robot = rttrr_pin.load(arm(inside, extra=tip(inertial(v[13], v[6:12]))))
    except UrdfError:  # turning a tensor of 1e308 overflows
        return
    result = inspect(robot)
    repair(result)
    assert json.loads(as_json(result.to_dict()))["robot"] == "arm"


# Documentation


def rows_of(page: str, marker: str) -> list[list[str]]:
    """The rows of the table after a marker, without head and rule."""
    table = page.split(f"<!-- {marker} -->\n", 1)[1].split("\n\n", 1)[0]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()[2:]]


def test_the_documented_checks_are_the_checks(repository: Path) -> None:
    page = (repository / "docs" / "inspect.md").read_text()
    assert rows_of(page, "checks") == [[check.id, str(check.severity), check.statement] for check in CHECKS]


def test_the_documented_rules_are_the_rules(repository: Path) -> None:
    page = (repository / "docs" / "inspect.md").read_text()
    expected = [[rule.id, ", ".join(rule.parsers), str(rule.behaviour), rule.reason, rule.source] for rule in RULES]
    assert rows_of(page, "rules") == expected


def test_severities_are_those_of_the_checks() -> None:
    assert {check.severity for check in CHECKS} == set(Severity)


def test_its_representation_counts() -> None:
    assert repr(inspect("rttrr")) == "<Inspection of 'rttrr': 0 errors, 0 warnings, 0 notes>"
