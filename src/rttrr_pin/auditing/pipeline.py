"""The audit: read -> derive -> normalise -> match -> classify -> prove, a value between each stage and the next."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

from rttrr_pin.auditing.classify import corrected_terms, findings, to_declare, undeclared
from rttrr_pin.auditing.coriolis import other_matrices
from rttrr_pin.auditing.derived import Derived, derive
from rttrr_pin.auditing.evidence import Witness
from rttrr_pin.auditing.match import Matching, match_best
from rttrr_pin.auditing.printed import PrintedComponent, Split
from rttrr_pin.auditing.prove import Proof, prove, prove_quotient
from rttrr_pin.auditing.publication import Convention, Equation, Publication
from rttrr_pin.auditing.quotients import as_quotient, compare
from rttrr_pin.auditing.read import read
from rttrr_pin.auditing.results import AuditResult, ComponentAudit, ConventionCheck, Finding, Verdict
from rttrr_pin.core.arguments import whole_number
from rttrr_pin.errors import InputError


def audit(publication: Publication, seed: int = 0, progress: Callable[[int], None] | None = None) -> AuditResult:
    """Compare every equation of a publication with the recursion.

    Args:
        publication: the equations, with all that they assume.
        seed: of the random state at which numbers are compared.
        progress: is called with the number of equations done.

    Returns:
        Verdicts and findings for every component, corrected equations, and evidence.

    Raises:
        InputError: an argument cannot be used.
        ImplementationError: Pinocchio cannot take the robot.
    """
    if not isinstance(publication, Publication):
        raise InputError(f"publication is a {type(publication).__name__}: pass what read_publication(path) returns")
    seed = whole_number("seed", seed, 0, 2**128 - 1, "2^128 - 1")
    derived, witness = derive(publication), Witness(publication.robot, seed, publication.passive)
    printed = {equation: read(publication, equation) for equation in publication.equations if equation.names}
    divided = {equation: splits for equation, splits in printed.items() if _divides(equation, splits)}
    paired = {
        equation: match_equation(equation, splits, derived, publication.aliases)
        for equation, splits in printed.items()
        if equation not in divided
    }
    by_name = {
        name: matching
        for equation, (matchings, _) in paired.items()
        for name, matching in zip(equation.names, matchings, strict=True)
    }
    others, open_ = other_matrices(by_name, derived[0], publication.robot.model.nv, publication.aliases)
    components: list[ComponentAudit] = []
    for done, equation in enumerate(publication.equations, start=1):
        if equation in divided:
            for name, component in zip(equation.names, divided[equation][0].components, strict=True):
                components.append(_quotient(publication, equation, name, component, derived[0], witness))
        elif equation.names:
            for name in equation.names:
                matching, note = by_name[name], paired[equation][1]
                if name in others:
                    matching, note = matching.as_right(), "; ".join(filter(None, (note, others[name])))
                reason = open_.get(name, "")
                components.append(_component(publication, equation, name, note, matching, derived[0], witness, reason))
        if progress is not None:
            progress(done)
    plain = {equation: splits for equation, splits in printed.items() if equation not in divided}
    checks = [_check(convention, publication, plain, derived, components) for convention in publication.conventions]
    return AuditResult(publication, tuple(components), tuple(checks), seed)


def _divides(equation: Equation, splits: Sequence[Split]) -> bool:
    """Whether an equation is about quotients."""
    return equation.quantity == "a" or any(component.quotient for component in splits[0].components)


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
    reason: str,
) -> ComponentAudit:
    """The result for one component: no findings where it could not be read, or has symbols that may be right.

    `reason` says why nothing can be said of it yet; empty for most.
    """
    component = matching.component
    needed = (*undeclared(matching), *([reason] if reason else []))
    notes = (pair.reading.note for pair in matching.pairs if pair.reading and not pair.kinds)
    unjudged = replace(
        _unjudged(publication, equation, name, component.printed.unparsed, needed),
        printed_terms=len(component.printed.terms),
        derived_terms=len(component.derived),
        notes=tuple(filter(None, (note, *notes))),
    )
    if needed or component.printed.unparsed:
        return unjudged
    corrected = corrected_terms(matching)
    proof = prove(matching, [term for term, _ in corrected], name, derived, publication, witness)
    errors = findings(matching, name, proof.write, [publication.dimension(name)])
    changed = [changed for _, changed in corrected] or [True]  # a sum of nothing is printed as 0
    return _judged(unjudged, not errors, errors, changed, proof)


def _quotient(
    publication: Publication,
    equation: Equation,
    name: str,
    component: PrintedComponent,
    derived: Derived,
    witness: Witness,
) -> ComponentAudit:
    """The result for one component in which symbols divide."""
    printed = as_quotient(component)
    terms = 0 if component.unparsed else len(printed.numerator) + len(printed.denominator)
    needed = tuple(map(to_declare, printed.unknown))
    unjudged = replace(_unjudged(publication, equation, name, component.unparsed, needed), printed_terms=terms)
    if needed or component.unparsed:
        return unjudged
    comparison = compare(printed, name, derived, publication.aliases)
    proof = prove_quotient(comparison, component.text, name, derived, publication, witness)
    errors = () if comparison.right else comparison.findings(name, proof.write)
    terms = len(comparison.derived.numerator) + len(comparison.derived.denominator)
    changed = [not comparison.right] * len(proof.corrected)
    return _judged(replace(unjudged, derived_terms=terms), comparison.right, errors, changed, proof)


def _unjudged(
    publication: Publication, equation: Equation, name: str, unparsed: str, needed: tuple[str, ...]
) -> ComponentAudit:
    """The result where a component could not be read, or has symbols that are not declared; all others begin so too."""
    return ComponentAudit(
        equation=equation.number,
        quantity=name,
        line=equation.line,
        printed_terms=0,
        derived_terms=0,
        verdict=Verdict.UNDECLARED if needed else Verdict.UNPARSED,
        unit=publication.dimension(name).unit,
        unparsed=unparsed,
        undeclared=needed,
    )


def _judged(
    result: ComponentAudit, right: bool, errors: tuple[Finding, ...], changed: Sequence[bool], proof: Proof
) -> ComponentAudit:
    """The result with its verdict; `changed` says of each corrected text whether it is not as printed."""
    return replace(
        result,
        verdict=Verdict.MATCH if right else Verdict.DIFFERS,
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
