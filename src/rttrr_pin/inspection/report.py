"""Inspections as text and as data."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.errors import listed
from rttrr_pin.inspection.bodies import LinkRow
from rttrr_pin.inspection.checks import Finding, Severity
from rttrr_pin.inspection.parsers import MEANING, Behaviour, Verdict

if TYPE_CHECKING:
    from rttrr_pin.inspection.run import Inspection, Repaired

MOST_LINKS = 40
"""Beyond it the table shows the first links, unless all are asked for."""

MOST_ALIKE = 5
"""Findings of one check that are shown, unless all are asked for."""

MOST_PLACES = 3
"""Links or joints that are named for one rule of a parser."""

HEADS = ("link", "body", "mass [kg]", "joint", "centre of mass [m]", "principal moments [kg m^2]", "semi-axes [m]")
"""The columns, the most wanted first: from the right they are left out until a line fits."""


def summary(result: Inspection, full: bool, width: int) -> str:
    """Links, findings, what each parser does, and the count."""
    shown = result.links if full else result.links[:MOST_LINKS]
    lines = [
        _wrapped(
            f"{result.robot}: {len(result.links)} links, {result.mass:.6g} kg, centre of mass ({_triple(result.com)}) "
            f"m in the frame of {result.links[0].name}",
            width,
        ),
        "",
        *_tree(shown, width),
    ]
    if len(shown) < len(result.links):
        lines.append(f"the first {len(shown)} of {len(result.links)} links; --full shows all")
    lines += ["", *_findings(result.findings, full, width)] if result.findings else []
    lines += ["", *(line for verdict in result.verdicts for line in _verdict(verdict, width))]
    counts = ", ".join(f"{n} {severity}{'' if n == 1 else 's'}" for severity, n in result.counts.items())
    return "\n".join([*lines, "", f"{'PASS' if result.passed else 'FAIL'} {counts}"])


def repair_summary(repaired: Repaired, path: str) -> str:
    """What was mended in the file written, and what was left."""
    lines = [
        f"mended {finding.id} {finding.name}: "
        + ", ".join(f"{edit.attribute} = {edit.text}" for edit in finding.repair)
        for finding in repaired.done
    ]
    left = sum(finding.severity is not Severity.NOTE for finding in repaired.left)
    return "\n".join([*lines, f"{path}: {len(repaired.done)} mended, {left} errors and warnings left as they are"])


def to_dict(result: Inspection) -> dict[str, Any]:
    """The whole inspection."""
    return {
        "schema": 1,
        "robot": result.robot,
        "passed": result.passed,
        "mass": result.mass,
        "com": result.com.tolist(),
        "links": [_link_data(link) for link in result.links],
        "findings": [asdict(finding) for finding in result.findings],
        "parsers": {
            verdict.parser: {
                "behaviour": str(verdict.behaviour),
                "meaning": MEANING[verdict.behaviour],
                "rules": [asdict(match) for match in verdict.matches],
            }
            for verdict in result.verdicts
        },
        "counts": {str(severity): count for severity, count in result.counts.items()},
    }


def repair_data(repaired: Repaired) -> dict[str, Any]:
    """What was mended, and what was left."""
    return {
        "mended": [asdict(finding) for finding in repaired.done],
        "left": [asdict(finding) for finding in repaired.left],
    }


def _link_data(link: LinkRow) -> dict[str, Any]:
    return {key: value.tolist() if isinstance(value, np.ndarray) else value for key, value in vars(link).items()}


def _tree(links: Sequence[LinkRow], width: int) -> Iterator[str]:
    """The table of links; the only link on another stands below it, of several each is marked and indented."""
    labels = list(link_labels(links))
    return columns(HEADS, [(label, *link_cells(link)) for label, link in zip(labels, links, strict=True)], width)


def columns(heads: tuple[str, ...], rows: Sequence[tuple[str, ...]], width: int) -> Iterator[str]:
    """A table without the columns that do not fit, the first two whole in any case."""
    widths = [max(map(len, column)) for column in zip(heads, *rows, strict=True)]
    fitting = len(heads)
    while fitting > 2 and sum(widths[:fitting]) + 2 * (fitting - 1) > width:
        fitting -= 1
    for row in (heads, *rows):
        yield "  ".join(cell.ljust(size) for cell, size in zip(row[:fitting], widths, strict=False)).rstrip()


def link_labels(links: Sequence[LinkRow]) -> Iterator[str]:
    """Names, indented by the branchings before them: a chain of any length needs no room."""
    path, parents, levels = list[int](), list[int](), list[int]()
    for k, link in enumerate(links):
        del path[link.depth :]
        parents.append(path[-1] if path else -1)
        path.append(k)
    carried = Counter(parents)
    for link, parent in zip(links, parents, strict=True):
        several = parent >= 0 and carried[parent] > 1
        levels.append((levels[parent] if parent >= 0 else 0) + several)
        yield "  " * (levels[-1] - several) + "- " * several + link.name


def link_cells(link: LinkRow) -> tuple[str, ...]:
    """The cells of a row of the table behind the link's name."""
    joint = f"{link.joint} ({link.joint_type})" if link.joint else "root"
    massless = not link.mass and not link.moments.any()
    body = ("", "") if massless else (_triple(link.com), _triple(link.moments))
    axes = "" if np.isnan(link.semi_axes).any() else _triple(link.semi_axes)
    return (str(link.shape), f"{link.mass:.5g}", joint, *body, axes)


def _findings(findings: Iterable[Finding], full: bool, width: int) -> Iterator[str]:
    counts: dict[str, int] = {}
    for finding in sorted(findings, key=lambda each: (list(Severity).index(each.severity), each.id, each.line)):
        counts[finding.id] = counts.get(finding.id, 0) + 1
        if full or counts[finding.id] <= MOST_ALIKE:
            line = f" (line {finding.line})" if finding.line else ""
            yield _wrapped(f"{finding.severity} {finding.id} {finding.name}{line}: {finding.reason}", width)
            yield _wrapped(f"    {finding.fix}", width)
    more = [f"{count - MOST_ALIKE} {check}" for check, count in counts.items() if count > MOST_ALIKE]
    if more and not full:
        yield f"and more of the same kind: {', '.join(more)}; --full shows all"


def _verdict(verdict: Verdict, width: int) -> Iterator[str]:
    yield f"{verdict.parser}: {verdict.behaviour} ({MEANING[verdict.behaviour]})"
    names_of: dict[tuple[Behaviour, str], list[str]] = {}
    for match in verdict.matches:
        names_of.setdefault((match.behaviour, match.reason), []).append(match.name)
    for behaviour, reason in sorted(names_of, key=lambda rule: -list(Behaviour).index(rule[0])):
        names = names_of[behaviour, reason]
        yield _wrapped(f"    {behaviour}: {reason}: {listed(names, MOST_PLACES)}", width)


def _wrapped(text: str, width: int) -> str:
    """Long lines broken between words, names and numbers whole."""
    return fill(text, max(width, 40), subsequent_indent="    ", break_long_words=False, break_on_hyphens=False)


def _triple(x: Array) -> str:
    return " ".join(f"{value:.4g}" for value in x)
