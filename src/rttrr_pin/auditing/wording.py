"""What an audit found, in words: for the terminal and for the errata sheet alike."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from rttrr_pin.auditing.audit import dimension_of
from rttrr_pin.auditing.edits import Kind
from rttrr_pin.auditing.evidence import Evidence
from rttrr_pin.auditing.findings import Finding
from rttrr_pin.auditing.publication import DEFINITION, Equation, Publication
from rttrr_pin.auditing.verdicts import Audit, ComponentAudit, ConventionCheck, Verdict
from rttrr_pin.derivation.symbols import ACCELERATION, FORCE, MOMENT, Dimension

MEANING: Mapping[Kind, str] = {
    Kind.RATE: "a dot, or the power of a rate, lost or added",
    Kind.SIGN: "plus for minus, or minus for plus",
    Kind.COEFFICIENT: "another number in front",
    Kind.SYMBOL: "another letter, or one lost or added",
    Kind.EXTRA: "a term that should not be there",
    Kind.MISSING: "a term that should be there and is not",
    Kind.DUPLICATE: "a right term, printed a second time",
}
"""What each kind of finding is."""

UNITS: Mapping[Dimension, str] = {ACCELERATION: "m/s^2", FORCE: "N", MOMENT: "N m"}
"""The unit of each quantity."""


@dataclass(frozen=True, slots=True)
class Totals:
    """An audit in numbers.

    Attributes:
        verdicts: how many components have each.
        kinds: how many findings there are of each kind.
        findings: how many in all.
        dimensionally_wrong: how many printed terms have the wrong dimension, which needs no derivation.
    """

    verdicts: Mapping[Verdict, int]
    kinds: Mapping[Kind, int]
    findings: int
    dimensionally_wrong: int

    @property
    def components(self) -> int:
        """How many components there are."""
        return sum(self.verdicts.values())


def totals(components: Iterable[ComponentAudit]) -> Totals:
    """Verdicts, kinds and dimensions, counted."""
    every = list(components)
    findings = [finding for component in every for finding in component.findings]
    verdicts, kinds = Counter(component.verdict for component in every), Counter(f.kind for f in findings)
    wrong = sum(group[0].dimension_ok is False for component in every for group in by_term(component.findings))
    return Totals(
        {verdict: verdicts[verdict] for verdict in Verdict},
        {kind: kinds[kind] for kind in Kind},
        len(findings),
        wrong,
    )


def by_term(findings: Sequence[Finding]) -> Iterator[list[Finding]]:
    """Findings by the term that they are about: one term may have several slips, and they follow each other."""
    group: list[Finding] = []
    for finding in findings:
        if group and (finding.derived is None or (finding.printed, finding.derived) != _term(group[-1])):
            yield group
            group = []
        group.append(finding)
    if group:
        yield group


def _term(finding: Finding) -> tuple[str | None, str | None]:
    return finding.printed, finding.derived


def counted(number: int, what: str) -> str:
    """Such as `1 finding`, `2 findings`."""
    return f"{number} {what}{'' if number == 1 else 's'}"


def verdict_words(component: ComponentAudit) -> str:
    """The verdict as a cell of a table."""
    if component.verdict is Verdict.DIFFERS:
        return counted(len(component.findings), "finding")
    return {Verdict.MATCH: "match", Verdict.UNPARSED: "not read"}[component.verdict]


def cells(components: Iterable[ComponentAudit]) -> dict[tuple[str, str], dict[str, ComponentAudit]]:
    """For each equation and the quantity that it states, its components by axis; that of a scalar has no axis."""
    rows: dict[tuple[str, str], dict[str, ComponentAudit]] = {}
    for component in components:
        quantity, axis = _split(component.quantity)
        rows.setdefault((str(component.equation), quantity), {})[axis] = component
    return rows


def _split(name: str) -> tuple[str, str]:
    return (name[:-1], name[-1]) if name[-1] in "xyz" else (name, "")


def unit(publication: Publication, component: ComponentAudit) -> str:
    """The unit of a component."""
    stating = equation_of(publication, component)
    return "" if stating is None else UNITS[dimension_of(publication.robot.model, stating)]


def equation_of(publication: Publication, component: ComponentAudit) -> Equation | None:
    """The equation that states a component."""
    return next((equation for equation in publication.equations if component.quantity in equation.names), None)


def definitions(publication: Publication) -> list[int | str]:
    """The numbers of the equations that only define letters."""
    return [equation.number for equation in publication.equations if equation.quantity == DEFINITION]


def dimension_words(finding: Finding) -> str:
    """Whether the printed term has the right dimension; a dash where nothing is printed."""
    if finding.printed is None:
        return "-"
    return {True: "right", False: "wrong", None: "unknown"}[finding.dimension_ok]


def dimension_summary(found: Totals) -> str:
    """How many printed terms need no derivation to be known as wrong; empty where there are none."""
    if not found.dimensionally_wrong:
        return ""
    number = found.dimensionally_wrong
    have = "has" if number == 1 else "have"
    return f"{counted(number, 'printed term')} {have} the wrong dimension: wrong without any derivation"


def convention_words(check: ConventionCheck) -> str:
    """What reading a convention the other way would bring; empty where there is no other way to try."""
    if check.findings is None or check.otherwise is None:
        return ""
    return (
        f"Read so, the equations that it touches have {counted(check.findings, 'finding')}; "
        f"read the other way, {check.otherwise}."
    )


def evidence_words(audit: Audit, component: ComponentAudit) -> list[str]:
    """What numbers and symbols say of a component, one sentence each."""
    if component.evidence is None:
        return []
    evidence, measured = component.evidence, unit(audit.publication, component)
    right = not component.findings
    sentences = [_numbers(evidence, measured, audit.seed, right), _balls(evidence, right)]
    equation = "printed" if right else "corrected"
    sentences.append(
        f"The {equation} equation is symbolically equal to the derivation."
        if component.proven
        else f"That the {equation} equation is symbolically equal to the derivation could not be shown."
    )
    return sentences


def _numbers(evidence: Evidence, measured: str, seed: int, right: bool) -> str:
    head = f"At a random state (seed {seed}) Pinocchio gives {evidence.pinocchio:.6g} {measured}"
    corrected = _off(evidence.corrected_off, measured)
    if right:
        return f"{head}; the printed equation is off by {corrected}."
    if evidence.printed_off is None:
        return f"{head}; the printed equation has a symbol without a number, the corrected one is off by {corrected}."
    printed = _off(evidence.printed_off, measured)
    return f"{head}; the printed equation is off by {printed}, the corrected one by {corrected}."


def _off(off: float, measured: str) -> str:
    return "0" if off == 0.0 else f"{off:.2g} {measured}"


def _balls(evidence: Evidence, right: bool) -> str:
    """What intervals that enclose the exact values say."""
    equation = "printed" if right else "corrected"
    meets = "meets" if evidence.enclosed else "does not meet"
    told = f"In ball arithmetic the {equation} equation {meets} the recursion"
    if right or evidence.excluded is None:
        return f"{told}."
    printed = "lies apart from it: proven wrong" if evidence.excluded else "meets it too at this state"
    return f"{told}; the printed one {printed}."
