"""Where robots come from: every source gives the same robot, and what is none says so."""

from __future__ import annotations

import errno
import math
import os
import sys
import time
from importlib import metadata
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
import pytest
import yourdfpy

import rttrr_pin
from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError, LoadWarning, RttrrError, UnknownNameError, UrdfError
from rttrr_pin.urdf import catalogue, files, sources
from rttrr_pin.urdf.yourdfpy_object import as_urdf
from support.serial_chains import EXAMPLES, random_chain

CHAIN = EXAMPLES["any-axes"]

XACRO = """<?xml version="1.0"?>
<robot name="two" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="m" value="{mass}"/>
  <xacro:macro name="body" params="name">
    <link name="${{name}}">
      <inertial><mass value="${{m}}"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="${{0.1 + 0.2}}" iyz="0" izz="0.2"/></inertial>
    </link>
  </xacro:macro>
  <link name="base"/>
  <xacro:body name="arm"/>
  <joint name="j" type="continuous">
    <parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>{more}
  </joint>
</robot>
"""


def numbers_of(model: Model) -> list[Any]:
    """Everything a model says, in one comparable list; rotations apart."""
    found: list[Any] = [model.name, model.root.name, *model.link_names]
    for link in (model.root, *model.links):
        found += [link.mass, *link.com]
        found += [] if link.rotated else link.inertia.ravel().tolist()
    for joint in model.joints:
        found += [joint.name, joint.type, joint.parent, *joint.p, *joint.axis, joint.limits, joint.mimic, joint.effects]
    return found


# Paths and folders --------------------------------------------------------------------------------------------------


def test_a_bundled_name_wins_over_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "rttrr").write_text(CHAIN)
    monkeypatch.chdir(tmp_path)
    assert rttrr_pin.load("rttrr").name == "rttrr"
    assert rttrr_pin.load("./rttrr").name == "chain_1"
    assert rttrr_pin.load(Path("rttrr")).name == "chain_1"


def test_bundled_robots_are_found_in_a_checkout_and_in_a_wheel(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, repository: Path
) -> None:
    in_checkout = catalogue.bundled()
    assert set(in_checkout) == {path.stem for path in (repository / "urdf").glob("*.urdf")}
    (tmp_path / "robots").mkdir()
    (tmp_path / "robots" / "mine.urdf").write_text(CHAIN)
    monkeypatch.setattr(catalogue, "__file__", str(tmp_path / "model" / "catalogue.py"))
    monkeypatch.setattr(catalogue, "bundled", catalogue.bundled.__wrapped__)
    assert set(catalogue.bundled()) == {"mine"}
    assert rttrr_pin.load("mine").name == "chain_1"


def test_a_folder_with_one_robot_is_that_robot(tmp_path: Path) -> None:
    below = tmp_path / "my_description" / "urdf"
    below.mkdir(parents=True)
    (below / "arm.URDF").write_text(CHAIN)
    (tmp_path / ".hidden").mkdir()
    (tmp_path / ".hidden" / "old.urdf").write_text("no URDF")
    (tmp_path / "mesh.stl").write_text("no URDF")
    assert rttrr_pin.load(tmp_path).name == "chain_1"
    assert rttrr_pin.load(str(below)).name == "chain_1"


def test_a_folder_with_several_lists_them_and_load_all_loads_them(tmp_path: Path) -> None:
    (tmp_path / "more").mkdir()
    for place, seed in (("b.urdf", 1), ("a.urdf", 2), ("more/c.urdf", 3)):
        (tmp_path / place).write_text(random_chain(seed, ("revolute",)))
    with pytest.raises(UrdfError, match=r"3 robots \(a.urdf, b.urdf, more/c.urdf\).*load_all"):
        rttrr_pin.load(tmp_path)
    robots = rttrr_pin.load_all(tmp_path, gravity=(0, 0, 0))
    assert {place: robot.name for place, robot in robots.items()} == {
        "a.urdf": "chain_2",
        "b.urdf": "chain_1",
        "more/c.urdf": "chain_3",
    }
    assert all(not robot.model.gravity.any() for robot in robots.values())
    (tmp_path / "broken.urdf").write_text("<robot")
    with pytest.raises(UrdfError, match=r"broken\.urdf"):
        rttrr_pin.load_all(tmp_path)


def test_folders_without_robots_say_so(tmp_path: Path) -> None:
    for function in (rttrr_pin.load, rttrr_pin.load_all):
        with pytest.raises(UrdfError, match="without a .urdf or .xacro file"):
            function(tmp_path)
    with pytest.raises(UrdfError, match="is no folder"):
        rttrr_pin.load_all(tmp_path / "none")


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("", "is empty"),
        (" \n", "is empty"),
        ("none.urdf", "no bundled robot or file is called 'none.urdf'"),
        ("x" * 5000, r"cannot be read: File name too long"),
        ("a\0b", "no bundled robot or file|cannot be read"),
        ("~nobody_of_that_name/x.urdf", "cannot be read|no bundled robot or file"),
        ("arm:\n<robot name='x'/>", "starts with other text"),
        ("<robot name='\ud800'/>", "half a character"),
        (5, "is a int, expected a name, a path"),
        (None, "is a NoneType"),
        (b"<robot/>", "is a bytes"),
    ],
    ids=lambda value: repr(value)[:20],
)
def test_what_is_no_source_is_refused_in_words(source: Any, message: str) -> None:
    with pytest.raises(RttrrError, match=message) as caught:
        rttrr_pin.load(source)
    assert len(str(caught.value)) < 1000


def test_an_endless_file_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sources, "LARGEST_FILE", 2**20)
    with pytest.raises(UrdfError, match="more than 1 MiB"):
        rttrr_pin.load("/dev/zero")


@pytest.mark.parametrize("name", ["pipe.urdf", "pipe.xml", "pipe.xacro"])
def test_a_pipe_that_stays_silent_is_given_up(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "PATIENCE", 0.1)
    os.mkfifo(tmp_path / name)
    with pytest.raises(UrdfError, match="does not come within"):
        rttrr_pin.load(tmp_path / name)


def test_a_file_that_is_shut_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As for a user who may not read it; root may read everything."""
    path = tmp_path / "x.urdf"
    path.write_text(CHAIN)

    def shut(*arguments: object, **options: object) -> None:
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr(sources, "read_limited", shut)
    with pytest.raises(UrdfError, match="Permission denied"):
        rttrr_pin.load(path)


# Encodings ----------------------------------------------------------------------------------------------------------


def test_a_text_is_a_text_whatever_encoding_it_declares() -> None:
    """A string has no bytes left to be misread."""
    text = CHAIN.replace('"base"', '"b\u00e4se"')
    for encoding in ("utf-8", "latin-1", "utf-16"):
        assert rttrr_pin.load(f'<?xml version="1.0" encoding="{encoding}"?>{text}').model.root.name == "b\u00e4se"


def test_files_are_utf_8_or_refused(tmp_path: Path) -> None:
    """Pinocchio reads every file as UTF-8, so another encoding would mean another robot to it."""
    path = tmp_path / "x.urdf"
    head, text = '<?xml version="1.0" encoding="{}"?>\n', CHAIN.replace('"base"', '"b\u00e4se"')
    path.write_bytes(b"\xef\xbb\xbf" + text.encode())
    assert rttrr_pin.load(path).model.root.name == "b\u00e4se"
    path.write_bytes((head.format("latin-1") + text).encode("latin-1"))
    with pytest.raises(UrdfError, match="line 2: .*0xe4 is not UTF-8"):
        rttrr_pin.load(path)
    path.write_bytes((head.format("latin-1") + text).encode())
    with pytest.raises(UrdfError, match="declares the encoding latin-1"):
        rttrr_pin.load(path)
    path.write_bytes((head.format("latin-1") + CHAIN).encode())
    assert rttrr_pin.load(path).model.root.name == "base"


# Example robots -----------------------------------------------------------------------------------------------------


class FakeFile(PurePosixPath):
    """A file of an installed package, as importlib.metadata lists it."""

    top = Path()

    def locate(self) -> Path:
        return self.top / self


@pytest.fixture
def example_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package of example robots with two robots of one name."""
    robots = "cmeel.prefix/share/example-robot-data/robots"
    places = (
        f"{robots}/panda_description/urdf/panda.urdf",
        f"{robots}/dog_b_description/robots/dog.urdf",
        f"{robots}/dog_c_description/urdf/dog.urdf",
        f"{robots}/panda_description/srdf/panda.srdf",
    )
    for seed, place in enumerate(places):
        (tmp_path / place).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / place).write_text(random_chain(seed, ("revolute",)))
    monkeypatch.setattr(FakeFile, "top", tmp_path)
    monkeypatch.setattr(metadata, "files", lambda name: [FakeFile(place) for place in places])
    monkeypatch.setattr(catalogue, "examples", catalogue.examples.__wrapped__)
    return tmp_path


@pytest.mark.usefixtures("example_package")
def test_example_robots_go_by_their_file_and_where_need_be_their_folder() -> None:
    assert list(catalogue.examples()) == ["dog_b/dog", "dog_c/dog", "panda"]
    assert rttrr_pin.load("example:panda").name == "chain_0"
    assert rttrr_pin.load("example:panda/panda").name == "chain_0"  # the long name always works
    assert rttrr_pin.load("example:dog_c/dog").name == "chain_2"


@pytest.mark.usefixtures("example_package")
def test_unknown_example_robots_list_the_nearest() -> None:
    with pytest.raises(UnknownNameError, match="did you mean panda"):
        rttrr_pin.load("example:pandas")
    with pytest.raises(UnknownNameError, match="dog_b/dog") as caught:
        rttrr_pin.load("example:dog")
    assert caught.value.known == ("dog_b/dog", "dog_c/dog")


def test_without_the_package_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> Any:
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "files", missing)
    monkeypatch.setattr(catalogue, "examples", catalogue.examples.__wrapped__)
    with pytest.raises(InputError, match=r"pip install 'rttrr-pin\[robots\]'"):
        rttrr_pin.load("example:panda")


@pytest.mark.robots
def test_every_example_robot_loads_or_says_where_it_is_wrong() -> None:
    known = catalogue.examples()
    assert "example_robot_data" not in sys.modules
    refused = {}
    for name in known:
        try:
            assert rttrr_pin.load(f"example:{name}").model.root.name
        except UrdfError as error:
            refused[name] = error.line
    assert all(refused.values())
    assert len(refused) <= len(known) // 10


# xacro --------------------------------------------------------------------------------------------------------------


def test_xacro_is_expanded(tmp_path: Path) -> None:
    (tmp_path / "two.urdf.xacro").write_text(XACRO.format(mass=1.5, more=""))
    for source in (tmp_path / "two.urdf.xacro", str(tmp_path / "two.urdf.xacro"), tmp_path):
        link = rttrr_pin.load(source, xacro=True).model.links[0]
        assert (link.name, link.mass, link.inertia[1, 1]) == ("arm", 1.5, 0.1 + 0.2)


@pytest.mark.parametrize(
    ("mass", "more", "message"),
    [
        ("1.5kg", "", r"two.xacro \(as xacro expands it\), line \d+: link \"arm\": .*without its unit"),
        ("1.5", "${nope}", "two.xacro: xacro cannot expand it: name 'nope' is not defined"),
        (
            "1.5",
            '<xacro:include filename="none.xacro"/>',
            "xacro cannot expand it: it reads .*none.xacro: No such file",
        ),
        ("1.5", '<origin xyz="$(arg x) 0 0"/>', "add --xacro-arg x:=VALUE"),
        ("1.5", "<unclosed>", "xacro cannot expand it: mismatched tag"),
        ("1.5", '<xacro:macro name="r" params=""><xacro:r/></xacro:macro><xacro:r/>', "calls itself without end"),
    ],
    ids=["unit", "name", "include", "argument", "xml", "recursion"],
)
def test_what_xacro_cannot_do_is_a_urdf_error(mass: str, more: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "two.xacro"
    path.write_text(XACRO.format(mass=mass, more=more))
    with pytest.raises(UrdfError, match=message):
        rttrr_pin.load(path, xacro=True)


def test_without_xacro_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "xacro", None)
    (tmp_path / "two.xacro").write_text(XACRO.format(mass=1.5, more=""))
    with pytest.raises(UrdfError, match=r"pip install 'rttrr-pin\[xacro\]'"):
        rttrr_pin.load(tmp_path / "two.xacro", xacro=True)


def test_xacro_that_was_not_expanded_is_refused() -> None:
    with pytest.raises(UrdfError, match=r"<xacro:body> is xacro, which must be expanded"):
        rttrr_pin.load(XACRO.format(mass=1.5, more=""))


# Objects of yourdfpy ------------------------------------------------------------------------------------------------


UNTOLD = pytest.mark.filterwarnings("ignore:.*yourdfpy keeps nothing:rttrr_pin.errors.LoadWarning")


def parsed(text: str, tmp_path: Path) -> yourdfpy.URDF:
    path = tmp_path / "robot.urdf"
    path.write_text(text)
    return yourdfpy.URDF.load(str(path), load_meshes=False, build_scene_graph=False)


@pytest.mark.parametrize("source", ["rttrr", *EXAMPLES])
@UNTOLD
def test_a_yourdfpy_object_is_the_same_robot_to_the_last_bit(source: str, tmp_path: Path) -> None:
    wanted = rttrr_pin.load(EXAMPLES.get(source, source), friction=True).model
    got = rttrr_pin.load(parsed(wanted.urdf, tmp_path), friction=True).model
    assert numbers_of(got) == numbers_of(wanted)
    for ours, theirs in zip((*got.joints, *got.links), (*wanted.joints, *wanted.links), strict=True):
        for name in ("R", "inertia"):
            if hasattr(ours, name):
                x, y = getattr(ours, name), getattr(theirs, name)
                assert np.abs(x - y).max() <= 64 * np.finfo(float).eps * max(1.0, np.abs(y).max())


@UNTOLD
def test_what_yourdfpy_would_not_write_is_kept(tmp_path: Path) -> None:
    """Its own writer leaves <mimic> out."""
    text = random_chain(3, ("revolute", "prismatic")).replace(
        "</joint></robot>", '<mimic joint="joint_1" multiplier="-0.1"/><dynamics damping="0.3"/></joint></robot>'
    )
    robot = parsed(text, tmp_path)
    assert "mimic" not in robot.write_xml_string().decode()
    joint = rttrr_pin.load(robot, friction=True).model.joints[1]
    assert joint.mimic is not None
    assert (joint.mimic.joint, joint.mimic.multiplier, joint.effects.damping) == (0, -0.1, 0.3)


@pytest.mark.parametrize("pitch", [0.0, 0.7, math.pi / 2, -math.pi / 2, math.pi / 2 - 1e-9, 3.0])
@UNTOLD
def test_angles_survive_where_roll_and_yaw_are_one(pitch: float, tmp_path: Path) -> None:
    """The matrices are products, so that their small entries are rounding, as those of a CAD program are."""
    robot, euler = parsed(EXAMPLES["one-joint"], tmp_path), yourdfpy.urdf.tra.euler_matrix
    for roll, yaw in ((0.0, 0.0), (0.4, -2.0), (-3.0, 1.1)):
        Q = euler(0.3, -1.1, 2.2)
        R = Q.T @ (Q @ euler(roll, pitch, yaw))
        robot.robot.joints[0].origin = R
        assert np.abs(rttrr_pin.load(robot).model.joints[0].R - R[:3, :3]).max() <= 8 * np.finfo(float).eps


@pytest.mark.parametrize(
    ("holder", "name", "value", "message"),
    [
        ("joint", "origin", np.diag([2.0, 1.0, 1.0, 1.0]), "no rotation and translation"),
        ("joint", "origin", np.diag([-1.0, 1.0, 1.0, 1.0]), "no rotation and translation"),
        ("joint", "origin", np.diag([math.nan, 1.0, 1.0, 1.0]), "no rotation and translation"),
        ("joint", "origin", np.diag([1.0, 1.0, 1.0, 2.0]), "no rotation and translation"),
        ("joint", "axis", np.zeros(2), "expected 3 numbers"),
        ("joint", "name", 5, "expected text"),
        ("joint", "type", None, "has no type"),
        ("inertial", "inertia", np.triu(np.ones((3, 3))), "is not symmetric"),
        ("inertial", "mass", object(), "expected a number"),
        ("inertial", "mass", math.nan, "'nan' is not a decimal number"),
        ("inertial", "mass", None, "has no <mass>"),
        ("inertial", "inertia", None, "has no <inertia>"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
@UNTOLD
def test_objects_that_say_no_robot_are_refused(
    holder: str, name: str, value: Any, message: str, tmp_path: Path
) -> None:
    robot = parsed(EXAMPLES["one-joint"], tmp_path)
    holders = {"joint": robot.robot.joints[0], "inertial": robot.robot.links[1].inertial}
    setattr(holders[holder], name, value)
    with pytest.raises(UrdfError, match=message) as caught:
        rttrr_pin.load(robot)
    assert "yourdfpy.URDF 'chain_5'" in str(caught.value)


def test_the_written_text_is_a_urdf_that_others_read(tmp_path: Path) -> None:
    robot = parsed(CHAIN, tmp_path)
    assert parsed(as_urdf(robot.robot, "x"), tmp_path).joint_names == robot.joint_names


def test_what_yourdfpy_passed_over_in_silence_is_told(tmp_path: Path) -> None:
    """Its object has no quaternion of URDF 1.1, and does not know its file."""
    turned = CHAIN.replace("<origin ", '<origin quat_xyzw="0 0 1 0" ', 1)
    with pytest.warns(LoadWarning, match="does not tell where: pass the file instead"):
        robot = rttrr_pin.load(parsed(turned, tmp_path))
    assert any("quat_xyzw" in note for note in rttrr_pin.validate(robot, "recursion", n_states=5).to_dict()["notes"])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('name="base"', 'name="' + "b" * 100_000 + '"', "a name has 100,000 characters"),
        ("<link", "<link" + "".join(f" a{k}=''" for k in range(2000)), "2,001 attributes"),
        ('value="1"', 'value="1.' + "1" * 100_000 + '"', "has more than 2,000 characters"),
        ('value="1"', 'value="' + "1" * 300 + "." + "1" * 100_000 + 'e-99"', "has more than 2,000 characters"),
    ],
)
def test_what_takes_long_to_read_is_refused_at_once(old: str, new: str, message: str) -> None:
    text = (
        '<robot name="r"><link name="base"><inertial><mass value="1"/>'
        '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></robot>'
    )
    assert text.count(old) == 1
    started = time.process_time()
    with pytest.raises(UrdfError, match=message) as caught:
        rttrr_pin.load(text.replace(old, new))
    assert time.process_time() - started < 2.0 and len(str(caught.value)) < 1000


def test_of_a_folder_with_one_robot_its_file_is_meant(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Found in one walk, and from the home folder on."""
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "robots").mkdir()
    one, two = (tmp_path / "robots" / name for name in ("one.urdf", "two.urdf"))
    one.touch()
    assert catalogue.one_or_several("~/robots") == (str(one), {})
    two.touch()
    assert catalogue.one_or_several("~/robots") == ("~/robots", {"one.urdf": one, "two.urdf": two})
    for name in ("rttrr", "", "a" * 5000, "\0", "~nobody_of_that_name/robots"):
        assert catalogue.one_or_several(name) == (name, {})
