"""The audit: read -> derive -> normalise -> match -> classify -> prove, a value between each stage and the next."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from rttrr_pin.auditing.classify import Classified, classify
from rttrr_pin.auditing.derived import Derived, derive
from rttrr_pin.auditing.evidence import Witness
from rttrr_pin.auditing.match import Matching, match_best
from rttrr_pin.auditing.printed import Split
from rttrr_pin.auditing.prove import Proof, prove
from rttrr_pin.auditing.publication import Convention, Equation, Publication
from rttrr_pin.auditing.read import read
from rttrr_pin.auditing.results import AuditResult, ComponentAudit, ConventionCheck, Finding, Verdict
from rttrr_pin.derivation.symbols import ACCELERATION, FORCE, MOMENT, Dimension

UNITS: Mapping[Dimension, str] = {ACCELERATION: "m/s^2", FORCE: "N", MOMENT: "N m"}
"""The unit of each quantity."""


def audit(publication: Publication, seed: int = 0, progress: Callable[[int], None] = lambda done: None) -> AuditResult:
    """Compare every equation of a publication with the recursion.

    Args:
        publication: the equations, with all that they assume.
        seed: of the random state at which numbers are compared.
        progress: is called with the number of equations done.

    Returns:
        Verdicts and findings for every component, corrected equations, and evidence.

    Raises:
        OracleError: Pinocchio cannot take the robot.
    """
    derived, witness = derive(publication), Witness(publication.robot, seed)
    printed = {equation: read(publication, equation) for equation in publication.equations if equation.names}
    components: list[ComponentAudit] = []
    for done, equation in enumerate(publication.equations, start=1):
        if equation.names:
            matched = match_equation(equation, printed[equation], derived, publication.aliases)
            for name, matching in zip(equation.names, matched.matchings, strict=True):
                classified = classify(matching, publication.dimension(equation))
                judged = not classified.undeclared and not matching.component.printed.unparsed
                proof = prove(classified, name, derived[0], publication, witness) if judged else None
                components.append(_component(publication, equation, name, matched.note, classified, proof))
        progress(done)
    checks = [_check(convention, publication, printed, derived, components) for convention in publication.conventions]
    return AuditResult(publication, tuple(components), tuple(checks), seed)


@dataclass(frozen=True)
class MatchedEquation:
    """An equation divided into components in the way that leaves the least to explain.

    Attributes:
        matchings: of its components.
        note: what had to be decided to divide it; empty where the text shows the boundaries.
    """

    matchings: tuple[Matching, ...]
    note: str


def match_equation(
    equation: Equation, splits: Sequence[Split], derived: Sequence[Derived], aliases: Mapping[str, str]
) -> MatchedEquation:
    """Pair the components of an equation with what is derived, for each way to divide it; the best way is taken.

    Args:
        equation: the equation.
        splits: the ways to divide its text.
        derived: what is right, in one form or several.
        aliases: symbols that are equal to others.
    """
    ways = [
        [match_best(x, name, derived, aliases) for name, x in zip(equation.names, split.components, strict=True)]
        for split in splits
    ]
    best = min(range(len(ways)), key=lambda k: sum(matching.weight for matching in ways[k]))
    note = splits[best].note
    if len(splits) > 1:
        note += f" ({len(splits)} ways were tried; this leaves the fewest errors)"
    return MatchedEquation(tuple(ways[best]), note)


def _component(
    publication: Publication, equation: Equation, name: str, note: str, classified: Classified, proof: Proof | None
) -> ComponentAudit:
    """The result for one component; without a proof it could not be read, or has undeclared symbols."""
    component = classified.matching.component
    result = ComponentAudit(
        equation=equation.number,
        quantity=name,
        line=equation.line,
        printed_terms=len(component.printed.terms),
        derived_terms=len(component.derived),
        verdict=Verdict.UNDECLARED if classified.undeclared else Verdict.UNPARSED,
        unit=UNITS[publication.dimension(equation)],
        notes=tuple(filter(None, (note, *classified.notes))),
        unparsed=component.printed.unparsed,
        undeclared=classified.undeclared,
    )
    if proof is None:
        return result
    findings = tuple(
        Finding(
            id=f"{name}.{k}",
            kind=error.kind,
            printed=error.printed,
            derived=None if error.derived is None else proof.writing([error.derived])[0],
            dimension_ok=error.dimension_ok,
            note=error.note,
        )
        for k, error in enumerate(classified.errors, start=1)
    )
    changed = [changed for _, changed in classified.corrected] or [True]  # a sum of nothing is printed as 0
    return replace(
        result,
        verdict=Verdict.DIFFERS if findings else Verdict.MATCH,
        findings=findings,
        corrected=tuple(zip(proof.corrected, changed, strict=True)),
        proven=proof.proven,
        evidence=proof.evidence,
    )


def _check(
    convention: Convention,
    publication: Publication,
    printed: Mapping[Equation, Sequence[Split]],
    derived: Sequence[Derived],
    components: Iterable[ComponentAudit],
) -> ConventionCheck:
    """A convention and its alternative: the equations that it touches, matched with some symbols' signs turned."""
    if not convention.flip:
        return ConventionCheck(convention)
    flipped = derived[0].flipped(convention.flip)
    touched = [
        equation
        for equation in printed
        if any(derived[0].expressions[name] != flipped.expressions[name] for name in equation.names)
    ]
    numbers = {equation.number for equation in touched}
    otherwise = [
        len(pair.kinds)
        for equation in touched
        for matching in match_equation(equation, printed[equation], [flipped], publication.aliases).matchings
        for pair in matching.pairs
    ]
    return ConventionCheck(
        convention, sum(len(x.findings) for x in components if x.equation in numbers), sum(otherwise)
    )
