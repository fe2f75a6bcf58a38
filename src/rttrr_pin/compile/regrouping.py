"""Base-parameter regrouping: inertia moved from link to link without a change of any driving force.

Where only driving forces are asked for, single links do not matter, and a program with fewer numbers that are not zero
is shorter. What of a link's inertia its carrier may take is the joint type's to say (`JointType.regrouped`); whether
the carrier can take it is said here.

Inertias are added up in the robot's own numbers: floats, or such that know their error (`ConstantWithError`), so that
moving inertia counts in the kernel's bounds like any other rounding.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from rttrr_pin.core.inertia import SpatialInertia
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.model import Model

LEAST_MASS = 1 / 16
"""A carrier must be left with this part of the masses whose first moments it takes. Else, where masses cancel or the
carrier is light, its centre of mass would lie so far away that its tensor drowns in rounding; without mass, it has no
centre of mass."""


def regroup(model: Model, links: Sequence[Body]) -> tuple[Model, list[Body]]:
    """The robot with the same driving forces at every motion, and fewer numbers that are not zero.

    Args:
        model: the robot.
        links: its links and joints, as scalars that are floats.

    Returns:
        As many links and joints, in the same order: the tree, in which no joint stands on a fixed one, and its links,
        which single are no longer those of the file. The numbers in the model are, and are not to be used.
    """
    model, bodies = _carried_by_moving_links(model, list(links))
    own_mass = [_size(body.M) for body in bodies]
    taken_mass = [0.0] * len(bodies)  # sum of |M| of the links whose mass or first moment a link has taken

    def taken(i: int, moved: SpatialInertia, parent: int) -> bool:
        """Whether the carrier takes what link i would give it."""
        if parent < 0 or not (moved.m != 0.0 or any(moved.h)):
            return True  # the root stands still, and a tensor alone needs no mass
        gross = taken_mass[parent] + _size(bodies[i].M)
        if not _size(bodies[parent].M + moved.m) >= LEAST_MASS * max(own_mass[parent], gross):
            return False
        taken_mass[parent] = gross
        return True

    inwards = reversed(range(len(bodies)))
    for i in sorted(inwards, key=lambda i: model.joints[i].nv > 0):  # fixed links first: they are one body with theirs
        parent = model.joints[i].parent
        for first_moment in (True, False):
            parts = bodies[i].type.regrouped(bodies[i], first_moment)
            if parts is None or _is_nothing(parts[1]):
                break
            rest, moved = parts
            if taken(i, moved, parent):
                if parent >= 0:
                    bodies[parent] = _with(bodies[parent], moved.moved(bodies[i].R, bodies[i].p))
                bodies[i] = rest
                break
    return model, bodies


def _carried_by_moving_links(model: Model, bodies: list[Body]) -> tuple[Model, list[Body]]:
    """Joints on fixed links moved to the links that carry those."""
    joints = list(model.joints)
    for i, joint in enumerate(joints):
        at, body = joint.parent, bodies[i]
        if at >= 0 and not joints[at].nv:
            R, p = bodies[at].R, bodies[at].p
            joints[i] = replace(joint, parent=joints[at].parent)
            bodies[i] = replace(body, R=R @ body.R, p=p + R @ body.p)
    return replace(model, joints=tuple(joints)), bodies


def _with(body: Body, more: SpatialInertia) -> Body:
    """The link with more inertia."""
    total = SpatialInertia.of(body.M, body.r_C, body.I) + more
    com, tensor = total.about_com()
    return replace(body, M=total.m, r_C=com, I=(tensor + tensor.T) * 0.5)


def _size(mass: Any) -> float:
    return abs(float(mass))


def _is_nothing(inertia: SpatialInertia) -> bool:
    return not (inertia.m != 0.0 or any(inertia.h) or any(x != 0.0 for row in inertia.J.rows for x in row))
