"""Inspections of one robot or many: which pass, and what is told to a terminal, to JSON, SARIF and JUnit."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote_from_bytes
from xml.etree import ElementTree

from rttrr_pin.errors import RttrrError
from rttrr_pin.inspection.checks import Severity
from rttrr_pin.inspection.parsers import RULES, Behaviour
from rttrr_pin.inspection.report import columns
from rttrr_pin.inspection.run import CHECKS, Inspection
from rttrr_pin.reporting.output import shown
from rttrr_pin.version import __version__

AS_WRITTEN = (Behaviour.ACCEPT, Behaviour.WARN)
"""What a parser does that loads the robot as written."""


@dataclass(frozen=True)
class Demands:
    """What a robot must fulfil.

    Attributes:
        strict: whether warnings count as errors.
        parsers: that must load it as written.
    """

    strict: bool = False
    parsers: tuple[str, ...] = ()

    def counts(self, severity: Severity) -> bool:
        """Whether a finding of the severity is a failure."""
        return severity is Severity.ERROR or (self.strict and severity is Severity.WARNING)

    def failing(self, result: Inspection) -> list[str]:
        """The parsers that do not load a robot as written, though they must."""
        return [parser for parser in self.parsers if result.verdict(parser).behaviour not in AS_WRITTEN]

    def fulfilled(self, result: Inspection) -> bool:
        """Whether a robot passes."""
        return result.passes(self.strict) and not self.failing(result)


@dataclass(frozen=True)
class Entry:
    """A robot and its inspection.

    Attributes:
        name: what it is called among the others.
        path: its file.
        result: None where the file cannot be read.
        defect: why it cannot; else empty.
    """

    name: str
    path: Path
    result: Inspection | None
    defect: str = ""

    def verdict(self, demands: Demands) -> str:
        """PASS, FAIL, or FILE where the file cannot be read."""
        return "FILE" if self.result is None else "PASS" if demands.fulfilled(self.result) else "FAIL"


def inspect_each(robots: Mapping[str, Path], inspect: Callable[[Path], Inspection]) -> Iterator[Entry]:
    """Inspect robots one after the other; what a file is refused for stands in its entry."""
    for name, path in robots.items():
        try:
            yield Entry(name, path, inspect(path))
        except RttrrError as error:
            yield Entry(name, path, None, str(error))


def summary(entries: Sequence[Entry], demands: Demands, width: int) -> str:
    """A row for each robot, then what stops those that could not be read, then the sum."""
    heads = ("robot", "verdict", "errors", "warnings", "notes", "not loaded as written by")
    rows = [(entry.name, entry.verdict(demands), *_counts(entry)) for entry in entries]
    counts = Counter(entry.verdict(demands) for entry in entries)
    return "\n".join(
        [
            *columns(heads, rows, width),
            "",
            *(f"{entry.name}: {entry.defect}" for entry in entries if entry.defect),
            *(
                f"{entry.name}: {', '.join(failing)} would not load it as written"
                for entry in entries
                if entry.result is not None and (failing := demands.failing(entry.result))
            ),
            f"{counts['PASS']} pass, {counts['FAIL']} fail, {counts['FILE']} cannot be read, {len(entries)} in all",
        ]
    )


def _counts(entry: Entry) -> tuple[str, ...]:
    if entry.result is None:
        return ("", "", "", "")
    altering = [each.parser for each in entry.result.verdicts if each.behaviour not in AS_WRITTEN]
    return (*(str(n) for n in entry.result.counts.values()), " ".join(altering))


def to_dict(entries: Sequence[Entry], demands: Demands) -> dict[str, Any]:
    """All inspections, with a verdict for each."""
    return {
        "schema": 1,
        "robots": [
            {"name": entry.name, "path": str(entry.path), "verdict": entry.verdict(demands), "defect": entry.defect}
            | ({} if entry.result is None else {"inspection": entry.result.to_dict()})
            for entry in entries
        ],
        "counts": Counter(entry.verdict(demands) for entry in entries),
    }


LEVELS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "note"}
"""SARIF's words."""

UNREADABLE = "file"
"""The rule that a file can be read."""


def sarif(entries: Sequence[Entry], demands: Demands) -> dict[str, Any]:
    """The findings, and what the demanded parsers do, in SARIF 2.1.0 (OASIS), which code hosts show beside lines."""
    rules = [(check.id, check.statement, LEVELS[check.severity]) for check in CHECKS]
    rules += [(rule.id, rule.reason, "error") for rule in RULES if set(rule.parsers) & set(demands.parsers)]
    rules.append((UNREADABLE, "The file can be read.", "error"))
    driver = {
        "name": "rttrr-pin",
        "version": __version__,
        "rules": [
            {"id": id, "shortDescription": {"text": text}, "defaultConfiguration": {"level": level}}
            for id, text, level in rules
        ],
    }
    results = [result for entry in entries for result in _sarif_results(entry, demands)]
    return {
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{"tool": {"driver": driver}, "results": results}],
    }


def _sarif_results(entry: Entry, demands: Demands) -> Iterator[dict[str, Any]]:
    def result(rule: str, level: str, text: str, name: str = "", line: int = 0) -> dict[str, Any]:
        uri = entry.path.as_uri() if entry.path.is_absolute() else quote_from_bytes(bytes(entry.path))
        location: dict[str, Any] = {"artifactLocation": {"uri": uri}}
        location |= {"region": {"startLine": line}} if line else {}
        named = {"logicalLocations": [{"name": name}]} if name else {}
        return {
            "ruleId": rule,
            "level": level,
            "message": {"text": text},
            "locations": [{"physicalLocation": location} | named],
        }

    if entry.result is None:
        yield result(UNREADABLE, "error", entry.defect)
        return
    for each in entry.result.findings:
        level = "error" if demands.counts(each.severity) else LEVELS[each.severity]
        yield result(each.id, level, f"{each.name}: {each.reason}. {each.fix}", each.name, each.line)
    for parser in demands.failing(entry.result):
        for match in entry.result.verdict(parser).matches:
            if match.behaviour not in AS_WRITTEN:
                text = f"{parser}, {match.behaviour}: {match.name}: {match.reason}"
                yield result(match.rule, "error", text, match.name)


def junit(entries: Sequence[Entry], demands: Demands) -> str:
    """A test for each check and each parser, in JUnit's XML, which every CI server shows."""
    suites = ElementTree.Element("testsuites")
    for entry in entries:
        suite = ElementTree.SubElement(suites, "testsuite", name=entry.name, file=str(entry.path), time="0")
        for name, failed, lines in _tests(entry, demands):
            test = ElementTree.SubElement(suite, "testcase", classname=entry.name, name=name, time="0")
            text = "\n".join(lines)
            if failed:
                tag = "failure" if entry.result is not None else "error"
                ElementTree.SubElement(test, tag, type=name.split()[0], message=lines[0]).text = text
            elif lines:
                ElementTree.SubElement(test, "system-out").text = text
        for tag in ("failure", "error"):
            suite.set(f"{tag}s", str(len(suite.findall(f"testcase/{tag}"))))
        suite.set("tests", str(len(suite)))
    ElementTree.indent(suites)
    return shown(ElementTree.tostring(suites, encoding="unicode", xml_declaration=True)) + "\n"


def _tests(entry: Entry, demands: Demands) -> Iterator[tuple[str, bool, list[str]]]:
    """Name, whether it failed, and what there is to say."""
    if entry.result is None:
        yield UNREADABLE, True, [entry.defect]
        return
    for check in CHECKS:
        found = [finding for finding in entry.result.findings if finding.id == check.id]
        failed = any(demands.counts(finding.severity) for finding in found)
        lines = [f"{each.name} (line {each.line}): {each.reason}; {each.fix}" for each in found]
        yield f"{check.id} {check.statement.splitlines()[0]}", failed, lines
    for verdict in entry.result.verdicts:
        lines = [f"{match.behaviour}: {match.name}: {match.reason}" for match in verdict.matches]
        yield verdict.parser, verdict.parser in demands.failing(entry.result), lines
