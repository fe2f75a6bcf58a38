"""Shapes of the file, on the links that have them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.solids import Box, Cylinder
from rttrr_pin.viewing.looks import GREY, Triangles, looks_of
from support.viewed import AWKWARD, MASSLESS

FILE = """<robot name="r"><material name="red"><color rgba="1 0 0 0.5"/></material>
<link name="a"><visual><origin xyz="1 2 3" rpy="0 0 1"/><geometry><box size="1 2 3"/></geometry><material name="red"/></visual>
 <visual><geometry><cylinder radius="0.1" length="2"/></geometry><material><color rgba="0 1 0 1"/></material></visual>
 <collision><geometry><sphere radius="9"/></geometry></collision></link>
<link name="b"><visual><geometry><mesh filename="{mesh}" scale="{scale}"/></geometry></visual></link>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>"""

STL = """solid s
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
endsolid s
"""


def written(folder: Path, mesh: str = "m.stl", scale: str = "1 1 1", text: str = STL) -> rttrr_pin.Robot:
    (folder / "m.stl").write_text(text)
    (folder / "r.urdf").write_text(FILE.format(mesh=mesh, scale=scale))
    return rttrr_pin.load(folder / "r.urdf")


def test_solids_with_their_colours(tmp_path: Path) -> None:
    looks = looks_of(written(tmp_path).model)
    box, cylinder, mesh = looks.parts
    assert box.link == cylinder.link == -1 and mesh.link == 0
    assert isinstance(box.shape, Box) and isinstance(cylinder.shape, Cylinder) and isinstance(mesh.shape, Triangles)
    assert (box.colour, cylinder.colour, mesh.colour) == ((1, 0, 0, 0.5), (0, 1, 0, 1), GREY)
    assert box.p.tolist() == [1, 2, 3] and np.isclose(box.R[1, 0], np.sin(1))
    assert looks.missing == () and looks.role == "visual"


def test_a_floating_base_keeps_the_shapes_of_its_root(tmp_path: Path) -> None:
    written(tmp_path)
    model = rttrr_pin.load(tmp_path / "r.urdf", base="floating").model
    assert [part.link for part in looks_of(model).parts] == [0, 0, 1]


def test_a_mesh_is_scaled_and_may_be_mirrored(tmp_path: Path) -> None:
    (plain,) = (part.shape for part in looks_of(written(tmp_path, scale="2 3 4").model).parts if part.link == 0)
    (mirrored,) = (part.shape for part in looks_of(written(tmp_path, scale="-1 1 1").model).parts if part.link == 0)
    assert isinstance(plain, Triangles) and isinstance(mirrored, Triangles)
    assert sorted(map(tuple, plain.corners.tolist())) == [(0, 0, 0), (0, 3, 0), (2, 0, 0)]
    for own in (plain, mirrored):  # still seen from above
        a, b, c = own.corners[own.faces[0]]
        assert np.cross(b - a, c - a)[2] > 0


@pytest.mark.parametrize("text", ["", "solid", "\x00\x01 junk", STL.replace("1 0 0", "nan 0 0")])
def test_a_mesh_that_cannot_be_read_is_named(tmp_path: Path, text: str) -> None:
    looks = looks_of(written(tmp_path, text=text).model)
    assert looks.missing == ("m.stl",) and len(looks.parts) == 2


@pytest.mark.parametrize("scale", ["1 1", "a b c", "nan 1 1"])
def test_a_scale_that_is_none(tmp_path: Path, scale: str) -> None:
    assert looks_of(written(tmp_path, scale=scale).model).missing == ("m.stl",)


def test_what_is_nowhere_is_missing() -> None:
    looks = looks_of(rttrr_pin.load(AWKWARD).model)
    assert looks.parts == () and looks.missing == ("package://nowhere/<b>.stl",)
    assert looks_of(rttrr_pin.load(AWKWARD).model, meshes=False).missing == ()


def test_robots_without_shapes() -> None:
    assert looks_of(rttrr_pin.load(MASSLESS).model).parts == ()
    assert looks_of(Model("numbers", Link("base"), (), ())).parts == ()


def test_collision_shapes_where_nothing_is_visual(tmp_path: Path) -> None:
    text = (
        FILE.replace("<visual>", "<collision>")
        .replace("</visual>", "</collision>")
        .format(mesh="none.stl", scale="1 1 1")
    )
    looks = looks_of(rttrr_pin.load(text).model)
    assert looks.role == "collision" and len(looks.parts) == 3
