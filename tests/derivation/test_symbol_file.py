"""Files of symbols: expressions, tables of frames as models, and the published symbols of bundled robots."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin.derivation.expressions import read_expression
from rttrr_pin.derivation.symbol_file import published_symbols, read_symbols
from rttrr_pin.derivation.symbols import Expression
from rttrr_pin.derivation.tables import read_table
from rttrr_pin.errors import EquationError, InputError

NAMES = ("l_1", "m", "J")


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("-J", {(("J", 1),): -1}),
        ("l_1/2", {(("l_1", 1),): Fraction(1, 2)}),
        ("m*l_1**2/3", {(("l_1", 2), ("m", 1)): Fraction(1, 3)}),
        ("0.1", {(): Fraction(1, 10)}),
        ("0", {}),
        ("(l_1 + 2)*(l_1 - 2)", {(("l_1", 2),): 1, (): -4}),
        ("m - m", {}),
    ],
)
def test_expressions_are_exact_polynomials(text: str, wanted: Expression) -> None:
    assert read_expression(text, NAMES) == wanted


@pytest.mark.parametrize(
    "text",
    ["", "x", "l_1/m", "1/0", "l_1**m", "l_1**41", "l_1**-1", "sin(m)", "True", "1j", "'a'", "m m", "(" * 500, "__import__('os')"],
)  # fmt: skip
def test_what_is_no_polynomial_is_refused(text: str) -> None:
    with pytest.raises(InputError):
        read_expression(text, NAMES)


TREE = """
[robot]
gravity = ["0", "0", "-g"]
[[link]]
name = "trunk"
joint = "revolute about -z"
origin = [0, 0, 0.2]
rpy_degrees = [90, 0, 45]
mass = "m"
com = ["l_1", "0", "l_1/2"]
inertia = ["J", "0", "J/10", "J", "0", "J"]
[[link]]
name = "slide"
joint = "prismatic along y"
origin = ["l_1", "0", "0"]
mass = "m"
[[link]]
name = "plate"
parent = "trunk"
joint = "fixed"
mass = "2*m"
[[symbol]]
name = "m"
dimension = "mass"
[[symbol]]
name = "J"
dimension = "inertia"
[[symbol]]
name = "l_1"
dimension = "length"
[[symbol]]
name = "g"
dimension = "acceleration"
"""


def test_a_table_of_frames_is_the_robot_that_its_urdf_describes(tmp_path) -> None:
    path = tmp_path / "tree.toml"
    path.write_text(TREE)
    model = read_symbols(read_table(path), path, latex=True).robot.model
    again = rttrr_pin.load(model.urdf, gravity=model.gravity).model
    for i, (link, joint) in enumerate(zip(model.links, model.joints, strict=True)):
        k = again.link_index(link.name)
        other, carrier = again.links[k], again.joints[k]
        assert link.mass == other.mass and (link.com == other.com).all() and (link.inertia == other.inertia).all()
        assert joint.type == carrier.type and (joint.p == carrier.p).all() and (joint.R == carrier.R).all()
        assert not joint.nv or (joint.axis == carrier.axis).all()
        parents = [m.links[j.parent].name if j.parent >= 0 else "" for m, j in ((model, joint), (again, carrier))]
        assert parents[0] == parents[1], i
    assert np.isfinite(model.gravity).all()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('mass = "2*m"', 'mass = "2*l_1"', "measures m"),
        ('parent = "trunk"', 'parent = "plate"', "expected base or a link above"),
        ('mass = "2*m"', 'mass = "-m"', "expected 0 or more"),
        ('com = ["l_1", "0", "l_1/2"]', 'com = ["l_1", "0", "k"]', "no symbol"),
    ],
)
def test_what_does_not_fit_is_said_with_the_file(tmp_path, old, new, message) -> None:
    path = tmp_path / "tree.toml"
    assert old in TREE
    path.write_text(TREE.replace(old, new))
    with pytest.raises(EquationError, match=message) as caught:
        read_symbols(read_table(path), path, latex=True)
    assert caught.value.source == "tree.toml"


def test_published_symbols_are_taken_where_they_fit_the_robot_as_loaded() -> None:
    model = rttrr_pin.load("rttrr").model
    symbols = published_symbols("rttrr", model, model.link_index("tool"))
    assert symbols is not None and symbols.preface
    assert {"l_2", "h_6", "f_6x"} <= set(symbols.robot.parameters.values)
    assert published_symbols("rttrr", model, 0) is None
    tilted = rttrr_pin.load("rttrr", gravity=(1.0, 0.0, -9.81)).model
    assert published_symbols("rttrr", tilted, tilted.link_index("tool")) is None
    assert published_symbols("trr", rttrr_pin.load("trr").model, None) is None
