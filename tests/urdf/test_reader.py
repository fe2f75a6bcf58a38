"""The reader hands on what the file says, or an error with line, element, value and fix."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin.core.joints import REVOLUTE
from rttrr_pin.errors import UnknownNameError, UrdfError
from rttrr_pin.urdf.sources import LARGEST_FILE
from support.serial_chains import EXAMPLES
from support.tolerances import MODEL, norm_error

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
    assert (joint.type, joint.parent, model.joints[1].parent) == (REVOLUTE, -1, 0)
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
    "mimic-unknown": (
        '<origin xyz="0 0 0.5"/>',
        '<mimic joint="tern"/>',
        "follows joint 'tern', which does not exist: did you mean turn",
        13,
    ),
    "mimic-itself": ('<origin xyz="0 0 0.5"/>', '<mimic joint="turn"/>', "follows itself through turn -> turn", 13),
    "mimic-fixed": (
        '<origin xyz="0 0 0.5"/>',
        '<mimic joint="grip"/>',
        "joint 'grip' is fixed: only joints with one coordinate",
        13,
    ),
    "mimic-number": (
        '<origin xyz="0 0 0.5"/>',
        '<mimic joint="turn" multiplier="1,5"/>',
        "'1,5' is not a decimal number",
        13,
    ),
    "damping-unit": ('<origin xyz="0 0 0.5"/>', '<dynamics damping="1Nms"/>', "'1Nms' is not a decimal number", 13),
    "friction-sign": (
        '<origin xyz="0 0 0.5"/>',
        '<dynamics friction="-1"/>',
        "friction is -1: expected a number that is not",
        13,
    ),
    "same-link": ('<link name="hand"/>', '<link name="arm"/>', 'link "arm": the name stands 2 times', 3),
    "same-joint": ('name="grip"', 'name="turn"', 'joint "turn": the name stands 2 times', 11),
    "no-name": ('<link name="hand"/>', "<link/>", "<link> has no name", 10),
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
    with pytest.raises(UrdfError, match="16 MiB"):
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


MISSED: dict[str, tuple[str, str, str, int]] = {
    # What parsers skip or misread without a sound: most were found by tests/fuzz.
    "arabic-digits": ('value="1.5"', 'value="\u0661\u0665"', "'\u0661\u0665' is not a decimal number", 6),
    "no-break-space": ("0.1 0.2 0.3", "0.1\u00a00.2 0.3", "has 2 values, expected 3", 5),
    "blank-value": ('value="1.5"', 'value="\u2003"', "has 0 values, expected 1", 6),
    "long-value": ('value="1.5"', f'value="{"1" * 10**5}"', r"has more than 2,000 characters", 6),
    "misspelt-inertial": ("inertial>", "inertail>", "<inertail> has no place in <link>: did you mean inertial", 4),
    "capital-element": ("<mass", "<Mass", "<Mass> has no place in <inertial>: did you mean mass", 6),
    "capital-link-in-a-link": ('<link name="hand"/>', '<link name="hand"><Link/></link>', "<Link> has no place", 10),
    "link-in-a-link": ('<link name="hand"/>', '<link name="hand"><link name="x"/></link>', "no place in <link>", 10),
    "mass-in-a-link": ('<link name="hand"/>', '<link name="hand"><mass value="1"/></link>', "no place in <link>", 10),
    "link-in-a-group": (
        '<link name="hand"/>',
        '<link name="hand"/><group><link name="x"><inertial/></link></group>',
        "<link> stands in <group>: move it up",
        10,
    ),
    "namespace": (
        '<link name="hand"/>',
        '<link name="hand"/><x:link xmlns:x="urn:x" name="x"/>',
        "has no place in <robot>: write it without a namespace",
        10,
    ),
    "xinclude": (
        '<link name="hand"/>',
        '<link name="hand"/><i:include xmlns:i="http://www.w3.org/2001/XInclude" href="x"/>',
        "is an XInclude",
        10,
    ),
    "attribute": ('xyz="0 0 0.5"', 'xzy="0 0 0.5"', "<origin> has an attribute xzy: expected xyz, rpy", 13),
    "quaternion": ('xyz="0 0 0.5"', 'quat_xyzw="1 0 0 0"', "<origin> has an attribute quat_xyzw", 13),
    "misspelt-limit": ('upper="1"', 'uper="1"', "<limit> has an attribute uper: did you mean upper", 15),
    "value-as-text": ('<mass value="1.5"/>', "<mass>1.5</mass>", "<mass> holds the text '1.5'", 6),
    "tensor-overflow": (
        URDF[URDF.index('rpy="') : URDF.index("</inertial>")],
        'rpy="0.7 0.7 0"/><mass value="1"/><inertia ixx="1.7e308" ixy="-1.7e308" ixz="0" iyy="1.7e308" iyz="0" izz="0"/>',
        "too large or too small to compute with",
        3,
    ),
    "limit-above-the-default": (
        'lower="-1" upper="1"',
        'lower="0.5"',
        "lower limit 0.5 is above the upper one, 0.0",
        15,
    ),
}


@pytest.mark.parametrize("case", MISSED)
def test_what_parsers_skip_is_refused_with_its_line(case: str) -> None:
    old, new, message, line = MISSED[case]
    assert old in URDF
    with pytest.raises(UrdfError, match=message) as caught:
        rttrr_pin.load(URDF.replace(old, new))
    assert caught.value.line == line
    assert len(str(caught.value)) < 1000


def test_the_line_of_a_document_type_is_found_behind_comments() -> None:
    text = "<!-- <!DOCTYPE robot>\n -->\n<!DOCTYPE robot>\n" + URDF
    with pytest.raises(UrdfError, match="remove <!DOCTYPE") as caught:
        rttrr_pin.load(text)
    assert caught.value.line == 3
    assert rttrr_pin.load(text.replace("\n<!DOCTYPE robot>\n", "")).name == "two"


@pytest.mark.parametrize("many", ["<!-- a -- b -->\n", "<gazebo><a:b/></gazebo>\n"])
def test_what_stands_behind_many_faults_is_seen(many: str) -> None:
    """libxml2 tells a hundred errors and no more: a comment that never ends, behind them, would end the robot."""
    text = URDF.replace('<link name="hand"/>', many * 150 + '<link name="hand"/>')
    assert rttrr_pin.load(text).link_names == rttrr_pin.load(URDF).link_names
    assert len(rttrr_pin.load(text).model.joints) == len(rttrr_pin.load(URDF).model.joints)
    for wrong in ("<!--<!--", "<![CDATA["):
        with pytest.raises(UrdfError, match="well-formed"):
            rttrr_pin.load(text.replace('<link name="hand"/>', wrong + '<link name="hand"/>'))


def test_external_entities_are_never_opened(tmp_path: Path) -> None:
    """Opening the pipe would wait for a writer for ever."""
    os.mkfifo(tmp_path / "pipe")
    for declared in (f'<!ENTITY a SYSTEM "{tmp_path / "pipe"}">', f'<!ENTITY % a SYSTEM "{tmp_path / "pipe"}">%a;'):
        for text in (URDF, URDF.replace("</robot>", "&a;</robot>")):
            with pytest.raises(UrdfError):
                rttrr_pin.load(f"<!DOCTYPE robot [{declared}]>{text}")
    with pytest.raises(UrdfError):
        rttrr_pin.load(f'<!DOCTYPE robot SYSTEM "{tmp_path / "pipe"}">{URDF}')


def test_extensions_are_let_through() -> None:
    """What other programs keep in a URDF, and what enters no dynamics, whatever it says."""
    more = (
        '<gazebo reference="arm"><link name="x"><inertial/></link><mu1>0.5</mu1></gazebo>'
        '<transmission name="t"><type>x</type><joint name="turn"><hardwareInterface>y</hardwareInterface></joint></transmission>'
        '<material name="m"><color rgba="nope"/></material><?processing instruction?>'
    )
    link = '<visual><origin rpy="nan 0 0"/><geometry><box size="1m"/></geometry></visual><contact><friction value="1"/></contact>'
    text = URDF.replace("</robot>", f"{more}</robot>").replace(
        '<link name="hand"/>', f'<link name="hand">{link}</link>'
    )
    text = text.replace('effort="3"', 'effort="3" gear_velocity="10" current="1"')
    text = text.replace("<axis", '<safety_controller k_velocity="x"/><calibration rising="y"/><axis')
    assert rttrr_pin.load(text).link_names == ("arm", "hand")


def test_limits_left_out_are_those_of_the_format() -> None:
    """URDF: lower and upper default to 0; without <limit> there is none."""
    limits = rttrr_pin.load(URDF.replace('upper="1" ', "")).model.joints[0].limits
    assert (limits.lower, limits.upper) == (-1.0, 0.0)
    limits = (
        rttrr_pin.load(URDF.replace('<limit lower="-1" upper="1" velocity="2" effort="3"/>', "")).model.joints[0].limits
    )
    assert (limits.lower, limits.upper, limits.velocity) == (-np.inf, np.inf, np.inf)


def test_axes_of_any_length_are_normalised() -> None:
    for axis in ("0 0 1e300", "0 0 1e-300", "0 0 4.9e-324", "0 0 1.7e308"):
        assert rttrr_pin.load(URDF.replace("0 0 2", axis)).model.joints[0].axis.tolist() == [0, 0, 1]
    axis = rttrr_pin.load(URDF.replace("0 0 2", "3e200 0 4e200")).model.joints[0].axis
    assert norm_error(axis, [0.6, 0.0, 0.8]) <= MODEL


def test_lines_are_right_far_down_the_file() -> None:
    """libxml2 counts lines in 16 bits, and beyond takes the line of the text behind the element."""
    for more, off in ((60_000, 0), (70_000, 1)):
        text = URDF.replace('<link name="hand"/>', "\n" * more + '<link name="hand"/>').replace("0 0 2", "0 0 0")
        with pytest.raises(UrdfError, match="no direction") as caught:
            rttrr_pin.load(text)
        assert caught.value.line == 14 + more + off


def test_large_robots_are_read_in_linear_time() -> None:
    """A quadratic step over 3000 links, the root last, would take minutes."""
    count = 3000
    links = "".join(f'<link name="l{i}"/>' for i in range(1, count)) + '<link name="l0"/>'
    joints = "".join(
        f'<joint name="j{i}" type="fixed"><parent link="l{i}"/><child link="l{i + 1}"/></joint>'
        for i in range(count - 1)
    )
    assert len(rttrr_pin.load(f'<robot name="long">{links}{joints}</robot>').link_names) == count - 1


def test_long_attributes_are_read_in_linear_time() -> None:
    """A regular expression that tries every split of these digits would take minutes."""
    with pytest.raises(UrdfError, match="is not a decimal number"):
        rttrr_pin.load(URDF.replace('value="1.5"', f'value="{"9" * 10**6}x"'))


def test_long_chains_of_followers_are_refused() -> None:
    """To follow each of them to its end would take time with the cube of their number: minutes, found by fuzzing."""
    count = 2500
    links = "".join(f'<link name="l{i}"/>' for i in range(count + 1))
    joints = "".join(
        f'<joint name="j{i}" type="revolute"><parent link="l0"/><child link="l{i + 1}"/><axis xyz="0 0 1"/>'
        f'{f"""<mimic joint="j{i - 1}"/>""" if i else ""}</joint>'
        for i in range(count)
    )
    with pytest.raises(UrdfError, match="through more than 100 joints"):
        rttrr_pin.load(f'<robot name="many">{links}{joints}</robot>')
