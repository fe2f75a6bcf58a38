"""What a check is: a row of a table, and the function that it runs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from rttrr_pin.inspection.reading import Body, Connection, Document
from rttrr_pin.inspection.results import Edit, Finding, Severity
from rttrr_pin.inspection.shapes import Looks, looks_of


@dataclass(frozen=True)
class Subject:
    """What checks look at.

    Attributes:
        document: the file.
        folder: where the file lies, to find meshes from; None where it is a text.
    """

    document: Document
    folder: Path | None
    _looks: dict[str, Looks] = field(default_factory=dict)

    def looks(self, body: Body) -> Looks:
        """The geometry of a link, loaded once."""
        if body.name not in self._looks:
            self._looks[body.name] = looks_of(body, self.folder)
        return self._looks[body.name]

    @property
    def links(self) -> dict[str, Body]:
        """The links by name."""
        return self.document.links


@dataclass(frozen=True)
class Observation:
    """What the function of a check found at one place; the check adds its id and severity."""

    at: Body | Connection | Document
    value: float | None
    unit: str
    reason: str
    fix: str
    repair: tuple[Edit, ...] = ()


@dataclass(frozen=True)
class Check:
    """A row of the table of checks.

    Attributes:
        id: stable; its letter is the kind of check: P physics, G geometry, T twins, J joints, C consumers.
        severity: of its findings.
        statement: what holds for a file that passes.
        find: what looks for places where it does not.
    """

    id: str
    severity: Severity
    statement: str
    find: Callable[[Subject], Iterator[Observation]]

    def findings(self, subject: Subject) -> Iterator[Finding]:
        """The check's findings in a file."""
        for seen in self.find(subject):
            kind = {Body: "link", Connection: "joint", Document: "robot"}[type(seen.at)]
            line = 0 if isinstance(seen.at, Document) else seen.at.line
            yield Finding(
                self.id, self.severity, kind, seen.at.name, line,
                seen.value, seen.unit, seen.reason, seen.fix, seen.repair,
            )  # fmt: skip
