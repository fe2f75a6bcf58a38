"""An inspection: the tree, its bodies, the findings, the verdicts."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from rttrr_pin.errors import InputError
from rttrr_pin.inspection.bodies import centre_of_mass, tree
from rttrr_pin.inspection.check import Check, Subject
from rttrr_pin.inspection.parsers import verdicts
from rttrr_pin.inspection.reading import read_document
from rttrr_pin.inspection.results import Inspection
from rttrr_pin.inspection.table import chosen


def inspect(
    text: str,
    name: str = "<string>",
    folder: Path | None = None,
    select: Iterable[str] = (),
    ignore: Iterable[str] = (),
) -> Inspection:
    """Look at a robot's file.

    Args:
        text: the URDF, which the strict reader has let pass.
        name: what to call it in messages.
        folder: where the file lies, to find its meshes from; None leaves meshes unread.
        select: prefixes of the ids of the checks to run; none means all.
        ignore: prefixes of ids to leave out.

    Raises:
        InputError: there is no text: the robot was made from numbers.
        UnknownNameError: a prefix fits no check.
    """
    checks = chosen(select, ignore)
    if not text:
        raise InputError(f"robot {name!r} has no URDF text: inspect looks at files; load the robot from one")
    with np.errstate(all="ignore"):  # 1e308 is a number; what overflows is shown as inf, and no verdict rests on it
        return _inspected(text, name, folder, checks)


def _inspected(text: str, name: str, folder: Path | None, checks: Iterable[Check]) -> Inspection:
    document = read_document(text, name)
    subject = Subject(document, folder)
    findings = [found for check in checks for found in check.findings(subject)]
    rows = tuple(tree(document))
    mass = sum(row.mass for row in rows)
    return Inspection(
        robot=document.name,
        links=rows,
        mass=mass,
        com=centre_of_mass(document, rows, mass),
        findings=tuple(sorted(findings, key=lambda found: (found.line, found.id))),
        verdicts=verdicts(document),
        text=text,
    )
