"""Two descriptions of one robot, number by number: what differs, each as a change of the first."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from rttrr_pin.core.model import Link
from rttrr_pin.diagnosis.descriptions.difference import Change, Difference, difference_of
from rttrr_pin.diagnosis.descriptions.joint_differences import joint_differences, rpy, unset_limits
from rttrr_pin.diagnosis.descriptions.rigid_tree import Body, Member, Pose, RigidTree, link_of, total
from rttrr_pin.diagnosis.descriptions.tolerance import UNLIKE, Level, Tolerance


def differences(a: RigidTree, b: RigidTree, tolerance: Tolerance) -> tuple[RigidTree, list[Difference]]:
    """What two descriptions say differently; `b` is in the terms of `a`.

    Returns:
        The first robot, whose bodies are merged where the second has no such links; and the differences from it.
    """
    found: list[Difference] = []
    level = tolerance.length(a.gravity, b.gravity)
    if level.differs:
        g = b.gravity
        found.append(difference_of("gravity", None, None, (a.gravity, g), level, lambda tree: replace(tree, gravity=g)))
    found += _base(a, b, tolerance)
    names = [body.joint.name for body in a.bodies]
    unset = {name for tree in (a, b) for name in unset_limits(tree)}
    for k, (x, y) in enumerate(zip(a.bodies, b.bodies, strict=True)):
        found += joint_differences(k, x, y, tolerance, names, unset)
        merged, own = _body(k, x, y, tolerance)
        if merged is not None:
            a = a.changed(k, members=merged)
        found += own
    return a, found


def _base(a: RigidTree, b: RigidTree, tolerance: Tolerance) -> Iterator[Difference]:
    """Links that stand still, which no torque feels."""
    of_a, of_b = ({own.link.name: own.link for own in tree.base if own.massive} for tree in (a, b))
    whole_a, whole_b = (link_of(a.base[0].link.name, total(tree.base)) for tree in (a, b))
    if of_a.keys() == of_b.keys() and any(_link(whole_a, whole_b, tolerance)):
        for name, link in of_a.items():
            for kind, _, x, y, level in _link(link, of_b[name], tolerance):
                yield difference_of(kind, name, None, (x, y), level, None)


def _link(x: Link, y: Link, tolerance: Tolerance) -> Iterator[tuple[str, str, Any, Any, Level]]:
    """Kind, name and numbers of what differs of two links in one frame."""
    level = tolerance.number(x.mass, y.mass)
    if level.differs:
        yield "mass", "mass", x.mass, y.mass, level
    if x.mass and y.mass:
        level = tolerance.length(x.com, y.com)
        if level.differs:
            yield "centre of mass", "com", x.com, y.com, level
    level = tolerance.tensor(x.inertia, y.inertia, (x.mass, y.mass))
    if level.differs:
        yield "inertia", "inertia", x.inertia, y.inertia, level


def _body(k: int, x: Body, y: Body, tolerance: Tolerance) -> tuple[tuple[Member, ...] | None, list[Difference]]:
    """What differs of two bodies: link by link, where they are made of the same ones, or as a whole."""
    joint = x.joint.name
    whole_x, whole_y = link_of(x.name, x.inertia), link_of(x.name, y.inertia)
    unlike = [level for *_, level in _link(whole_x, whole_y, tolerance)]
    if not unlike:
        return None, []
    of_x, of_y = ({own.link.name: own for own in body.members if own.massive} for body in (x, y))
    if x.name in of_x and y.name in of_y and x.name != y.name:  # one link with two names
        of_y = {x.name if name == y.name else name: own for name, own in of_y.items()}
    found = [one for name, own in of_x.items() if name in of_y for one in _member(k, joint, own, of_y[name], tolerance)]
    lone = [name for name in (*of_x, *of_y) if (name in of_x) != (name in of_y)]
    if not lone:
        return None, found
    if not any(one.rounding is False for one in found):
        return None, found + [_lone(k, joint, name, of_x.get(name), of_y.get(name)) for name in lone]
    merged = (Member(whole_x),)
    own = [
        difference_of(kind, x.name, joint, (p, q), level, _changed_link(k, x.name, key, q))
        for kind, key, p, q, level in _link(whole_x, whole_y, tolerance)
    ]
    return merged, own


def _changed_link(k: int, name: str, key: str, value: Any) -> Change:
    def change(tree: RigidTree) -> RigidTree:
        return tree.changed_link(k, name, **{key: value})

    return change


def _member(k: int, joint: str, x: Member, y: Member, tolerance: Tolerance) -> list[Difference]:
    """What differs of a link of a body: where it is fixed, or what it weighs."""
    name = x.link.name
    placed = [
        ("position", tolerance.length(x.pose.p, y.pose.p), x.pose.p, y.pose.p, Pose(x.pose.R, y.pose.p)),
        ("orientation", tolerance.turn(x.pose.R, y.pose.R), rpy(x.pose.R), rpy(y.pose.R), Pose(y.pose.R, x.pose.p)),
    ]
    at = [
        difference_of(kind, name, joint, (p, q), level, _placed(k, name, kind, pose))
        for kind, level, p, q, pose in placed
        if level.differs
    ]
    own = list(_link(x.link, y.link, tolerance))
    if at:  # the body may be where it was, said in another frame
        seen = link_of(name, Member(y.link, x.pose.inverse @ y.pose).inertia)
        found = list(_link(x.link, seen, tolerance))
        if len(found) <= len(own):
            at, own = [], found
    return at + [
        difference_of(kind, name, joint, (p, q), level, _changed_link(k, name, key, q))
        for kind, key, p, q, level in own
    ]


def _placed(k: int, name: str, kind: str, pose: Pose) -> Change:
    """A link fixed elsewhere, or in another direction, on its body."""

    def change(tree: RigidTree) -> RigidTree:
        own = next(own for own in tree.bodies[k].members if own.link.name == name)
        mixed = Pose(own.pose.R, pose.p) if kind == "position" else Pose(pose.R, own.pose.p)
        return tree.changed_link(k, name, mixed)

    return change


def _lone(k: int, joint: str, name: str, x: Member | None, y: Member | None) -> Difference:
    """A link with mass that only one description has."""

    def change(tree: RigidTree) -> RigidTree:
        kept = [own for own in tree.bodies[k].members if y is not None or own.link.name != name]
        empty = [Member(Link(name))] if not kept else []
        return tree.changed(k, members=(*kept, *empty, *([] if y is None else [y])))

    masses = (x and x.link.mass, y and y.link.mass)
    return difference_of("link", name, joint, masses, UNLIKE, change)
