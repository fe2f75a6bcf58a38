"""Random trees of every joint type as URDF text."""

from __future__ import annotations

import re

import numpy as np

from support.serial_chains import inertial, numbers

TREE_TYPES = ("revolute", "continuous", "prismatic", "planar", "floating", "fixed")

FOLLOWING = ("revolute", "prismatic", "continuous")


def random_tree(seed: int, joints: int, types: tuple[str, ...] = TREE_TYPES, mimics: bool = True) -> str:
    """A tree of so many joints, names shuffled so that alphabetical order says nothing, some joints following others.

    Also massless frames, a massive root, and joints that follow one that sorts later.
    """
    rng = np.random.default_rng(seed)
    labels = rng.permutation(joints)
    kinds = rng.choice(types, joints)
    parts = [f'<link name="base">{inertial(rng)}</link>']
    for i in range(joints):
        parent = (
            "base" if i == 0 else f"link_{labels[rng.integers(max(0, i - 4), i)]}" if rng.random() < 0.9 else "base"
        )
        massless = rng.random() < 0.15 and kinds[i] == "fixed"
        parts.append(f'<link name="link_{labels[i]}">{"" if massless else inertial(rng)}</link>')
        parts.append(
            _joint(
                rng,
                f"joint_{labels[i]}",
                str(kinds[i]),
                parent,
                f"link_{labels[i]}",
                _mimic(rng, kinds, labels, i) if mimics else "",
            )
        )
    return f'<robot name="tree_{seed}">{"".join(parts)}</robot>'


def _joint(rng: np.random.Generator, name: str, kind: str, parent: str, child: str, mimic: str) -> str:
    axis = np.array([0.0, 0.0, 1.0]) if kind == "planar" else rng.normal(size=3)
    if rng.random() < 0.3 and kind != "planar":
        axis = np.eye(3)[rng.integers(3)] * rng.choice([-1, 1])
    rpy = np.zeros(3) if rng.random() < 0.3 else rng.uniform(-3, 3, 3)
    moves = "" if kind in ("fixed", "floating") else f'<axis xyz="{numbers(axis / np.linalg.norm(axis))}"/>'
    limit = "" if kind in ("fixed", "floating") else '<limit lower="-2" upper="2" velocity="3" effort="10"/>'
    dynamics = f'<dynamics damping="{rng.uniform(0, 2):.17g}" friction="{rng.uniform(0, 2):.17g}"/>' if moves else ""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{numbers(rng.uniform(-0.5, 0.5, 3))}" rpy="{numbers(rpy)}"/>{moves}{limit}{dynamics}{mimic}</joint>'
    )


def _mimic(rng: np.random.Generator, kinds: np.ndarray, labels: np.ndarray, i: int) -> str:
    """Now and then an odd joint follows an even one, before or behind it, so that no circle comes about."""
    if i % 2 == 0 or kinds[i] not in FOLLOWING or rng.random() < 0.5:
        return ""
    masters = [k for k in range(0, len(kinds), 2) if kinds[k] in FOLLOWING]
    if not masters:
        return ""
    multiplier, offset = rng.uniform(-2, 2, 2)
    return f'<mimic joint="joint_{labels[rng.choice(masters)]}" multiplier="{multiplier:.17g}" offset="{offset:.17g}"/>'


OF_BODIES = re.compile(r"<(?:mass|inertia|origin) [^>]*>")
"""Elements whose numbers are made extreme; angles stay."""

ATTRIBUTE = re.compile(r'(\w+)="([^"]*)"')

LEAST_MASS = -15.0
"""Power of ten; to masses below eps Pinocchio gives another centre."""

LIMITS = 'lower="-2" upper="2" velocity="3"'


def extreme_tree(seed: int, joints: int, orders: float = 30.0, signs: bool = True) -> str:
    """A random tree with numbers from 10^-orders to 10^orders: masses, centres, tensors, places, ranges and rates.

    One in seven is 0. With `signs` masses and moments have either sign; without, they are such as Pinocchio can add up.
    """
    rng = np.random.default_rng([seed, joints])

    def size(least: float = -orders) -> str:
        return f"{10 ** rng.uniform(least, orders):.17g}" if rng.random() < 6 / 7 else "0"

    def attribute(found: re.Match[str]) -> str:
        name, words = found[1], found[2].split()
        if name == "rpy":
            return found[0]
        positive = not signs and name in ("value", "ixx", "iyy", "izz")
        least = LEAST_MASS if positive and name == "value" else -orders
        numbers = (("" if positive or rng.random() < 0.5 else "-") + size(least) for _ in words)
        return f'{name}="{" ".join(numbers)}"'

    text = OF_BODIES.sub(lambda element: ATTRIBUTE.sub(attribute, element[0]), random_tree(seed, joints))
    return text.replace(LIMITS, f'lower="-{size()}" upper="{size()}" velocity="{size()}"')


MUTATED = (39, 8)
"""Seed and joints of a tree in which every term of the recursion and of every joint type matters: all types, a joint
that follows another, a prismatic joint on a link that turns."""
