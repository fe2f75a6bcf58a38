"""The reader hands on what the file says, or an error with line, element, value and fix."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rttrr_pin
from chains import EXAMPLES
from rttrr_pin.errors import UnknownNameError, UrdfError
from rttrr_pin.model import JointType
from rttrr_pin.model.sources import LARGEST_FILE

URDF = """<robot name="two">
<link name="base"/>
<link name="arm">
  <inertial>
    <origin xyz="0.1 0.2 0.3" rpy="0 0 0"/>
    <mass value="1.5"/>
    <inertia ixx="0.1" ixy="0.01" ixz="0.02" iyy="0.2" iyz="0.03" izz="0.15"/>
  </inertial>
</link>
<link name="hand"/>
<joint name="turn" type="revolute">
  <parent link="base"/><child link="arm"/>
  <origin xyz="0 0 0.5"/>
  <axis xyz="0 0 2"/>
  <limit lower="-1" upper="1" velocity="2" effort="3"/>
</joint>
<joint name="grip" type="fixed"><parent link="arm"/><child link="hand"/></joint>
</robot>
"""


def test_reads_what_is_written() -> None:
    model = rttrr_pin.load(URDF).model
    link, joint = model.links[0], model.joints[0]
    assert (model.name, model.root.name, model.link_names) == ("two", "base", ("arm", "hand"))
    assert link.mass == 1.5
    assert link.com.tolist() == [0.1, 0.2, 0.3]
    assert link.inertia.tolist() == [[0.1, 0.01, 0.02], [0.01, 0.2, 0.03], [0.02, 0.03, 0.15]]
    assert (joint.type, joint.parent, model.joints[1].parent) == (JointType.REVOLUTE, -1, 0)
    assert joint.p.tolist() == [0, 0, 0.5]
    assert joint.axis.tolist() == [0, 0, 1]
    assert (joint.limits.lower, joint.limits.upper, joint.limits.velocity, joint.limits.effort) == (-1, 1, 2, 3)
    assert model.joint_names == ("turn",)


def test_numbers_of_the_model_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="read-only"):
        rttrr_pin.load(URDF).model.links[0].com[0] = 1.0


def test_a_path_a_string_and_a_name_are_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also from a folder that is not the repository."""
    path = tmp_path / "two.urdf"
    path.write_text(URDF)
    monkeypatch.chdir(tmp_path)
    for source in (URDF, str(path), path, "two.urdf"):
        assert rttrr_pin.load(source).name == "two"
    assert rttrr_pin.load("rttrr").joint_names[0] == "joint_1"


CASES: dict[str, tuple[str, str, str, int | None]] = {
    # id: (what stands in the file, what it becomes, the message, its line)
    "nan": ('value="1.5"', 'value="nan"', "'nan' is not a decimal number", 6),
    "comma": ('value="1.5"', 'value="1,5"', "write a point for the decimals", 6),
    "unit": ('value="1.5"', 'value="1.5kg"', "without its unit", 6),
    "hex": ('value="1.5"', 'value="0x1"', "'0x1' is not a decimal number", 6),
    "underscore": ('value="1.5"', 'value="1_0"', "'1_0' is not a decimal number", 6),
    "xacro": ('value="1.5"', 'value="${m}"', "this is xacro", 6),
    "no-mass-value": ('<mass value="1.5"/>', "<mass/>", "<mass> has no value", 6),
    "overflow": ('value="1.5"', 'value="1e400"', "larger than float64", 6),
    "underflow": ('value="1.5"', 'value="1e-400"', "smaller than float64", 6),
    "two-masses": ('value="1.5"', 'value="1.5 2"', "has 2 values, expected 1", 6),
    "no-mass": ('<mass value="1.5"/>', "", "has no <mass>", 4),
    "mass-twice": ('<mass value="1.5"/>', '<mass value="1.5"/><mass value="2"/>', "has 2 <mass> elements", 4),
    "no-inertia": (
        '<inertia ixx="0.1" ixy="0.01" ixz="0.02" iyy="0.2" iyz="0.03" izz="0.15"/>',
        "",
        "has no <inertia>",
        4,
    ),
    "no-izz": ('izz="0.15"', "", "<inertia> has no izz", 7),
    "short-com": ("0.1 0.2 0.3", "0.1 0.2", "has 2 values, expected 3", 5),
    "degrees": ('rpy="0 0 0"', 'rpy="90deg 0 0"', "'90deg' is not a decimal number", 5),
    "zero-axis": ("0 0 2", "0 0 0", "no direction", 14),
    "no-axis": ('<axis xyz="0 0 2"/>', "", "has no <axis>", 11),
    "inverted-limits": ('lower="-1"', 'lower="7"', "lower limit 7.0 is above the upper one, 1.0", 15),
    "negative-velocity": ('velocity="2"', 'velocity="-2"', "velocity limit is -2.0", 15),
    "type": ('type="revolute"', 'type="revolut"', "'revolut' is not supported: did you mean revolute", 11),
    "no-type": ('type="revolute"', "", "has no type", 11),
    "mimic": ('<origin xyz="0 0 0.5"/>', '<mimic joint="x"/>', "<mimic> is not supported", 11),
    "same-link": ('<link name="hand"/>', '<link name="arm"/>', 'link "arm": the name stands 2 times', 3),
    "same-joint": ('name="grip"', 'name="turn"', 'joint "turn": the name stands 2 times', 11),
    "no-name": ('<link name="hand"/>', "<link/>", "<link> has no name", 10),
    "no-robot-name": ('name="two"', "", "<robot> has no name", 1),
    "unknown-child": (
        '<child link="hand"/>',
        '<child link="hond"/>',
        "child link 'hond' does not exist: did you mean hand",
        17,
    ),
    "no-parent": ('<parent link="arm"/>', "", "has no <parent>", 17),
    "two-parents": ('<child link="hand"/>', '<child link="arm"/>', "'arm' is already the child of another joint", 17),
    "loop": ('<parent link="base"/>', '<parent link="hand"/>', "a loop of joints|root links", None),
    "two-roots": ('<link name="hand"/>', '<link name="hand"/><link name="other"/>', "has 2 root links", 1),
    "doctype": ('<robot name="two">', '<!DOCTYPE robot><robot name="two">', "document type", None),
    "bomb": ('<robot name="two">', '<!DOCTYPE r [<!ENTITY a "b">]><robot name="&a;">', "document type|entity", None),
    "not-closed": ("</robot>", "", "is no well-formed XML", None),
    "other-root": ("robot", "sdf", "outermost element is <sdf>", 1),
}


@pytest.mark.parametrize("case", CASES)
def test_damage_is_refused_with_its_line(case: str) -> None:
    old, new, message, line = CASES[case]
    assert old in URDF
    with pytest.raises(UrdfError, match=message) as caught:
        rttrr_pin.load(URDF.replace(old, new))
    assert line is None or caught.value.line == line
    assert "<string>" in str(caught.value)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is empty"),
        (b" \n", "is empty"),
        (b"\x00\xff\xfe", "no well-formed XML"),
        (URDF[:200].encode(), "no well-formed XML"),
    ],
    ids=["empty", "blank", "binary", "truncated"],
)
def test_files_that_are_no_urdf(tmp_path: Path, content: bytes, message: str) -> None:
    path = tmp_path / "x.urdf"
    path.write_bytes(content)
    with pytest.raises(UrdfError, match=message) as caught:
        rttrr_pin.load(path)
    assert caught.value.source == str(path)


def test_a_huge_file_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "huge.urdf"
    with path.open("wb") as file:
        file.truncate(LARGEST_FILE + 1)
    with pytest.raises(UrdfError, match="64 MiB"):
        rttrr_pin.load(path)


def test_folders_and_missing_files(tmp_path: Path) -> None:
    with pytest.raises(UrdfError, match="is a folder"):
        rttrr_pin.load(tmp_path)
    with pytest.raises(UnknownNameError, match="did you mean.*rttrr"):
        rttrr_pin.load("rttr")


def test_links_come_in_chain_order_whatever_the_order_in_the_file() -> None:
    """As Pinocchio has them."""
    text = EXAMPLES["any-axes"]
    head, *elements = text.replace("<link", "\n<link").replace("<joint", "\n<joint").replace("</robot>", "").split("\n")
    shuffled = head + "".join(np.random.default_rng(0).permutation(np.array(elements, dtype=object))) + "</robot>"
    assert rttrr_pin.load(shuffled).link_names == rttrr_pin.load(text).link_names
