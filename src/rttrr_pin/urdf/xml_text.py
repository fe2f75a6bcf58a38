"""XML text to elements with line numbers: what is no plain, complete XML document in UTF-8 is refused here."""

from __future__ import annotations

import io
import re
from typing import Any

from lxml import etree

from rttrr_pin.errors import UrdfError
from rttrr_pin.urdf.sources import Source

UTF_8 = ("UTF-8", "UTF8", "ASCII", "US-ASCII")


def parse_xml(source: Source) -> Any:
    """The root element of an XML text, with the line of each element; comments and processing instructions are gone.

    The line is where the start tag ends; beyond line 65,534 libxml2 may be off by the length of the text behind it.

    Raises:
        UrdfError: empty, binary or truncated text, another encoding than UTF-8, or a document type (entity bombs and
            external entities need one).
    """
    if not source.text.strip():
        raise UrdfError("is empty, expected a URDF", source=source.name)
    _check_encoding(source)
    parser = etree.XMLParser(
        encoding="utf-8",
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        huge_tree=False,
        remove_comments=True,
        remove_pis=True,
    )
    try:
        root = etree.parse(io.BytesIO(source.text), parser).getroot()
    except etree.XMLSyntaxError as error:
        if b"<!DOCTYPE" in _without_comments(source.text):
            raise _doctype(source) from None
        line = error.lineno or None
        raise UrdfError(
            f"is no well-formed XML: {error.msg or 'it cannot be parsed'}", source=source.name, line=line
        ) from None
    info = root.getroottree().docinfo
    if info.doctype or info.internalDTD is not None:
        raise _doctype(source)
    return root


def _check_encoding(source: Source) -> None:
    """Pinocchio reads every file as UTF-8, whatever it declares: only files that are UTF-8 mean the same to all."""
    try:
        text = source.text.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = source.text.count(b"\n", 0, error.start) + 1
        raise UrdfError(
            f"is no well-formed XML: byte {source.text[error.start]:#04x} is not UTF-8; save it as UTF-8 text",
            source=source.name,
            line=line,
        ) from None
    declared = re.match(r"<\?xml[^>]*?encoding\s*=\s*[\"']([^\"']*)[\"']", text.lstrip())
    if declared and declared[1].upper() not in UTF_8 and source.name != "<string>" and not text.isascii():
        raise UrdfError(f"declares the encoding {declared[1]}: save it as UTF-8", source=source.name, line=1)


def _doctype(source: Source) -> UrdfError:
    text = _without_comments(source.text)
    line = text.count(b"\n", 0, max(text.find(b"<!DOCTYPE"), 0)) + 1
    return UrdfError(
        "has a document type, which a URDF has no use for: remove <!DOCTYPE ...> and write its entities out",
        source=source.name,
        line=line,
    )


def _without_comments(text: bytes) -> bytes:
    """The text with only the line ends of its comments left; in linear time, which a regular expression is not."""
    kept, at = [], 0
    while (start := text.find(b"<!--", at)) >= 0 and (end := text.find(b"-->", start + 4)) >= 0:
        kept += [text[at:start], b"\n" * text.count(b"\n", start, end)]
        at = end + 3
    return b"".join([*kept, text[at:]])
