"""Trees that are hostile in one way each: signs, axes, places, ratios, angles or tensors; and states for them."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.implementations import Batch
from rttrr_pin.validation import Sampler
from support.serial_chains import joint, numbers
from support.trees import ATTRIBUTE, OF_BODIES, random_tree

Generator = np.random.Generator


def _with_numbers(text: str, number: Callable[[str], str]) -> str:
    """A tree whose masses and moments are others; what `number` gives nothing for stays."""

    def attribute(found: re.Match[str]) -> str:
        other = number(found[1])
        return f'{found[1]}="{other}"' if other else found[0]

    return OF_BODIES.sub(lambda element: ATTRIBUTE.sub(attribute, element[0]), text)


def opposite_masses(seed: int, rng: Generator) -> str:
    """Masses +m, -m and 0, many in one rigid body, so that they cancel."""
    m = rng.choice([1.0, 1e-8, 1e20])
    words = {"value": ["0", str(m), str(-m)], "ixx": ["-1", "0", ""], "iyy": ["1e20", ""], "izz": ["1e-20", ""]}
    text = random_tree(seed, 2 + seed % 6, ("revolute", "fixed", "fixed", "prismatic", "continuous"))
    return _with_numbers(text, lambda name: str(rng.choice(words.get(name, [""]))))


def axes_nearly_main_ones(seed: int, rng: Generator) -> str:
    """From a few ulp to 1e-9 off x, y, z or their opposites, of any length."""

    def axis(found: re.Match[str]) -> str:
        main = np.eye(3)[rng.integers(3)] * rng.choice([-1, 1])
        off = rng.normal(size=3) * 10.0 ** rng.uniform(-18, -9)
        return f'<axis xyz="{numbers((main + off) * 10.0 ** rng.uniform(-5, 5))}"/>'

    text = random_tree(seed, 2 + seed % 6, ("revolute", "prismatic", "continuous", "fixed"))
    return re.sub(r'<axis xyz="[^"]*"/>', axis, text)


def cancelling_places(seed: int, rng: Generator) -> str:
    """A chain that goes out 1e-8 to 1e8 m and comes back but for an ulp, turned there and back."""
    parts, place, turn = ['<link name="base"/>'], np.zeros(3), np.zeros(3)
    for i in range(3 + seed % 5):
        if i % 2:
            place, turn = -place * (1 + rng.choice([0, 1e-16, 1e-10])), -turn
        else:
            place, turn = rng.normal(size=3) * 10.0 ** rng.uniform(-8, 8), np.array([rng.uniform(-3, 3), 0, 0])
        com, mass = rng.normal(size=3) * 10.0 ** rng.integers(-6, 7), 10.0 ** rng.integers(-6, 7)
        tensor = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
        inertial = f'<inertial><origin xyz="{numbers(com)}"/><mass value="{mass}"/>{tensor}</inertial>'
        parts.append(f'<link name="link_{i}">{inertial}</link>')
        kind = str(rng.choice(["fixed", "fixed", "revolute", "prismatic"]))
        parts.append(joint(i, kind, f"link_{i - 1}" if i else "base", f"link_{i}", place, turn, (0, 1, 0)))
    return f'<robot name="back">{"".join(parts)}</robot>'


def extreme_ratios(seed: int, rng: Generator) -> str:
    """Multipliers of followers, damping and friction over 60 to 120 orders of magnitude."""

    def mimic(found: re.Match[str]) -> str:
        multiplier = rng.choice([-1, 1]) * 10.0 ** rng.uniform(-60, 60)
        return f'multiplier="{multiplier:.17g}" offset="{rng.choice([0.0, 1e-20, 1e10])}"'

    def effect(found: re.Match[str]) -> str:
        return f'{found[1]}="{10.0 ** rng.uniform(-30, 30):.17g}"'

    text = random_tree(seed, 2 + seed % 7, ("revolute", "prismatic", "continuous"))
    return re.sub(r'(damping|friction)="[^"]*"', effect, re.sub(r'multiplier="[^"]*" offset="[^"]*"', mimic, text))


def cut_angles(seed: int, rng: Generator) -> str:
    """Quarter turns with all, few and too few digits, and angles of many turns."""
    angles = [0, math.pi / 2, -math.pi, 1.5707963, 1.5708, -1.57, 1e-9, 1e5, 1e15, math.nextafter(math.pi / 2, 0)]
    text = random_tree(seed, 2 + seed % 5, ("revolute", "fixed", "prismatic"))
    return re.sub(r'rpy="[^"]*"', lambda found: f'rpy="{numbers(rng.choice(angles, 3))}"', text)


def no_tensors(seed: int, rng: Generator) -> str:
    """Tensors that no body has, and masses from 1e-300 to 1e150."""
    moments, masses = ["0", "1e-300", "1", "-1", "1e150", "0.1"], ["0", "1e-300", "1", "1e150", "-1e150"]
    text = random_tree(seed, 2 + seed % 5, ("revolute", "fixed", "floating", "planar"))
    return _with_numbers(
        text, lambda name: str(rng.choice({"value": masses}.get(name, moments if name[0] == "i" else [""])))
    )


KINDS = (opposite_masses, axes_nearly_main_ones, cancelling_places, extreme_ratios, cut_angles, no_tensors)


def usual_state(model: Model, rng: Generator) -> Batch:
    """A state of `validate`, with a load of any size at the last link, in its axes or the base's."""
    state = Sampler(model, "mixed", int(rng.integers(1000))).draw(int(rng.integers(50)), 1)
    sizes = 10.0 ** rng.uniform(-10, 10, (2, 1, 3)) * rng.choice([-1, 0, 1], (2, 1, 3))
    return replace(state, loads=(Load(len(model.links) - 1, *sizes, bool(rng.random() < 0.5)),))
