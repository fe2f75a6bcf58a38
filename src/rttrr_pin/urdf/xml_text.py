"""XML text to a tree whose elements know their line; what is wrong with the text as faults."""

from __future__ import annotations

import io
import re
from typing import Any
from xml.parsers import expat

from lxml import etree

from rttrr_pin.errors import UrdfError
from rttrr_pin.urdf.faults import Fault, Level, Log
from rttrr_pin.urdf.sources import Source

UTF_8 = ("UTF-8", "UTF8", "ASCII", "US-ASCII")

LET_THROUGH = {
    "ERR_UNKNOWN_VERSION": ("declaration", 'the XML declaration names another version: write version="1.0"'),
    "ERR_VERSION_MISSING": ("declaration", 'the XML declaration names no version: write version="1.0"'),
    "ERR_RESERVED_XML_NAME": ("declaration", "an XML declaration stands behind other text: move it to the start"),
    "ERR_HYPHEN_IN_COMMENT": ("comment", "a comment holds two hyphens: write one"),
    "ERR_DOCUMENT_END": ("behind", "something stands behind </robot>, which no parser reads"),
    "NS_ERR_UNDEFINED_NAMESPACE": ("namespace", "the prefix is not declared"),
}
"""Errors of libxml2 that leave the tree whole: the kind of the fault, and its message."""

MOST_ERRORS = 100
"""libxml2 tells no more of them (XML_MAX_ERRORS): what is wrong behind them it does not say."""

MOST_ATTRIBUTES = 1000
"""Of an element; other parsers take time with the square of them."""

QUOTED_NUMBERS = re.compile(rb"""(["'])([0-9eE+. -]*[\t\r\n][0-9eE+. \t\r\n-]*)\1""")
"""Numbers in quotation marks with a tab or line end among them."""

NAMED = re.compile(rb"\b(?:name|link|joint)\s*=\s*$")
"""What stands before a name, which may look like numbers."""

MOST_BEFORE = 64
"""Characters of that, blanks included."""


def parse_xml(source: Source, log: Log) -> Any:
    """The root element of an XML text, with the line of each element; comments and processing instructions are gone.

    The line is where the start tag ends; beyond line 65,534 libxml2 may be off by the length of the text behind it.

    Raises:
        UrdfError: empty, binary or truncated text, another encoding than UTF-8, or a document type (entity bombs and
            external entities need one).
    """
    if not source.text.strip():
        raise UrdfError("is empty, expected a URDF", source=source.name)
    _check_encoding(source)
    # lxml's defaults are spelt out where a file could reach for others, or grow: no DTD, no network, no huge trees.
    parser = etree.XMLParser(
        encoding="utf-8", resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False,
        remove_comments=True, remove_pis=True, recover=True,
    )  # fmt: skip
    try:
        root = etree.parse(io.BytesIO(_with_blanks(source.text)), parser).getroot()
    except etree.XMLSyntaxError:
        root = None
    if parser.error_log and b"<!DOCTYPE" in _without_comments(source.text):
        raise _doctype(source)
    _log_errors(parser.error_log, root, log)
    if len(parser.error_log) >= MOST_ERRORS:
        _check_whole(source)
    if root is None:
        raise UrdfError("is no well-formed XML: it cannot be parsed", source=source.name)
    info = root.getroottree().docinfo
    if info.doctype or info.internalDTD is not None:
        raise _doctype(source)
    for element in root.iter():
        if (many := len(element.attrib)) > MOST_ATTRIBUTES:
            message = f"an element has {many:,} attributes, expected {MOST_ATTRIBUTES} at most: is it a URDF?"
            raise UrdfError(message, source=source.name, line=element.sourceline)
    return root


def _log_errors(errors: Any, root: Any, log: Log) -> None:
    """What libxml2 says, as faults; it goes on behind an error, and the tree is whole after those in `LET_THROUGH`."""
    seen = set[tuple[str, int]]()
    for error in errors:
        if error.level_name == "WARNING" or (error.domain_name == "NAMESPACE" and error.type_name not in LET_THROUGH):
            continue  # an odd or empty name of a namespace
        if root is None or error.type_name not in LET_THROUGH:
            message = error.message or "it cannot be parsed"
            raise UrdfError(f"is no well-formed XML: {message}", source=log.source, line=error.line or None)
        kind, message = LET_THROUGH[error.type_name]
        if (kind, error.line) not in seen:
            log.faults.append(Fault(kind, Level.NOTE, "robot", "", error.line, "", message))
        seen.add((kind, error.line))


def _check_whole(source: Source) -> None:
    """That expat finds no error but in comments and prefixes: it knows of no namespaces."""
    try:
        expat.ParserCreate().Parse(_without_comments(source.text), True)
    except expat.ExpatError as error:
        message = f"is no well-formed XML: {expat.ErrorString(error.code)}, behind {MOST_ERRORS} other errors"
        raise UrdfError(message, source=source.name, line=error.lineno) from None


def _with_blanks(text: bytes) -> bytes:
    """The text with tabs and line ends between numbers written so that they are kept.

    XML makes spaces of them, but parsers of URDF do not. The line ends are put behind the closing quotation mark again.
    In names they are spaces, whatever the name is.
    """

    def kept(match: re.Match[bytes]) -> bytes:
        if NAMED.search(text, max(0, match.start() - MOST_BEFORE), match.start()):
            return match[0]
        value = match[2].replace(b"\r\n", b"\n").replace(b"\r", b"\n")
        lines = match[2].count(b"\n")
        return match[1] + value.replace(b"\t", b"&#9;").replace(b"\n", b"&#10;") + match[1] + b"\n" * lines

    return QUOTED_NUMBERS.sub(kept, text)


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
