"""XML elements that know their line, and that log what is wrong with them."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from lxml import etree

from rttrr_pin.errors import nearest, shortened
from rttrr_pin.urdf.decimals import NUMBER, Number, NumberList, beyond_doubles
from rttrr_pin.urdf.faults import Fault, Level, Log

BLANKS = " \t\r\n"
"""The blanks of XML, no others (Python knows more)."""

UNEXPANDED = "this is xacro, which must be expanded: add --xacro (xacro=True), or run xacro on it"
"""What is wrong with a value such as ${mass}."""

MOST_HINTS = 20
"""Names that are looked for among those that are known."""


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
