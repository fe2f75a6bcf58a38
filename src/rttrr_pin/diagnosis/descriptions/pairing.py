"""Which joint of one description is which of another: by name, else by where it stands in the tree."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from itertools import takewhile

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.diagnosis.descriptions.rigid_tree import AT_ORIGIN, Body, Pose, RigidTree

Pairs = dict[int, int]
"""By the number of a body of A that of its counterpart in B."""

ROOT = -1


def pairs_by_name(a: RigidTree, b: RigidTree) -> Pairs:
    """By equal names of joints, then names without what all have in front or behind, then links, then structure."""
    pairs: Pairs = {}
    for key in (
        lambda tree: [body.joint.name for body in tree.bodies],
        lambda tree: plain([body.joint.name for body in tree.bodies]),
        lambda tree: [body.name for body in tree.bodies],
        lambda tree: plain([body.name for body in tree.bodies]),
    ):
        _by_key(a, b, key, pairs)
    return consistent(a, b, pairs_by_structure(a, b, consistent(a, b, pairs)))


def plain(names: Sequence[str]) -> list[str]:
    """Names in small letters and digits, without the words that all of them begin or end with."""
    words = [re.findall(r"[^\W_]+", name.lower()) for name in names]
    front = _in_front(words)
    back = _in_front([own[front:][::-1] for own in words])
    return ["".join(own[front : len(own) - back]) for own in words]


def _in_front(lists: Sequence[Sequence[str]]) -> int:
    """How many words all lists begin with, of two or more."""
    if len(lists) < 2:
        return 0
    return sum(1 for _ in takewhile(lambda words: len(set(words)) == 1, zip(*lists, strict=False)))


def _by_key(a: RigidTree, b: RigidTree, key: Callable[[RigidTree], list[str]], pairs: Pairs) -> None:
    """Pair what no pair has and whose key stands once in each description."""
    of_a, of_b = key(a), key(b)
    taken = set(pairs.values())
    for i, name in enumerate(of_a):
        if i in pairs or not name or of_a.count(name) != 1 or of_b.count(name) != 1:
            continue
        j = of_b.index(name)
        if j not in taken and alike(a.bodies[i], b.bodies[j]):
            pairs[i] = j
            taken.add(j)


def alike(x: Body, y: Body) -> bool:
    """Whether coordinates of one can be coordinates of the other."""
    return x.joint.nq == y.joint.nq and x.joint.nv == y.joint.nv


def consistent(a: RigidTree, b: RigidTree, pairs: Pairs) -> Pairs:
    """The pairs whose carriers are pairs too, where joints without a counterpart stand still."""
    kept = dict(pairs)
    while True:
        back = {j: i for i, j in kept.items()}
        wrong = [
            i
            for i, j in kept.items()
            if _carrier(a, i, kept) != back.get(_carrier(b, j, back), ROOT)
            or _follows_alone(a, i, kept)
            or _follows_alone(b, j, back)
        ]
        if not wrong:
            return kept
        del kept[min(wrong)]


def _carrier(tree: RigidTree, i: int, known: Pairs) -> int:
    """The next body inward that has a counterpart; -1 is the base."""
    i = tree.bodies[i].parent
    while i != ROOT and i not in known:
        i = tree.bodies[i].parent
    return i


def _follows_alone(tree: RigidTree, i: int, known: Pairs) -> bool:
    """Whether it follows a joint that has no counterpart."""
    mimic = tree.bodies[i].joint.mimic
    return mimic is not None and mimic.joint not in known


def pairs_by_structure(a: RigidTree, b: RigidTree, known: Pairs) -> Pairs:
    """Pairs that are known, and from the base outwards those that lie nearest to each other at zero."""
    pairs = dict(known)
    at_a, at_b = placements(a), placements(b)
    size = max(a.length, b.length) or 1.0
    taken = set(pairs.values())
    carriers = [(ROOT, ROOT)]
    while carriers:
        x, y = carriers.pop(0)
        of_x = [i for i, body in enumerate(a.bodies) if body.parent == x]
        of_y = [j for j, body in enumerate(b.bodies) if body.parent == y]
        free = [
            (apart(a.bodies[i], at_a[i], b.bodies[j], at_b[j], size), i, j)
            for i in of_x
            for j in of_y
            if i not in pairs and j not in taken and alike(a.bodies[i], b.bodies[j])
        ]
        for _, i, j in sorted(free):
            if i not in pairs and j not in taken:
                pairs[i] = j
                taken.add(j)
        carriers += [(i, pairs[i]) for i in of_x if i in pairs]
    return pairs


def placements(tree: RigidTree) -> list[Pose]:
    """Where each joint is at zero, in the base."""
    poses: list[Pose] = []
    for body in tree.bodies:
        poses.append((AT_ORIGIN if body.parent == ROOT else poses[body.parent]) @ body.pose)
    return poses


def apart(x: Body, at_x: Pose, y: Body, at_y: Pose, size: float) -> float:
    """How unlike two joints are: types, the angle of their axes, the distance of their places, their masses."""
    unlike = 0.0 if x.joint.type.rotations == y.joint.type.rotations else 4.0
    if x.joint.type.has_axis and y.joint.type.has_axis:
        unlike += math.acos(min(1.0, abs(float(axis(x, at_x) @ axis(y, at_y)))))
        unlike += 0.5 * float(axis(x, at_x) @ axis(y, at_y) < 0.0)
    of_x, of_y = abs(x.inertia.mass), abs(y.inertia.mass)
    masses = abs(of_x - of_y) / max(of_x, of_y) if max(of_x, of_y) else 0.0
    return unlike + float(np.linalg.norm(at_x.p - at_y.p)) / size + 0.1 * masses


def axis(body: Body, at: Pose) -> Array:
    """The joint's axis in the base, at zero."""
    return at.R @ body.joint.axis
