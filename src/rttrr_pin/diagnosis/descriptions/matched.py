"""Two models brought together: which joint is which, what stands still, what else is to be known of how they match."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from rttrr_pin.core.altered import with_locked
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.descriptions.descriptions import differences
from rttrr_pin.diagnosis.descriptions.difference import Difference
from rttrr_pin.diagnosis.descriptions.joint_differences import unset_limits
from rttrr_pin.diagnosis.descriptions.pairing import Pairs, consistent, pairs_by_name, pairs_by_structure
from rttrr_pin.diagnosis.descriptions.rigid_tree import RigidTree
from rttrr_pin.diagnosis.descriptions.same_frames import Reframed, reframed
from rttrr_pin.diagnosis.descriptions.tolerance import Tolerance
from rttrr_pin.errors import listed


@dataclass(frozen=True, slots=True, eq=False)
class Matched:
    """Two descriptions of one robot, joint by joint.

    Attributes:
        a: the first, its bodies merged where the second has no such links.
        other: the second in the terms of the first.
        model_a: the first, as it is, but for joints that stand still; its fixed links are not merged.
        model_b: the second, likewise.
        pairs: names of joints, first and second, in the order of the first.
        only_a: joints that move and have no counterpart in the second, which stand still at zero.
        only_b: likewise.
        differences: what differs.
        tree_b: the bodies of `model_b`, in its own terms.
    """

    a: RigidTree
    other: Reframed
    model_a: Model
    model_b: Model
    pairs: tuple[tuple[str, str], ...]
    only_a: tuple[str, ...]
    only_b: tuple[str, ...]
    differences: tuple[Difference, ...]
    tree_b: RigidTree

    @property
    def alone(self) -> int:
        """How many joints have no counterpart."""
        return len(self.only_a) + len(self.only_b)

    @property
    def links(self) -> list[tuple[str, str]]:
        """Names of the links that are one, first and second: those of joints that are paired, and those of one name."""
        bodies = [(own.name, self.tree_b.bodies[j].name) for own, j in zip(self.a.bodies, _partners(self), strict=True)]
        first, second = ({pair[k] for pair in bodies} for k in (0, 1))
        alike = [name for name in self.model_a.link_names if name in self.model_b.link_names]
        return [*bodies, *((name, name) for name in alike if name not in first and name not in second)]

    @property
    def unlike(self) -> int:
        """How much differs: numbers that may matter, and, thrice, joints without a counterpart."""
        return sum(own.change is not None and not own.rounding for own in self.differences) + 3 * self.alone


def matched(a: Model, b: Model) -> Matched:
    """Two models, paired by name; by structure, if they are the same so, or nearly, and by name they are not."""
    trees = RigidTree.of(a), RigidTree.of(b)
    named = pairs_by_name(*trees)
    best = _with(a, b, trees, named)
    if best.unlike:
        placed = consistent(*trees, pairs_by_structure(*trees, {}))
        if placed != named:
            other = _with(a, b, trees, placed)
            if other.alone <= best.alone and 3 * other.unlike < best.unlike:
                return other
    return best


def _with(a: Model, b: Model, trees: tuple[RigidTree, RigidTree], pairs: Pairs) -> Matched:
    names = [(trees[0].bodies[i].joint.name, trees[1].bodies[j].joint.name) for i, j in sorted(pairs.items())]
    still_a, only_a = _still(a, {x for x, _ in names})
    still_b, only_b = _still(b, {y for _, y in names})
    tree_a, tree_b = RigidTree.of(still_a), RigidTree.of(still_b)
    of_b = {body.joint.name: j for j, body in enumerate(tree_b.bodies)}
    partner = dict(names)
    own = {i: of_b[partner[body.joint.name]] for i, body in enumerate(tree_a.bodies)}
    tolerance = Tolerance.of(a, b, max(tree_a.length, tree_b.length))
    other = reframed(tree_a, tree_b, own, tolerance)
    first, found = differences(tree_a, other.tree, tolerance)
    return Matched(first, other, still_a, still_b, tuple(names), only_a, only_b, tuple(found), tree_b)


def _still(model: Model, names: set[str]) -> tuple[Model, tuple[str, ...]]:
    """The model whose joints without a counterpart stand still at zero, and the names of these."""
    lone = [joint for joint in model.joints if joint.nv and joint.name not in names]
    led = {j.name: j.mimic.offset for j in lone if j.mimic and model.joints[j.mimic.joint].name in names}
    free = [replace(joint, mimic=None) if joint.name in led else joint for joint in model.joints]
    model = replace(model, joints=tuple(free))
    at = {}
    for joint in lone:
        if joint.mimic is None or joint.name in led:
            one = replace(model, joints=(replace(joint, parent=-1, mimic=None),), links=model.links[:1])
            at[joint.name] = one.coordinates_at(np.zeros((1, joint.nv)))[0] + led.get(joint.name, 0.0)
    shaped = {name: q if len(q) > 1 else float(q[0]) for name, q in at.items()}
    return with_locked(model, shaped), tuple(joint.name for joint in lone)


def notes_of(x: Matched) -> list[str]:
    """What is to be known of how the two match, in sentences."""
    notes = []
    for what, only in (("the first", x.only_a), ("the second", x.only_b)):
        if only:
            notes.append(f"only {what} has joints that move: {listed(only)}; they stand still at 0 here")
    if renamed := [f"{p} is {q}" for p, q in x.pairs if p != q]:
        notes.append(f"joints have other names in the second: {listed(renamed)}")
    if renamed := [f"{p} is {q}" for p, q in x.links if p != q]:
        notes.append(f"links have other names in the second: {listed(renamed)}")
    order = [j for j in _partners(x) if x.tree_b.bodies[j].joint.independent]
    if order != sorted(order):
        notes.append(
            f"the second has joints in another order: {listed([x.tree_b.bodies[j].joint.name for j in sorted(order)])}"
        )
    names = [body.joint.name for body in x.a.bodies]
    turned = [name for name, sign in zip(names, x.other.signs, strict=True) if sign < 0.0]
    if turned:
        notes.append(f"the other direction: {listed(turned)}; q, v, a and tau of the second are the negatives")
    if moved := [name for name, own in zip(names, x.other.moved, strict=True) if own]:
        notes.append(f"same motion, other frames: {listed(moved)}")
    unset = [unset_limits(tree) for tree in (x.a, x.other.tree)]
    for what, own, other in (("first", unset[0], unset[1]), ("second", unset[1], unset[0])):
        if lacking := [key for key in own if key not in other]:
            notes.append(f"limits that the {what} sets for no joint: {listed(lacking)}")
    return [*notes, *_members(x)]


def _partners(x: Matched) -> list[int]:
    """By body of the first, the number of that of the second."""
    at = {body.joint.name: j for j, body in enumerate(x.tree_b.bodies)}
    partner = dict(x.pairs)
    return [at[partner[body.joint.name]] for body in x.a.bodies]


def _members(x: Matched) -> Iterable[str]:
    """Links that one description has merged in others, and frames without mass."""
    told = {own.link for own in x.differences if own.kind == "link"}
    bodies = [*zip((own.members for own in x.a.bodies), (own.members for own in x.other.tree.bodies), strict=True)]
    bodies.append((x.a.base, x.tree_b.base))
    for this, pairs in (("first", bodies), ("second", [(q, p) for p, q in bodies])):
        merged, frames = [], []
        for own, others in pairs:
            names = {other.link.name for other in others}
            lone = [one for one in own[1:] if one.link.name not in names | told]
            merged += [f"{one.link.name} in {others[0].link.name}" for one in lone if one.massive]
            frames += [one.link.name for one in lone if not one.massive]
        if merged:
            other = "second" if this == "first" else "first"
            yield f"fixed links of the {this} that the {other} has merged: {listed(merged)}"
        if frames:
            yield f"frames without mass that only the {this} has: {listed(frames)}"
