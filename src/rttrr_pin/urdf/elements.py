"""XML text to elements that know their line: what is no plain, complete XML document in UTF-8 is refused here."""

from __future__ import annotations

import io
import re
from typing import Any

from lxml import etree

from rttrr_pin.errors import UrdfError, shortened
from rttrr_pin.urdf.decimals import NUMBER, Number, NumberList, beyond_doubles
from rttrr_pin.urdf.sources import Source

UTF_8 = ("UTF-8", "UTF8", "ASCII", "US-ASCII")

BLANKS = " \t\r\n"
"""The blanks of XML, no others (Python knows more)."""


class Element:
    """An XML element with what is needed to say where it is."""

    def __init__(self, xml: Any, source: str, label: str) -> None:
        self.xml, self.source, self.label = xml, source, label

    @property
    def line(self) -> int:
        """Its line in the file."""
        return int(self.xml.sourceline)

    def error(self, message: str) -> UrdfError:
        """An error at this element's line."""
        return UrdfError(message, source=self.source, line=self.line, element=self.label)

    def children(self, tag: str) -> list[Element]:
        """The children of that tag."""
        return [Element(xml, self.source, tag) for xml in self.xml.findall(tag)]

    def child(self, tag: str) -> Element | None:
        """The only child of that tag, if there is one: of several, parsers silently take the first or the last."""
        children = self.xml.findall(tag)
        if len(children) > 1:
            raise self.error(f"has {len(children)} <{tag}> elements, expected at most one: remove the others")
        return Element(children[0], self.source, self.label) if children else None

    def needed(self, tag: str, why: str) -> Element:
        """The child of that tag, which must be there."""
        child = self.child(tag)
        if child is None:
            raise self.error(f"has no <{tag}>, {why}")
        return child

    def text(self, attribute: str, why: str) -> str:
        """An attribute that must be there and not be empty."""
        value = self.xml.get(attribute)
        if value is None or not value.strip():
            raise self.error(f"<{self.xml.tag}> has no {attribute}, {why}")
        return str(value)

    def number(self, attribute: str, default: str | None = None) -> Number:
        """A finite decimal number; errors as those of `numbers`."""
        return Number(self.numbers(attribute, 1, default).text)

    def numbers(self, attribute: str, count: int, default: str | None = None) -> NumberList:
        """`count` finite decimal numbers.

        Raises:
            UrdfError: there are more or fewer, or one of them is not a number that float64 can hold.
        """
        text = self.xml.get(attribute, default)
        if text is None:
            raise self.error(f'<{self.xml.tag}> has no {attribute}: write {attribute}="..." with the value')
        words = re.split(f"[{BLANKS}]+", text.strip(BLANKS)) if text.strip() else []
        where = f'<{self.xml.tag} {attribute}="{shortened(text)}">'
        if len(words) != count:
            raise self.error(f"{where} has {len(words)} values, expected {count}{_hint(text)}")
        for word in words:
            self._check_number(word, where)
        return NumberList(text)

    def _check_number(self, word: str, where: str) -> None:
        shown = shortened(word)
        if not NUMBER.fullmatch(word):
            raise self.error(f"{where}: {shown!r} is not a decimal number{_hint(word)}")
        if fault := beyond_doubles(word):
            raise self.error(f"{where}: {fault}")


def _hint(text: str) -> str:
    """What is often meant by text that is no number."""
    if "," in text:
        return ": write a point for the decimals and spaces between values"
    if re.search(r"\d\s*[a-zA-Z]+$", text) and not text.lower().startswith(("0x", "-0x")):
        return ": write it without its unit (URDF is in m, kg, rad, s)"
    if "${" in text or "$(" in text:
        return ": this is xacro, run xacro on it first"
    return ": write digits with a point"


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
    # lxml's defaults are spelt out where a file could reach for others, or grow: no DTD, no network, no huge trees.
    parser = etree.XMLParser(
        encoding="utf-8", resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False,
        remove_comments=True, remove_pis=True,
    )  # fmt: skip
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
