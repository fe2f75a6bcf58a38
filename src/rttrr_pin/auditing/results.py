"""The results of an audit: a verdict for each component, with its findings, its corrected text and its evidence."""

from __future__ import annotations

import enum
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from rttrr_pin.auditing.differences import Kind
from rttrr_pin.auditing.evidence import Evidence
from rttrr_pin.auditing.publication import DEFINITION, Convention, Publication
from rttrr_pin.reporting.results import Summarised, counted, finite

SCHEMA = 1
"""Of the JSON; it grows when a key changes its meaning or goes."""


class Verdict(enum.StrEnum):
    """The verdict on a component."""

    MATCH = "match"
    DIFFERS = "differs"
    UNPARSED = "unparsed"
    UNDECLARED = "undeclared"


@dataclass(frozen=True, slots=True)
class Finding:
    """One error.

    Attributes:
        id: the component and a number, such as F5z.3; in printed order, then what is missing.
        kind: what went wrong.
        printed: the term as printed; None where it is missing.
        derived: the term that is right, in the language of the publication; None where there should be none.
        dimension_ok: whether the printed term has the dimension of its quantity, which needs no derivation; None
            where nothing is printed.
        note: how an ambiguous or stray token was read, and how the error may have come about.
    """

    id: str
    kind: Kind
    printed: str | None
    derived: str | None
    dimension_ok: bool | None
    note: str = ""


@dataclass(frozen=True, slots=True)
class ComponentAudit:
    """One component of one equation.

    Attributes:
        equation: its number.
        quantity: its name, such as F5z.
        line: where the equation starts in the published text; 0 where that is not known.
        printed_terms: the number of printed terms, brackets expanded.
        derived_terms: the number of derived terms, in the form that the text chose.
        verdict: match, differs, unparsed (the text cannot be read) or undeclared (it has symbols that the file of
            equations does not declare, so that nothing can be said of it).
        unit: of the component.
        findings: what is wrong.
        notes: readings of ambiguous or stray tokens in terms that match, and of lost boundaries.
        unparsed: why it could not be read, and where; empty where it could.
        undeclared: for each spelling that no symbol has, what to declare.
        corrected: the right-hand side as it should be printed, term by term, each with whether it was changed.
        proven: whether the corrected text, read again, is symbolically equal to the derivation.
        evidence: numbers; None where there is no verdict on the terms.
    """

    equation: int | str
    quantity: str
    line: int
    printed_terms: int
    derived_terms: int
    verdict: Verdict
    unit: str = ""
    findings: tuple[Finding, ...] = ()
    notes: tuple[str, ...] = ()
    unparsed: str = ""
    undeclared: tuple[str, ...] = ()
    corrected: tuple[tuple[str, bool], ...] = ()
    proven: bool = False
    evidence: Evidence | None = None

    @property
    def by_term(self) -> list[list[Finding]]:
        """Findings by the term that they are about: one term may have several errors, and they follow each other."""
        groups: list[list[Finding]] = []
        for finding in self.findings:
            last = groups[-1][-1] if groups else None
            if last and finding.derived and (last.printed, last.derived) == (finding.printed, finding.derived):
                groups[-1].append(finding)
            else:
                groups.append([finding])
        return groups

    def to_dict(self) -> dict[str, Any]:
        """The component as data for JSON."""
        findings = [{**asdict(finding), "kind": str(finding.kind)} for finding in self.findings]
        corrected = [{"term": term, "changed": changed} for term, changed in self.corrected]
        return {**asdict(self), "verdict": str(self.verdict), "findings": findings, "corrected": corrected}


@dataclass(frozen=True, slots=True)
class ConventionCheck:
    """A convention, and the findings with the other one.

    Attributes:
        convention: what is read, and how.
        findings: the number of findings with it, in the equations that it touches; None where there is no other to try.
        otherwise: the number of findings with the other.
    """

    convention: Convention
    findings: int | None = None
    otherwise: int | None = None


@dataclass(frozen=True, slots=True)
class Totals:
    """An audit in numbers.

    Attributes:
        components: the number of components.
        verdicts: the number of components with each verdict.
        kinds: the number of findings of each kind.
        findings: the number of findings.
        dimensionally_wrong: the number of printed terms that have the wrong dimension, which needs no derivation.
    """

    components: int
    verdicts: Mapping[Verdict, int]
    kinds: Mapping[Kind, int]
    findings: int
    dimensionally_wrong: int


@dataclass(frozen=True, eq=False, repr=False)
class AuditResult(Summarised):
    """The audit of a publication.

    Attributes:
        publication: what was audited.
        components: in the order of the equations.
        conventions: what the text leaves to the reader.
        seed: of the state at which numbers were compared.
    """

    publication: Publication
    components: tuple[ComponentAudit, ...]
    conventions: tuple[ConventionCheck, ...]
    seed: int

    @property
    def findings(self) -> list[Finding]:
        """All findings."""
        return [finding for component in self.components for finding in component.findings]

    @property
    def passed(self) -> bool:
        """Whether every component is right as printed."""
        return all(component.verdict is Verdict.MATCH for component in self.components)

    @property
    def totals(self) -> Totals:
        """Verdicts, kinds and dimensions, counted."""
        verdicts, kinds = Counter(x.verdict for x in self.components), Counter(x.kind for x in self.findings)
        groups = [group for component in self.components for group in component.by_term]
        return Totals(
            len(self.components),
            {verdict: verdicts[verdict] for verdict in Verdict},
            {kind: kinds[kind] for kind in Kind},
            len(self.findings),
            sum(group[0].dimension_ok is False for group in groups),
        )

    @property
    def definitions(self) -> list[int | str]:
        """The numbers of the equations that only define symbols."""
        return [equation.number for equation in self.publication.equations if equation.quantity == DEFINITION]

    @property
    def notes(self) -> tuple[str, ...]:
        """What was assumed of the robot's file, or left out."""
        return tuple(note.text for note in self.publication.robot.model.notes)

    def count(self, verdict: Verdict) -> int:
        """The number of components with a verdict."""
        return self.totals.verdicts[verdict]

    def summary(self) -> str:
        """Verdicts and findings in one line: `35 match, 25 differ; 136 findings`."""
        words = dict(zip(Verdict, ("match", "differ", "not read", "with undeclared symbols"), strict=True))
        counts = ((verdict, number) for verdict, number in self.totals.verdicts.items())
        shown = ", ".join(f"{n} {words[verdict]}" for verdict, n in counts if n or verdict is Verdict.MATCH)
        return f"{shown}; {counted(self.totals.findings, 'finding')}"

    def to_dict(self) -> dict[str, Any]:
        """The whole audit as data for JSON."""
        totals, publication = self.totals, self.publication
        return finite(
            {
                "schema": SCHEMA,
                "passed": self.passed,
                "title": publication.title,
                "source": publication.source,
                "language": publication.language,
                "equations": [equation.number for equation in publication.equations],
                "seed": self.seed,
                "notes": list(self.notes),
                "totals": {
                    "components": totals.components,
                    **{str(verdict): number for verdict, number in totals.verdicts.items()},
                    "findings": totals.findings,
                    "kinds": {str(kind): number for kind, number in totals.kinds.items()},
                    "dimensionally_wrong": totals.dimensionally_wrong,
                },
                "conventions": [
                    {**asdict(check.convention), "findings": check.findings, "otherwise": check.otherwise}
                    for check in self.conventions
                ],
                "components": [component.to_dict() for component in self.components],
            }
        )


def cells(components: Sequence[ComponentAudit]) -> Iterator[tuple[str, str, dict[str, ComponentAudit]]]:
    """For each equation its number, the quantity that it states, and its components by axis; a scalar has none."""
    rows: dict[tuple[str, str], dict[str, ComponentAudit]] = {}
    for component in components:
        axis = component.quantity[-1] if component.quantity[-1] in "xyz" else ""
        quantity = component.quantity.removesuffix(axis)
        rows.setdefault((str(component.equation), quantity), {})[axis] = component
    return ((number, quantity, row) for (number, quantity), row in rows.items())
