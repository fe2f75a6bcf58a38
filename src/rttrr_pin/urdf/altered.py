"""The document of a robot that was altered since it was read: what the text says then, for programs that read it.

Everything else in the text stays as it stands.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from lxml import etree

from rttrr_pin.core.arrays import angles_of
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.model import Document, Link, Model
from rttrr_pin.urdf.document import UrdfDocument
from rttrr_pin.urdf.parser import read_document
from rttrr_pin.urdf.sources import Source
from rttrr_pin.urdf.writer import urdf_text, written

OF_MOVING = ("origin", "axis", "limit", "mimic", "dynamics", "calibration", "safety_controller")
"""What a joint that is locked loses; it gets another <origin>."""


def with_body(document: Document, link: Link, joint: Joint, parent: str) -> Document:
    """A document with a link more, on a joint."""
    assert isinstance(document, UrdfDocument)
    own = Model(document.name, Link(parent), (link,), (replace(joint, parent=-1),))
    text = urdf_text(own).encode()
    added = read_document(Source(document.source, text))
    root = _parsed(document.text.encode())
    for element in list(_parsed(text))[1:]:  # all but the parent
        for part in element.iter():
            part.tag = _prefix(root) + part.tag
        root.append(element)
    return replace(
        document,
        text=etree.tostring(root, encoding="unicode"),
        links=document.links | {link.name: added.links[link.name]},
        joints=document.joints | added.joints,
    )


def with_fixed(document: Document, model: Model) -> Document:
    """A document in whose text locked joints are fixed at their placements; links and joints still are the file's.

    No text has the joint of a floating base: where it is locked, it is put in, with a link to stand on.
    """
    assert isinstance(document, UrdfDocument)
    root = _parsed(document.text.encode())
    prefix = _prefix(root)
    elements = {element.get("name"): element for element in root.iterfind(f"{prefix}joint")}
    for joint, link in zip(model.joints, model.links, strict=True):
        if joint.lock is None:
            continue
        if joint.name not in elements:
            etree.SubElement(root, f"{prefix}link", name=model.root.name)
            elements[joint.name] = etree.SubElement(root, f"{prefix}joint", name=joint.name)
            for tag, name in (("parent", model.root.name), ("child", link.name)):
                etree.SubElement(elements[joint.name], f"{prefix}{tag}", link=name)
        element = elements[joint.name]
        element.set("type", "fixed")
        for child in [child for tag in OF_MOVING for child in element.iterfind(prefix + tag)]:
            element.remove(child)
        etree.SubElement(element, f"{prefix}origin", xyz=written(joint.p), rpy=written(angles_of(joint.R)))
    return replace(document, text=etree.tostring(root, encoding="unicode"))


def _parsed(text: bytes) -> Any:
    """The outermost element of a text that was read before."""
    parser = etree.XMLParser(encoding="utf-8", resolve_entities=False, no_network=True, load_dtd=False, recover=True)
    return etree.fromstring(text, parser)


def _prefix(root: Any) -> str:
    """The default namespace, as tags have it; mostly there is none."""
    tag: str = root.tag
    return tag[: tag.rfind("}") + 1]
