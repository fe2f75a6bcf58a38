"""The strict URDF reader: what it hands on is what the file says, or an error with the line.

yourdfpy turns the XML into objects. Before that, every number that dynamics depend on is held against a grammar, since
parsers guess: `mass value="1,5"` becomes 0 in Pinocchio, a missing `izz` becomes 1 in yourdfpy.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from lxml import etree
from numpy.typing import NDArray

from rttrr_pin.errors import UrdfError
from rttrr_pin.model.sources import Source, find
from rttrr_pin.model.strict import check_document
from rttrr_pin.model.tree import Joint, JointType, Limits, Link, Model

Array = NDArray[np.float64]


def read_urdf(source: str | Path) -> Model:
    """Read a robot.

    Args:
        source: the name of a bundled robot, a path, or the text of a URDF.

    Returns:
        The model, links and joints depth first, branches in alphabetical order of their joints (Pinocchio's order).

    Raises:
        UnknownNameError: there is no such robot or file.
        UrdfError: the file is no URDF, is damaged, or says something that has no dynamics.
    """
    found = find(source)
    document = parse_xml(found)
    check_document(document, found.name)
    import yourdfpy

    etree.strip_tags(document, etree.Comment)
    robot = yourdfpy.URDF(
        robot=yourdfpy.URDF._parse_robot(xml_element=document),  # the parser alone: no scene, no meshes
        build_scene_graph=False,
        load_meshes=False,
    ).robot
    return _model(robot, found)


def parse_xml(source: Source) -> Any:
    """The root element of an XML text, with the line of each element.

    Raises:
        UrdfError: empty, binary or truncated text, or a document type (entity bombs and external entities need one).
    """
    if not source.text.strip():
        raise UrdfError("is empty, expected a URDF", source=source.name)
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False)
    try:
        root = etree.parse(io.BytesIO(source.text), parser).getroot()
    except etree.XMLSyntaxError as error:
        line = error.lineno or None
        raise UrdfError(f"is no well-formed XML: {error.msg}", source=source.name, line=line) from None
    if root.getroottree().docinfo.doctype:
        raise UrdfError("has a document type, which a URDF has no use for: remove <!DOCTYPE ...>", source=source.name)
    return root


def _model(robot: Any, source: Source) -> Model:
    """The tree in Pinocchio's order: depth first, joints alphabetically at each branch."""
    children: dict[str, list[Any]] = {}
    for joint in robot.joints:
        children.setdefault(joint.parent, []).append(joint)
    links = {link.name: link for link in robot.links}
    root = next(name for name in links if name not in {joint.child for joint in robot.joints})

    ordered: list[tuple[int, Any]] = []
    waiting = [(-1, joint) for joint in _last_first(children.get(root, []))]
    while waiting:
        parent, joint = waiting.pop()
        waiting += [(len(ordered), child) for child in _last_first(children.get(joint.child, []))]
        ordered.append((parent, joint))
    return Model(
        name=robot.name,
        root=_link(links[root]),
        links=tuple(_link(links[joint.child]) for _, joint in ordered),
        joints=tuple(_joint(joint, parent) for parent, joint in ordered),
        urdf=source.text.decode("utf-8-sig"),
    )


def _last_first(joints: Sequence[Any]) -> list[Any]:
    return sorted(joints, key=lambda joint: joint.name, reverse=True)


def _link(link: Any) -> Link:
    """A link; its tensor turned into the axes of the link frame."""
    inertial = link.inertial
    if inertial is None:
        return Link(link.name)
    R, com = _placement(inertial.origin)
    rotated = not np.array_equal(R, np.eye(3))
    inertia = R @ inertial.inertia @ R.T if rotated else inertial.inertia
    return Link(link.name, float(inertial.mass), com, (inertia + inertia.T) / 2, rotated)


def _joint(joint: Any, parent: int) -> Joint:
    """A joint on the link of index `parent`."""
    R, p = _placement(joint.origin)
    kind = JointType(joint.type)
    axis = np.asarray(joint.axis, dtype=float)
    if kind is not JointType.FIXED:
        axis = axis / np.linalg.norm(axis)
    return Joint(
        name=joint.name,
        type=kind,
        parent=parent,
        R=R,
        p=p,
        axis=axis,
        limits=_limits(joint.limit, kind),
        rotated=not np.array_equal(R, np.eye(3)),
    )


def _placement(origin: Array | None) -> tuple[Array, Array]:
    """Rotation and translation of an <origin>, the identity where there is none."""
    if origin is None:
        return np.eye(3), np.zeros(3)
    return origin[:3, :3] + 0.0, origin[:3, 3]


def _limits(limit: Any, kind: JointType) -> Limits:
    """The limits that the file sets; a continuous joint's angle has none."""
    if limit is None:
        return Limits()
    set_ = {key: getattr(limit, key) for key in ("lower", "upper", "velocity", "effort")}
    if kind is JointType.CONTINUOUS:
        set_["lower"] = set_["upper"] = None
    return Limits(**{key: float(value) for key, value in set_.items() if value is not None})
