"""Inspections as a page: what is wrong, by how bad it is, where in the file and in the robot, and how to mend it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence

import numpy as np

from rttrr_pin.core.joints import JOINT_TYPES
from rttrr_pin.errors import listed
from rttrr_pin.inspection.checks import Finding, Severity
from rttrr_pin.inspection.many import AS_WRITTEN, Demands, Entry
from rttrr_pin.inspection.parsers import MEANING, Behaviour, Verdict
from rttrr_pin.inspection.report import HEADS, MOST_PLACES, link_cells, link_labels
from rttrr_pin.inspection.run import CHECKS, Inspection
from rttrr_pin.reporting.html import Bars, Block, Bone, Causes, Chart, Figures, Page, Rows, Said, drawing, points
from rttrr_pin.reporting.html.skeleton import kind_of_type
from rttrr_pin.reporting.results import counted
from rttrr_pin.urdf.document import UrdfDocument

TONES = {Severity.ERROR: "bad", Severity.WARNING: "warn", Severity.NOTE: "dim"}

TITLES = {Severity.ERROR: "Errors", Severity.WARNING: "Warnings", Severity.NOTE: "Notes"}

MOST = 200
"""Findings of one severity that a page shows; the JSON has all."""

BEHAVIOURS = {Behaviour.ACCEPT: "good", Behaviour.REFUSE: "bad"}
"""Tones; of the others, warn."""


def inspection_page(result: Inspection, demands: Demands, path: str) -> Page:
    """What the page says of one file."""
    passed = demands.fulfilled(result)
    counts = ", ".join(counted(number, severity) for severity, number in result.counts.items())
    failing = demands.failing(result)
    return Page(
        title=result.robot,
        compared=f"{path}: {len(result.links)} links, {result.mass:.6g} kg",
        verdict="PASS" if passed else "FAIL",
        tone=("explained" if result.counts[Severity.WARNING] else "agrees") if passed else "unexplained",
        sentence=f"{counts}{f'; {listed(failing, 9)} would not load it as written' if failing else ''}",
        facts=(
            ("mass", f"{result.mass:.6g} kg"),
            ("centre of mass in the root's frame", f"{_triple(result.com.tolist())} m"),
            ("links", f"{len(result.links)}"),
            ("parsers that load it as written", f"{_loading(result.verdicts)} of {len(result.verdicts)}"),
        ),
        blocks=(
            *_findings(result),
            *_drawing(result),
            Rows(
                "What each parser does", ("parser", "", "what, and why"), tuple(map(_parser, result.verdicts)), texts=3
            ),
            _links(result),
        ),
        command="inspect",
    )


def _loading(verdicts: Sequence[Verdict]) -> int:
    return sum(verdict.behaviour in AS_WRITTEN for verdict in verdicts)


def _triple(values: Sequence[float]) -> str:
    return ", ".join(f"{x:.4g}" for x in values)


def _findings(result: Inspection) -> Iterator[Block]:
    """The worst first."""
    for severity in Severity:
        own = [finding for finding in result.findings if finding.severity is severity]
        if own:
            yield Causes(tuple(map(_said, own[:MOST])), title=f"{TITLES[severity]} ({len(own)})", numbered=False)
        if len(own) > MOST:
            yield from points("", (f"and {len(own) - MOST} more, which --json has",))


def _said(finding: Finding) -> Said:
    edits = ", ".join(f"{edit.attribute} = {edit.text}" for edit in finding.repair)
    facts = (
        ("where", f"{finding.kind} {finding.name}{f', line {finding.line}' if finding.line else ''}"),
        ("what to do", finding.fix),
        ("certain repair, which --fix writes", edits),
        ("check", finding.id),
    )
    kept = tuple(fact for fact in facts if fact[1])
    return Said(finding.reason, kept, tone=TONES[finding.severity], word=f"{finding.severity} {finding.name}:")


def _drawing(result: Inspection) -> Iterator[Figures]:
    """The robot, all coordinates zero, with the links and joints that errors, or else warnings, are about."""
    if result.document is None:
        return
    worst = next((x for x in (Severity.ERROR, Severity.WARNING) if result.counts[x]), None)
    names = {finding.name for finding in result.findings if finding.severity is worst}
    title = f"{result.robot}, all coordinates zero"
    legend = f"Marked: what {TITLES[worst].lower()} are about." if worst else ""
    yield Figures("Where in the robot", (picture(result.document, names, title),), legend)


def picture(document: UrdfDocument, marked: Collection[str], title: str) -> Chart:
    """The robot of a file; names of links and joints stand out."""
    bones, places = list[Bone](), dict[str, int]()
    for _, name in document.walk():
        joint, (R, p) = document.carried_by.get(name), document.placements[name]
        inertial = document.links[name].inertial
        com = None if inertial is None or not float(inertial.mass) else p + R @ inertial.origin.p
        kind, axis = "root", np.zeros(3)
        if joint is not None:
            kind = kind_of_type(JOINT_TYPES[joint.type])
            axis = np.array(joint.axis.floats)
            axis = R @ (axis / (float(np.linalg.norm(axis)) or 1.0))
        places[name] = len(bones)
        bones.append(Bone(name, -1 if joint is None else places[joint.parent], kind, R, p, axis, com))
    carried = {joint.name: joint.child for joint in document.joints.values()}
    return drawing(bones, {carried.get(name, name) for name in marked} | set(marked), None, "robot", title)


def _parser(verdict: Verdict) -> Bars:
    """What it does, and for which links or joints."""
    names: dict[tuple[Behaviour, str], list[str]] = {}
    for match in verdict.matches:
        names.setdefault((match.behaviour, match.reason), []).append(match.name)
    why = [f"{behaviour}: {reason}: {listed(own, MOST_PLACES)}" for (behaviour, reason), own in names.items()]
    tone = BEHAVIOURS.get(verdict.behaviour, "warn")
    return Bars((verdict.parser, str(verdict.behaviour), "\n".join([MEANING[verdict.behaviour], *why])), tone=tone)


def _links(result: Inspection) -> Rows:
    """The tree of links, and the body that each is."""
    labels = link_labels(result.links)
    rows = (Bars((label, *link_cells(link))) for label, link in zip(labels, result.links, strict=True))
    return Rows("Links", HEADS, tuple(rows), texts=len(HEADS))


STATEMENTS = {check.id: check.statement.splitlines()[0] for check in CHECKS}

WORDS = {"PASS": "good", "FAIL": "bad", "FILE": "warn"}


def many_page(entries: Sequence[Entry], demands: Demands) -> Page:
    """What the page says of many files: a row for each."""
    verdicts = [entry.verdict(demands) for entry in entries]
    counts = Counter(verdicts)
    worst = "FAIL" if counts["FAIL"] else "FILE" if counts["FILE"] else "PASS"
    checks = Counter(
        (finding.id, finding.severity)
        for entry in entries
        if entry.result is not None
        for finding in entry.result.findings
    )
    rows = tuple(map(_row, entries, verdicts))
    head = ("", "robot", "errors", "warnings", "notes", "not loaded as written by")
    told = f"{counts['PASS']} pass, {counts['FAIL']} fail, {counts['FILE']} cannot be read, {len(entries)} in all"
    order = sorted(checks.items(), key=lambda item: (list(Severity).index(item[0][1]), -item[1], item[0][0]))
    return Page(
        title=f"{len(entries)} robots",
        compared="what is wrong with their files, and what other programs do with them",
        verdict=worst,
        tone={"PASS": "agrees", "FILE": "explained", "FAIL": "unexplained"}[worst],
        sentence=told,
        blocks=(
            *points("Files that cannot be read", (f"{x.name}: {x.defect}" for x in entries if x.defect)),
            Rows("Robot by robot", head, rows, texts=len(head)),
            Rows(
                "Findings by check",
                ("", "check", "what does not hold", "findings"),
                tuple(Bars((str(kind), id, STATEMENTS[id], f"{n:,}"), tone=TONES[kind]) for (id, kind), n in order),
                texts=3,
            ),
        ),
        command="inspect",
    )


def _row(entry: Entry, verdict: str) -> Bars:
    if entry.result is None:
        return Bars((verdict, entry.name, "", "", "", ""), tone=WORDS[verdict])
    altering = [each.parser for each in entry.result.verdicts if each.behaviour not in AS_WRITTEN]
    numbers = (str(number or "") for number in entry.result.counts.values())
    return Bars((verdict, entry.name, *numbers, ", ".join(altering)), tone=WORDS[verdict])
