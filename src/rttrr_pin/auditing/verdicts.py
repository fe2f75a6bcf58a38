"""What an audit says: a verdict for each component, with its findings, its corrected text and its evidence."""

from __future__ import annotations

import enum
from dataclasses import dataclass

from rttrr_pin.auditing.evidence import Evidence
from rttrr_pin.auditing.findings import Finding
from rttrr_pin.auditing.publication import Convention, Publication


class Verdict(enum.StrEnum):
    """What the audit says of a component."""

    MATCH = "match"
    DIFFERS = "differs"
    UNPARSED = "unparsed"


@dataclass(frozen=True, slots=True)
class ComponentAudit:
    """One component of one equation.

    Attributes:
        equation: its number.
        quantity: its name, such as F5z.
        line: where the equation starts in the published text; 0 where that is not known.
        printed_terms: how many terms are printed, brackets expanded.
        derived_terms: how many there should be, in the form that the text chose.
        verdict: match, differs or unparsed.
        findings: what is wrong.
        notes: readings of ambiguous or stray tokens in terms that match, and of lost boundaries.
        unparsed: why it could not be read; empty where it could.
        corrected: the right-hand side as it should be printed, term by term, each with whether it was changed.
        proven: whether the corrected text, read again, is symbolically equal to the derivation.
        evidence: what numbers say; None where it could not be read.
    """

    equation: int | str
    quantity: str
    line: int
    printed_terms: int
    derived_terms: int
    verdict: Verdict
    findings: tuple[Finding, ...] = ()
    notes: tuple[str, ...] = ()
    unparsed: str = ""
    corrected: tuple[tuple[str, bool], ...] = ()
    proven: bool = False
    evidence: Evidence | None = None


@dataclass(frozen=True, slots=True)
class ConventionCheck:
    """A convention, and how the equations would fare with the other one.

    Attributes:
        convention: what is read, and how.
        findings: how many findings there are with it; None where there is no other to try.
        otherwise: how many there would be with the other.
    """

    convention: Convention
    findings: int | None = None
    otherwise: int | None = None


@dataclass(frozen=True)
class Audit:
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
    def all_right(self) -> bool:
        """Whether every component is right as printed."""
        return all(component.verdict is Verdict.MATCH for component in self.components)

    def count(self, verdict: Verdict) -> int:
        """How many components have a verdict."""
        return sum(component.verdict is verdict for component in self.components)
