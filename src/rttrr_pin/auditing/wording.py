"""The sentences of an audit, for the terminal and for the errata sheet alike."""

from __future__ import annotations

from collections.abc import Mapping

from rttrr_pin.auditing.differences import Kind
from rttrr_pin.auditing.evidence import Evidence
from rttrr_pin.auditing.results import AuditResult, ComponentAudit, ConventionCheck, Finding, Totals, Verdict
from rttrr_pin.reporting.results import counted

MEANING: Mapping[Kind, str] = {
    Kind.RATE: "a dot, or the power of a rate, lost or added",
    Kind.SIGN: "plus for minus, or minus for plus",
    Kind.COEFFICIENT: "another number in front",
    Kind.SYMBOL: "another symbol, or one lost or added",
    Kind.EXTRA: "a term that should not be there",
    Kind.MISSING: "a term that should be there and is not",
    Kind.DUPLICATE: "a right term, printed a second time",
}
"""The meaning of each kind of finding."""


def verdict_words(component: ComponentAudit) -> str:
    """The verdict as a cell of a table."""
    if component.verdict is Verdict.DIFFERS:
        return counted(len(component.findings), "finding")
    return {Verdict.MATCH: "match", Verdict.UNPARSED: "not read", Verdict.UNDECLARED: "undeclared"}[component.verdict]


def dimension_words(finding: Finding) -> str:
    """Whether the printed term has the right dimension; a dash where nothing is printed."""
    return {True: "right", False: "wrong", None: "-"}[finding.dimension_ok]


def dimension_summary(totals: Totals) -> str:
    """The number of printed terms that need no derivation to be known as wrong; empty where there are none."""
    number = totals.dimensionally_wrong
    have = "has" if number == 1 else "have"
    text = f"{counted(number, 'printed term')} {have} the wrong dimension: wrong without any derivation"
    return text if number else ""


def convention_words(check: ConventionCheck) -> str:
    """A convention, and the findings when it is read the other way."""
    text = " ".join(check.convention.text.split())
    if check.findings is None:
        return text
    return (
        f"{text} Read so, the equations that it touches have {counted(check.findings, 'finding')}; "
        f"read the other way, {check.otherwise}."
    )


def evidence_words(audit: AuditResult, component: ComponentAudit) -> list[str]:
    """The evidence on a component, one sentence each."""
    if component.evidence is None:
        return []
    right = not component.findings
    equation = "printed" if right else "corrected"
    proof = "is symbolically equal" if component.proven else "could not be shown symbolically equal"
    return [
        _numbers(component.evidence, component.unit, audit.seed, right),
        _intervals(component.evidence, right),
        f"The {equation} equation {proof} to the derivation.",
    ]


def _numbers(evidence: Evidence, unit: str, seed: int, right: bool) -> str:
    def off(error: float | None) -> str:
        return "0" if error == 0.0 else f"{error:.2g} {unit}"

    head = f"At a random state (seed {seed}) Pinocchio gives {evidence.pinocchio:.6g} {unit}"
    corrected = off(evidence.corrected_off)
    if right:
        return f"{head}; the printed equation is off by {corrected}."
    if evidence.printed_off is None:
        return f"{head}; the printed equation has a symbol without a number, the corrected one is off by {corrected}."
    return f"{head}; the printed equation is off by {off(evidence.printed_off)}, the corrected one by {corrected}."


def _intervals(evidence: Evidence, right: bool) -> str:
    """What enclosures of the exact values say."""
    equation = "printed" if right else "corrected"
    meets = "meets" if evidence.enclosed else "does not meet"
    sentence = f"In interval arithmetic the {equation} equation {meets} the recursion"
    if right or evidence.excluded is None:
        return f"{sentence}."
    printed = "lies apart from it: proven wrong" if evidence.excluded else "meets it too at this state"
    return f"{sentence}; the printed one {printed}."
