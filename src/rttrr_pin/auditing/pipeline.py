"""The audit: read -> derive -> normalise -> match -> classify -> prove, a value between each stage and the next."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

from rttrr_pin.auditing.classify import corrected_terms, findings, undeclared
from rttrr_pin.auditing.derived import Derived, derive
from rttrr_pin.auditing.evidence import Witness
from rttrr_pin.auditing.match import Matching, match_best
from rttrr_pin.auditing.printed import Split
from rttrr_pin.auditing.prove import prove
from rttrr_pin.auditing.publication import Convention, Equation, Publication
from rttrr_pin.auditing.read import read
from rttrr_pin.auditing.results import AuditResult, ComponentAudit, ConventionCheck, Verdict
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
            matchings, note = match_equation(equation, printed[equation], derived, publication.aliases)
            for name, matching in zip(equation.names, matchings, strict=True):
                components.append(_component(publication, equation, name, note, matching, derived[0], witness))
        progress(done)
    checks = [_check(convention, publication, printed, derived, components) for convention in publication.conventions]
    return AuditResult(publication, tuple(components), tuple(checks), seed)


def match_equation(
    equation: Equation, splits: Sequence[Split], derived: Sequence[Derived], aliases: Mapping[str, str]
) -> tuple[list[Matching], str]:
    """Pair the components of an equation with what is derived, for each way to divide it; the best way is taken.

    Returns:
        The pairing of each component, and what had to be decided to divide the equation; empty where nothing had to be.
    """
    ways = [
        [match_best(x, name, derived, aliases) for name, x in zip(equation.names, split.components, strict=True)]
        for split in splits
    ]
    best = min(range(len(ways)), key=lambda k: sum(matching.weight for matching in ways[k]))
    note = splits[best].note
    if len(splits) > 1:
        note += f" ({len(splits)} ways were tried; this leaves the fewest errors)"
    return ways[best], note


def _component(
    publication: Publication,
    equation: Equation,
    name: str,
    note: str,
    matching: Matching,
    derived: Derived,
    witness: Witness,
) -> ComponentAudit:
    """The result for one component: no findings where it could not be read, or has symbols that may be right."""
    component, dimension = matching.component, publication.dimension(equation)
    to_declare = tuple(undeclared(matching))
    notes = (pair.reading.note for pair in matching.pairs if pair.reading and not pair.kinds)
    result = ComponentAudit(
        equation=equation.number,
        quantity=name,
        line=equation.line,
        printed_terms=len(component.printed.terms),
        derived_terms=len(component.derived),
        verdict=Verdict.UNDECLARED if to_declare else Verdict.UNPARSED,
        unit=UNITS[dimension],
        notes=tuple(filter(None, (note, *notes))),
        unparsed=component.printed.unparsed,
        undeclared=to_declare,
    )
    if to_declare or component.printed.unparsed:
        return result
    corrected = corrected_terms(matching)
    proof = prove(matching, [term for term, _ in corrected], name, derived, publication, witness)
    errors = findings(matching, name, dimension, proof.write)
    changed = [changed for _, changed in corrected] or [True]  # a sum of nothing is printed as 0
    return replace(
        result,
        verdict=Verdict.DIFFERS if errors else Verdict.MATCH,
        findings=errors,
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
    as_read = sum(len(x.findings) for x in components if x.equation in numbers)
    otherwise = sum(
        len(pair.kinds)
        for equation in touched
        for matching in match_equation(equation, printed[equation], [flipped], publication.aliases)[0]
        for pair in matching.pairs
    )
    return ConventionCheck(convention, as_read, otherwise)
