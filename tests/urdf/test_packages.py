"""Packages are found without ROS: by package.xml, upwards and beside, by name, and in ROS_PACKAGE_PATH."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

import rttrr_pin
from rttrr_pin.cli import program
from rttrr_pin.core.solids import Capsule, Cylinder, Sphere
from rttrr_pin.errors import InputError, UrdfError
from rttrr_pin.inspection.shapes import find_mesh
from rttrr_pin.urdf.packages import find_package, forget_packages
from support.inspected import arm, inertial, shape

XACRO = """<robot name="top" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:include filename="$(find {package})/urdf/parts.xacro"/>
<xacro:parts/>
</robot>
"""
PARTS = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:macro name="parts"><link name="base"/></xacro:macro>
</robot>
"""


@pytest.fixture(autouse=True)
def without_ros(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH"):
        monkeypatch.delenv(name, raising=False)
    forget_packages()


def package(folder: Path, name: str | None = None) -> Path:
    """A package that is called otherwise than its folder, if a name is given."""
    (folder / "urdf").mkdir(parents=True)
    (folder / "urdf" / "parts.xacro").write_text(PARTS)
    (folder / "package.xml").write_text(f'<package format="2">\n<name> {name or folder.name} </name></package>')
    return folder


@pytest.mark.parametrize("place", ["ws/src/arm", "ws/src/group/arm", "ws/arm", "arm"])
@pytest.mark.parametrize("name", ["arm", "arm_description"])
def test_packages_are_found_upwards_and_beside(tmp_path: Path, place: str, name: str) -> None:
    start = tmp_path / "ws" / "src" / "robot" / "urdf"
    start.mkdir(parents=True)
    wanted = package(tmp_path / place, name)
    assert find_package(name, start, {}) == wanted
    assert find_package(name, wanted / "urdf", {}) == wanted
    assert find_package("nowhere", start, {}) is None


def test_a_manifest_is_better_than_a_name(tmp_path: Path) -> None:
    (tmp_path / "hand").mkdir()
    assert find_package("hand", tmp_path, {}) == tmp_path / "hand"
    forget_packages()
    wanted = package(tmp_path / "else", "hand")
    assert find_package("hand", tmp_path, {}) == wanted


def test_the_nearest_is_taken(tmp_path: Path) -> None:
    """A folder of the name above the file, before another repository's package; but not before one that it holds."""
    package(tmp_path / "other" / "arm")
    start = tmp_path / "mine" / "arm" / "urdf"
    start.mkdir(parents=True)
    assert find_package("arm", start, {}) == start.parent
    forget_packages()
    wanted = package(tmp_path / "mine" / "arm" / "ros" / "arm")
    assert find_package("arm", start, {}) == wanted


@pytest.mark.parametrize("name", ["", ".", "..", "a/b", "../arm", "x" * 300, "a\0b", "a\\b"])
def test_odd_names_find_nothing(tmp_path: Path, name: str) -> None:
    package(tmp_path / "arm")
    assert find_package(name, tmp_path / "arm" / "urdf", {}) is None


def test_packages_of_ros(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    start = tmp_path / "somewhere" / "1" / "2" / "3" / "4" / "5" / "6" / "7" / "8"
    start.mkdir(parents=True)
    catkin, ament = package(tmp_path / "catkin" / "src" / "arm"), package(tmp_path / "install" / "share" / "leg")
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"/nowhere:{tmp_path / 'catkin' / 'src'}")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "install"))
    assert find_package("arm", start, {}) == catkin and find_package("leg", start, {}) == ament
    other = package(tmp_path / "other")
    assert find_package("arm", start, {"arm": other}) == other
    assert find_package("gone", start, {}) is None


def test_xacro_finds_packages(tmp_path: Path) -> None:
    package(tmp_path / "parts", "parts_description")
    top = tmp_path / "robot" / "urdf" / "top.urdf.xacro"
    top.parent.mkdir(parents=True)
    top.write_text(XACRO.format(package="parts_description"))
    assert rttrr_pin.load(top, xacro=True).name == "top"
    top.write_text(XACRO.format(package="missing"))
    with pytest.raises(UrdfError, match="--package missing=FOLDER"):
        rttrr_pin.load(top, xacro=True)
    assert rttrr_pin.load(top, xacro=True, packages={"missing": tmp_path / "parts"}).name == "top"
    with pytest.raises(InputError, match="is no folder"):
        rttrr_pin.load(top, xacro=True, packages={"missing": tmp_path / "nowhere"})


def test_a_package_that_is_named_finds_those_beside_it(tmp_path: Path) -> None:
    """The folder of another repository is named once, and its files include one another."""
    parts = package(tmp_path / "other" / "repository" / "parts")
    package(tmp_path / "other" / "repository" / "group" / "links")
    (parts / "urdf" / "parts.xacro").write_text(XACRO.format(package="links").replace("<xacro:parts/>", ""))
    top = tmp_path / "a" / "b" / "c" / "d" / "e" / "f" / "g" / "h" / "top.xacro"
    top.parent.mkdir(parents=True)
    top.write_text(XACRO.format(package="parts"))
    assert rttrr_pin.load(top, xacro=True, packages={"parts": parts}).name == "top"


NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
IN_VAIN = {
    "packages": (
        '<xacro:include filename="$(find one_in_vain)/a.xacro"/><xacro:include filename="$(find two_in_vain)/b.xacro"/>',
        (
            "'one_in_vain' or 'two_in_vain'",
            "package.xml",
            "ROS_PACKAGE_PATH",
            "--package one_in_vain=FOLDER --package two_in_vain=FOLDER",
        ),
    ),
    "arguments": (
        '<xacro:arg name="set" default="1"/><link name="$(arg side)"/><link name="$(arg dof)_$(arg set)_$(arg given)"/>',
        ("no value for side, dof;", "--xacro-arg side:=VALUE --xacro-arg dof:=VALUE"),
    ),
    "file": ('<xacro:include filename="gone.xacro"/>', ("gone.xacro: No such file", "--package")),
    "folder": ('<xacro:include filename="$(find here)/gone.xacro"/>', ("gone.xacro: No such file",)),
    "folder for a file": ('<xacro:include filename="$(find here)"/>', ("Is a directory", "--xacro-arg")),
    "part": ('<xacro:macro name="arm"><link name="x"/></xacro:macro>', ("has no <link>", "the file that includes it")),
}
"""What a xacro file asks for in vain, and what is said of it: all that is missing, and the options."""


@pytest.mark.parametrize("case", IN_VAIN)
def test_what_a_xacro_file_asks_for_in_vain_is_told_at_once(tmp_path: Path, case: str) -> None:
    body, words = IN_VAIN[case]
    package(tmp_path / "here")
    top = tmp_path / "robot" / "top.xacro"
    top.parent.mkdir()
    top.write_text(f'<robot name="r" {NAMESPACE}>{body}</robot>')
    with pytest.raises(UrdfError) as caught:
        rttrr_pin.load(top, xacro_args={"given": 1})
    message = str(caught.value)
    assert all(word in message for word in words), message
    assert message.count("gone.xacro") <= 1 and "<class" not in message
    assert case != "packages" or str(top.parent) in message


def test_meshes_are_found_in_packages(tmp_path: Path) -> None:
    mesh = package(tmp_path / "parts", "parts_description") / "meshes" / "arm.stl"
    mesh.parent.mkdir()
    mesh.write_text("solid x\nendsolid x\n")
    start = tmp_path / "robot" / "urdf"
    start.mkdir(parents=True)
    assert find_mesh("package://parts_description/meshes/arm.stl", start) == mesh
    assert find_mesh("package://other/meshes/arm.stl", start) is None
    assert find_mesh("package://other/meshes/arm.stl", None, {"other": tmp_path / "parts"}) == mesh


@pytest.mark.parametrize("folder", ["", "file", "none", "~nobody_of_that_name", "x" * 300, "a\0b", 5], ids=repr)
def test_what_is_no_folder_of_a_package_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, folder: str
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.chdir(tmp_path)
    if folder:
        with pytest.raises(InputError, match=r"package 'x': .* is no folder; pass the one that holds its package.xml"):
            rttrr_pin.load("rttrr", packages={"x": folder})
    with pytest.raises(InputError, match=r"packages is a list: pass a dict, such as"):
        rttrr_pin.load("rttrr", packages=[folder])  # type: ignore[arg-type]


def test_the_command_line_takes_packages(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(arm(inertial()))
    for command in (["inspect"], ["derive", "-q"], ["validate", "-q", "--states", "3", "--subject", "recursion"]):
        run = CliRunner().invoke(program, [*command, str(path), "--package", f"x={tmp_path}"], standalone_mode=False)
        assert run.exception is None, run.exception
        run = CliRunner().invoke(program, [*command, str(path), "--package", "x"], standalone_mode=False)
        assert isinstance(run.exception, InputError) and "NAME=FOLDER" in str(run.exception)


def test_capsules_are_looked_at() -> None:
    """A cylinder with half a ball on each end: between the cylinder and the ball, and both in the limits."""
    capsule = Capsule(0.1, 0.4)
    assert capsule.volume == pytest.approx(Cylinder(0.1, 0.4).volume + Sphere(0.1).volume)
    assert Capsule(0.1, 1e-9).specific_inertia() == pytest.approx(Sphere(0.1).specific_inertia(), rel=1e-6)
    assert Capsule(1e-6, 0.4).specific_inertia()[0, 0] == pytest.approx(0.4**2 / 12, rel=1e-4)
    text = arm(inertial(1, (4, 0, 0, 4, 0, 4)) + shape('<capsule radius="0.1" length="0.4"/>'))
    findings = rttrr_pin.inspect(rttrr_pin.load(text)).findings
    assert "G201" in {finding.id for finding in findings}
