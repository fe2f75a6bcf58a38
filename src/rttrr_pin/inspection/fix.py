"""Certain repairs, written into the file's own text: only the values change, every other byte stays."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from xml.parsers import expat

from rttrr_pin.inspection.results import Edit, Finding
from rttrr_pin.inspection.run import Inspection

WHERE = ("robot", "link", "inertial")
"""The elements around the tags that are edited."""


@dataclass(frozen=True)
class Repaired:
    """A repaired file.

    Attributes:
        text: its text.
        done: the findings that were mended.
        left: the findings that were not.
    """

    text: str
    done: tuple[Finding, ...]
    left: tuple[Finding, ...]


def repair(inspection: Inspection) -> Repaired:
    """Make all repairs that are certain.

    A link with more than one finding is left alone: its numbers have no one certain meaning.
    """
    doubtful = _doubtful(inspection.findings)
    done = [finding for finding in inspection.findings if finding.repair and finding.name not in doubtful]
    edits = [edit for finding in done for edit in finding.repair]
    return Repaired(
        text=apply(inspection.text, edits),
        done=tuple(done),
        left=tuple(finding for finding in inspection.findings if finding not in done),
    )


def _doubtful(findings: Iterable[Finding]) -> set[str]:
    """Links for which two findings would write different numbers."""
    repairs: dict[str, set[tuple[Edit, ...]]] = {}
    for finding in findings:
        if finding.kind == "link" and finding.repair:
            repairs.setdefault(finding.name, set()).add(finding.repair)
    return {name for name, several in repairs.items() if len(several) > 1}


def apply(text: str, edits: Iterable[Edit]) -> str:
    """Write new values of attributes into the text of a URDF.

    Args:
        text: the URDF.
        edits: the new values; the attributes are there.
    """
    wanted: dict[tuple[str, str], list[Edit]] = {}
    for edit in edits:
        wanted.setdefault((edit.link, edit.tag), []).append(edit)
    whole = text.encode()
    for start, key in sorted(_Tags.of(whole).starts, reverse=True):
        for edit in wanted.get(key, ()):
            whole = whole[:start] + _replaced(whole[start:], edit)
    return whole.decode()


def _replaced(tail: bytes, edit: Edit) -> bytes:
    """The text from a tag on, with one attribute of that tag changed; its quotation marks stay."""
    pattern = rf"(\s{edit.attribute}\s*=\s*)(\"[^\"]*\"|'[^']*')".encode()
    return re.sub(pattern, lambda match: match[1] + match[2][:1] + edit.text.encode() + match[2][-1:], tail, count=1)


@dataclass
class _Tags:
    """Where the tags inside each link's <inertial> begin, in bytes."""

    path: list[str] = field(default_factory=list)
    link: str = ""
    starts: list[tuple[int, tuple[str, str]]] = field(default_factory=list)

    @classmethod
    def of(cls, text: bytes) -> _Tags:
        tags, parser = cls(), expat.ParserCreate("utf-8")

        def start(tag: str, attributes: dict[str, str]) -> None:
            if tuple(tags.path) == WHERE[:1] and tag == "link":
                tags.link = attributes.get("name", "")
            if tuple(tags.path) == WHERE:
                tags.starts.append((parser.CurrentByteIndex, (tags.link, tag)))
            tags.path.append(tag)

        parser.StartElementHandler = start
        parser.EndElementHandler = lambda tag: tags.path.pop()
        parser.Parse(text, True)
        return tags
