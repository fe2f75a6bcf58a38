"""XML text to elements that know their line, and that log what is wrong with them."""

from __future__ import annotations

import io
import re
from collections.abc import Iterable
from typing import Any
from xml.parsers import expat

from lxml import etree

from rttrr_pin.errors import UrdfError, nearest, shortened
from rttrr_pin.urdf.decimals import NUMBER, Number, NumberList, beyond_doubles
from rttrr_pin.urdf.faults import Fault, Level, Log
from rttrr_pin.urdf.sources import Source

UTF_8 = ("UTF-8", "UTF8", "ASCII", "US-ASCII")

BLANKS = " \t\r\n"
"""The blanks of XML, no others (Python knows more)."""

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

UNEXPANDED = "this is xacro, which must be expanded: add --xacro (xacro=True), or run xacro on it"
"""What is wrong with a value such as ${mass}."""

MOST_ATTRIBUTES = 1000
"""Of an element; other parsers take time with the square of them."""

MOST_HINTS = 20
"""Names that are looked for among those that are known."""

QUOTED_NUMBERS = re.compile(rb"""(["'])([0-9eE+. -]*[\t\r\n][0-9eE+. \t\r\n-]*)\1""")
"""Numbers in quotation marks with a tab or line end among them."""

NAMED = re.compile(rb"\b(?:name|link|joint)\s*=\s*$")
"""What stands before a name, which may look like numbers."""

MOST_BEFORE = 64
"""Characters of that, blanks included."""


class Element:
    """An XML element with what is needed to say where it is.

    What is read in place of a number or element that is missing or wrong is written into the element too, so that the
    tree says what was assumed.
    """

    def __init__(self, xml: Any, log: Log, tag: str = "robot", name: str = "") -> None:
        self.xml, self.log, self.tag, self.name = xml, log, tag, name

    @property
    def line(self) -> int:
        """Its line in the file."""
        return int(self.xml.sourceline or 0)

    def fault(self, kind: str, level: Level, message: str, assumed: str = "", attribute: str = "") -> None:
        """Log a fault at this element's line, of one of its attributes or of another kind."""
        where = (kind, level, self.tag, self.name, self.line, shown(self.xml))
        self.log.faults.append(
            Fault(*where, message, assumed, attribute, self.xml.get(attribute) if attribute else None)
        )

    def assume(self, kind: str, message: str, assumed: str, attribute: str = "") -> None:
        """Log what a number depends on, and what is read in its place: nothing for what xacro would write."""
        self.fault(kind, Level.ERROR if UNEXPANDED in message else Level.ASSUMPTION, message, assumed, attribute)

    def error(self, kind: str, message: str, left_out: str) -> None:
        """Log what makes no robot, and what is left out."""
        self.fault(kind, Level.ERROR, message, left_out)

    def note(self, kind: str, message: str, attribute: str = "") -> None:
        """Log what no number depends on."""
        self.fault(kind, Level.NOTE, message, attribute=attribute)

    def nearest(self, got: str, known: Iterable[str]) -> str:
        """The hint that follows an unknown name; none after many, since each looks through all names."""
        self.log.hints += 1
        return nearest(got, sorted(known)) if self.log.hints <= MOST_HINTS else "check its name"

    def children(self, tag: str) -> list[Element]:
        """The children of that tag."""
        return [Element(xml, self.log, self.tag, self.name) for xml in self.xml.findall(tag)]

    def child(self, tag: str, used: bool = True) -> Element | None:
        """The only child of that tag, if there is one: of several, the first, as most parsers have it."""
        children = self.children(tag)
        if len(children) > 1:
            message = f"has {len(children)} <{tag}> elements, expected at most one: remove the others"
            if not used or len({_content(child.xml) for child in children}) == 1:
                self.note("twice", message)
            else:
                self.assume("twice", message, f"the first <{tag}>")
            for child in children[1:]:
                child.remove()
        return children[0] if children else None

    def added(self, tag: str, **attributes: str) -> Element:
        """A new child."""
        self.log.changed = True
        xml = etree.SubElement(self.xml, tag, attributes)
        return Element(xml, self.log, self.tag, self.name)

    def write(self, **attributes: str) -> None:
        """Set attributes to what was assumed."""
        self.log.changed = True
        self.xml.attrib.update(attributes)

    def remove(self) -> None:
        """Take the element out."""
        self.log.changed = True
        self.xml.getparent().remove(self.xml)

    def text(self, attribute: str) -> str:
        """An attribute; empty where there is none."""
        value = str(self.xml.get(attribute, ""))
        return value if value.strip() else ""

    def number(self, attribute: str, default: str | None = None, fallback: str = "0") -> Number:
        """A finite decimal number; see `numbers`."""
        return Number(self.numbers(attribute, 1, default, fallback).text)

    def numbers(self, attribute: str, count: int, default: str | None, fallback: str) -> NumberList:
        """`count` finite decimal numbers.

        Args:
            attribute: that holds them.
            count: how many there should be.
            default: what the format says where there is none; None where it wants one.
            fallback: what is read where there is none, or what is there is no number.
        """
        problem = self.problem(attribute, count, default)
        if not problem:
            return NumberList(self.xml.get(attribute, default))
        self.assume("number", problem, f'<{self.xml.tag} {attribute}="{fallback}">', attribute)
        self.write(**{attribute: fallback})
        return NumberList(fallback)

    def problem(self, attribute: str, count: int = 1, default: str | None = None) -> str:
        """Why an attribute is not so many numbers; empty if it is."""
        text = self.xml.get(attribute, default)
        if text is None:
            return f'<{self.xml.tag}> has no {attribute}: write {attribute}="..." with the value'
        words = re.split(f"[{BLANKS}]+", text.strip(BLANKS)) if text.strip() else []
        where = f'<{self.xml.tag} {attribute}="{shortened(text)}">'
        if len(words) != count:
            return f"{where} has {len(words)} values, expected {count}{_hint(text)}"
        return next((f"{where}: {problem}" for problem in map(_problem, words) if problem), "")


def shown(xml: Any) -> str:
    """The tag as the file writes it."""
    word = xml.tag.rpartition("}")[2]
    return shortened(f"{xml.prefix}:{word}" if xml.prefix else word)


def _content(xml: Any) -> object:
    """What two equal elements share."""
    return xml.tag, tuple(sorted(xml.attrib.items())), tuple(map(_content, xml.iterchildren("{*}*")))


def _problem(word: str) -> str:
    """Why a word is no number that float64 can hold; empty if it is one."""
    if not NUMBER.fullmatch(word):
        return f"{shortened(word)!r} is not a decimal number{_hint(word)}"
    return beyond_doubles(word)


def _hint(text: str) -> str:
    """What is often meant by text that is no number."""
    if "," in text:
        return ": write a point for the decimals and spaces between values"
    if re.search(r"\d\s*[a-zA-Z]+$", text) and not text.lower().startswith(("0x", "-0x")):
        return ": write it without its unit (URDF is in m, kg, rad, s)"
    if "${" in text or "$(" in text:
        return f": {UNEXPANDED}"
    return ": write digits with a point"


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
