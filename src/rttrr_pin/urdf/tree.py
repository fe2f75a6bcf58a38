"""What joints and links make together: one tree, in which each joint that follows leads to one that moves by itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from rttrr_pin.core.joints import JOINT_TYPES
from rttrr_pin.errors import listed, shortened
from rttrr_pin.urdf.document import UrdfJoint, UrdfLink
from rttrr_pin.urdf.elements import Element

LONGEST_CHAIN = 100
"""Joints that follow one another; to follow a chain takes time with the square of its length."""


def check_tree(
    links: dict[str, UrdfLink], joints: dict[str, UrdfJoint], robot: Element, elements: Mapping[str, Element]
) -> None:
    """Each link but one is the child of one joint, and all hang on that one; what does not is taken out."""
    carried = dict[str, str]()
    for name, joint in list(joints.items()):
        unknown = next((tag for tag in ("parent", "child") if getattr(joint, tag) not in links), None)
        if unknown is not None:
            link = getattr(joint, unknown)
            fix = elements[name].nearest(link, links)
            elements[name].error("joint", f"its {unknown} link {link!r} does not exist: {fix}", "the joint is left out")
        elif joint.child in carried:
            message = (
                f"link {joint.child!r} is already the child of another joint, {carried[joint.child]!r}: a tree has one "
                "joint for each link"
            )
            elements[name].assume("tree", message, "the joint is left out: the loop that it closes is not modelled")
            elements[name].remove()
        else:
            carried[joint.child] = name
            continue
        del joints[name]
    on_link: dict[str, list[str]] = {name: [] for name in links}
    for joint in joints.values():
        on_link[joint.parent].append(joint.child)
    roots = sorted(links.keys() - carried)
    reached = {root: _reached(root, on_link) for root in roots}
    kept = max(reached.values(), key=len, default=_reached(next(iter(links)), on_link))
    if len(roots) > 1:
        rest = listed(map(shortened, roots))
        message = f"has {len(roots)} root links ({rest}), expected one: join them with fixed joints"
        robot.error("tree", message, f"the {len(kept)} links on {next(iter(kept))!r} are read, the others left out")
    # From a root no loop can be entered, since each link has one parent.
    looped = links.keys() - set[str]().union(*reached.values())
    if looped:
        loop = listed(sorted(looped))
        what = "a loop of joints" if roots else "no root link, and a loop of joints"
        message = f"has {what} through {loop}: a URDF is a tree; cut the loop at one joint"
        left_out = f"the {len(kept)} links on {next(iter(kept))!r} are read, the others left out"
        robot.error("loop", message, left_out)
    for name in links.keys() - kept.keys():
        del links[name]
    root = next(iter(kept))
    for name in [name for name, joint in joints.items() if joint.parent not in kept or joint.child == root]:
        del joints[name]


def _reached(root: str, on_link: Mapping[str, list[str]]) -> dict[str, None]:
    """The links that hang on one, itself first."""
    reached, waiting = dict[str, None](), [root]
    while waiting:
        name = waiting.pop()
        if name not in reached:
            reached[name] = None
            waiting += on_link[name]
    return reached


def check_mimics(joints: dict[str, UrdfJoint], elements: Mapping[str, Element]) -> None:
    """Each <mimic> leads to a joint with one coordinate that moves by itself; one that does not is taken out."""
    for first in list(joints):
        followed, name = {first: None}, first
        while (mimic := joints[name].mimic) is not None and joints[name].moves:
            # The fault stands at the link of the chain that is wrong, be it another joint's <mimic>.
            if problem := _followed(elements[name], name, mimic.joint, joints, followed):
                element = elements[name].children("mimic")[0]
                element.assume("mimic", problem, f"joint {name!r} moves by itself", "joint")
                element.remove()
                joints[name] = replace(joints[name], mimic=None)
                break
            name = mimic.joint
            followed[name] = None


def _followed(
    element: Element, name: str, target: str, joints: Mapping[str, UrdfJoint], followed: Mapping[str, None]
) -> str:
    """Why a joint cannot follow another; empty if it can."""
    if not target:
        return "<mimic> has no joint, expected the name of the joint to follow"
    if target not in joints:
        return f"follows joint {target!r}, which does not exist: {element.nearest(target, joints)}"
    for follower in (name, target):
        if JOINT_TYPES[joints[follower].type].nq != 1:
            return f"joint {follower!r} is {joints[follower].type}: only joints with one coordinate follow"
    if target in followed:
        return f"follows itself through {' -> '.join([*followed, target])}: let one of them move by itself"
    if len(followed) >= LONGEST_CHAIN:
        return f"follows through more than {LONGEST_CHAIN} joints: let it follow the last of them"
    return ""
