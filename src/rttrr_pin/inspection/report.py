"""Inspections as tables and as JSON."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from typing import Any

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Column, Table
from rich.text import Text

from rttrr_pin.core.arrays import Array
from rttrr_pin.inspection import Does, Finding, Inspection, LinkRow, Repaired, Severity, Verdict
from rttrr_pin.inspection.exact import Shape
from rttrr_pin.inspection.results import MEANING

MOST_LINKS = 40
"""Beyond it the table shows the first links, unless all are asked for."""

MOST_ALIKE = 5
"""Findings of one check that are shown, unless all are asked for."""

MOST_PLACES = 3
"""Links or joints that are named for one rule of a consumer."""

COLOURS = {
    Severity.ERROR: "bold red", Severity.WARNING: "yellow", Severity.NOTE: "dim",
    Does.ACCEPT: "green", Does.WARN: "yellow", Does.ALTER: "bold yellow", Does.EITHER: "yellow",
    Does.REFUSE: "bold red",
}  # fmt: skip


def show_inspection(result: Inspection, console: Console, full: bool = False) -> None:
    """The tree and its bodies, the findings, what each consumer does, and the count."""
    console.print(Text(result.robot, "bold"), Text(f"{len(result.links)} links, {result.mass:.6g} kg, centre of mass"))
    console.print(Text(f"({_triple(result.com)}) m in the frame of {result.links[0].name}, all coordinates zero"))
    shown = result.links if full else result.links[:MOST_LINKS]
    console.print(_tree_table(shown))
    if len(shown) < len(result.links):
        console.print(Text(f"the first {len(shown)} of {len(result.links)} links; --full shows all"))
    if result.findings:
        _show_findings(result.findings, console, full)
    console.print(_verdict_table(result.verdicts))
    counts = ", ".join(f"{n} {severity}{'' if n == 1 else 's'}" for severity, n in result.counts.items())
    console.print(Text("PASS", "bold green") if result.passes() else Text("FAIL", "bold red"), Text(counts))


def show_repair(repaired: Repaired, path: str, console: Console) -> None:
    """What was mended in the file written, and what was left."""
    for found in repaired.done:
        changes = ", ".join(f"{edit.attribute} = {edit.text}" for edit in found.repair)
        console.print(Text(f"mended {found.id} {found.name}: {changes}"))
    left = sum(found.severity is not Severity.NOTE for found in repaired.left)
    console.print(Text(f"{path}: {len(repaired.done)} mended, {left} errors and warnings left as they are"))


def inspection_data(result: Inspection) -> dict[str, Any]:
    """The whole inspection."""
    return {
        "robot": result.robot,
        "mass": result.mass,
        "com": result.com.tolist(),
        "links": [_link_data(row) for row in result.links],
        "findings": [_finding_data(found) for found in result.findings],
        "consumers": {
            verdict.consumer: {
                "does": str(verdict.does),
                "meaning": MEANING[verdict.does],
                "rules": [asdict(hit) for hit in verdict.hits],
            }
            for verdict in result.verdicts
        },
        "counts": {str(severity): count for severity, count in result.counts.items()},
        "verdict": "pass" if result.passes() else "fail",
    }


def repair_data(repaired: Repaired) -> dict[str, Any]:
    """What was mended, and what was left."""
    return {
        "mended": [_finding_data(found) for found in repaired.done],
        "left": [_finding_data(found) for found in repaired.left],
    }


def _link_data(row: LinkRow) -> dict[str, Any]:
    values = {key: getattr(row, key) for key in LinkRow.__dataclass_fields__}
    return {key: value.tolist() if isinstance(value, np.ndarray) else value for key, value in values.items()}


def _finding_data(found: Finding) -> dict[str, Any]:
    return {**asdict(found), "severity": str(found.severity)}


def _tree_table(rows: Iterable[LinkRow]) -> Table:
    heads = ("link", "joint", "mass [kg]", "centre of mass [m]", "principal moments [kg m^2]",
             "ellipsoid semi-axes [m]", "body")  # fmt: skip
    table = Table(*(Column(Text(head)) for head in heads), box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    table.columns[2].justify = "right"
    for row in rows:
        body = ("", "", "") if not row.mass and not row.moments.any() else (_triple(row.com), _triple(row.moments), "")
        axes = "" if np.isnan(row.semi_axes).any() else _triple(row.semi_axes)
        joint = f"{row.joint} ({row.joint_type})" if row.joint else "root"
        colour = "bold red" if row.shape is Shape.IMPOSSIBLE else ""
        table.add_row(Text("  " * row.depth + row.name), Text(joint), f"{row.mass:.5g}", body[0], body[1], axes,
                      Text(row.shape, colour))  # fmt: skip
    return table


def _show_findings(findings: tuple[Finding, ...], console: Console, full: bool) -> None:
    table = Table("id", "", "line", "where", "what", "fix", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    seen: dict[str, int] = {}
    for found in sorted(findings, key=lambda found: (list(Severity).index(found.severity), found.id, found.line)):
        seen[found.id] = seen.get(found.id, 0) + 1
        if full or seen[found.id] <= MOST_ALIKE:
            table.add_row(found.id, Text(found.severity, COLOURS[found.severity]), str(found.line or ""),
                          Text(found.name), Text(found.reason), Text(found.fix))  # fmt: skip
    console.print(table)
    more = {check: count - MOST_ALIKE for check, count in seen.items() if count > MOST_ALIKE}
    if more and not full:
        told = ", ".join(f"{count} {check}" for check, count in more.items())
        console.print(Text(f"and more of the same kind: {told}; --full shows all"))


def _verdict_table(verdicts: Iterable[Verdict]) -> Table:
    table = Table("consumer", "does", "why", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for verdict in verdicts:
        places: dict[tuple[Does, str], list[str]] = {}
        for hit in verdict.hits:
            places.setdefault((hit.does, hit.reason), []).append(hit.name)
        ranked = sorted(places.items(), key=lambda item: -list(Does).index(item[0][0]))
        why = "\n".join(f"{does}: {reason}: {_some(names)}" for (does, reason), names in ranked)
        table.add_row(verdict.consumer, Text(verdict.does, COLOURS[verdict.does]), Text(why or MEANING[verdict.does]))
    return table


def _some(names: list[str]) -> str:
    return ", ".join(names[:MOST_PLACES]) + (
        f" and {len(names) - MOST_PLACES} more" if len(names) > MOST_PLACES else ""
    )


def _triple(x: Array) -> str:
    return " ".join(f"{value:.4g}" for value in x)
