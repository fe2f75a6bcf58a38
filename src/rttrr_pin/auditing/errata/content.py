"""What stands in an errata sheet."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

from rttrr_pin.auditing.errata.sheet import (
    Block,
    Bullets,
    Code,
    Display,
    Formula,
    Heading,
    Line,
    Paragraph,
    Piece,
    Sheet,
    Table,
    Words,
)
from rttrr_pin.auditing.errata.typeset import settable
from rttrr_pin.auditing.results import AuditResult, ComponentAudit, Finding, Verdict, cells, counted
from rttrr_pin.auditing.wording import (
    MEANING,
    convention_words,
    dimension_summary,
    dimension_words,
    evidence_words,
    verdict_words,
)

WORD = re.compile(r"'[^']*'|`[^`]*`|\s+|[^\s'`]+|'|`")
"""A quotation, blanks, or a word; messages put what is printed between backquotes."""

FINDING_WIDTHS = (0.09, 0.13, 0.33, 0.33, 0.12)
"""Id, kind, printed, should be, dimension."""


def sheet_of(result: AuditResult) -> Sheet:
    """The errata sheet of an audit."""
    return Sheet(f"Errata: {result.publication.title}", tuple(_blocks(result)))


def _blocks(result: AuditResult) -> Iterator[Block]:
    yield from _opening(result)
    yield from _summary(result)
    yield from _conventions(result)
    for heading, verdict in (("Not read", Verdict.UNPARSED), ("Symbols to declare", Verdict.UNDECLARED)):
        reasons = [(x, x.unparsed or "; ".join(x.undeclared)) for x in result.components if x.verdict is verdict]
        if reasons:
            yield Heading(heading)
            yield Bullets(tuple((Words(f"{_name(x)}: ", strong=True), *prose(reason)) for x, reason in reasons))
    wrong = [component for component in result.components if component.findings]
    if wrong:
        yield Heading("Findings")
    for component in wrong:
        yield from _component(result, component)
    yield from _right(result)


def _opening(result: AuditResult) -> Iterator[Block]:
    publication, totals = result.publication, result.totals
    wrong_dimension = dimension_summary(totals)
    yield Paragraph(
        (
            Words(publication.source, strong=True),
            Words(
                f". {counted(len(publication.equations), 'equation')} with {counted(totals.components, 'component')} "
                "were compared, term by term, with the Newton-Euler recursion run on the same symbols."
            ),
        )
    )
    yield Paragraph(
        (
            Words(
                f"{result.count(Verdict.MATCH)} are right as printed, {result.count(Verdict.DIFFERS)} differ, with "
                f"{counted(totals.findings, 'finding')}, and {result.count(Verdict.UNPARSED)} could not be read."
                + (f" {wrong_dimension}." if wrong_dimension else "")
            ),
        )
    )
    if not totals.findings:
        return
    yield Paragraph(
        (
            Words(
                "Printed and derived terms are paired so that the fewest errors explain the difference. A finding is "
                "one error, and its name is that of the component with a number. Each corrected equation is given "
                "whole, the terms that were changed or added being marked; a term in excess is not in it any more."
            ),
        )
    )
    rows = [
        ((Words(str(kind)),), (Words(MEANING[kind]),), (Words(str(number)),))
        for kind, number in totals.kinds.items()
        if number
    ]
    yield Table(("kind", "what it is", "findings"), tuple(rows))


def _summary(result: AuditResult) -> Iterator[Block]:
    rows = list(cells(result.components))
    if not rows:
        return
    axes = [axis for axis in ("x", "y", "z", "") if any(axis in row for _, _, row in rows)]
    yield Heading("All equations")
    body = tuple(
        (
            (Words(f"({number})"),),
            (Words(quantity),),
            *((_verdict(row[axis]),) if axis in row else () for axis in axes),
        )
        for number, quantity, row in rows
    )
    yield Table(("equation", "states", *(axis or "scalar" for axis in axes)), body)
    if result.definitions:
        numbers = ", ".join(f"({number})" for number in result.definitions)
        yield Paragraph((Words(f"Only definitions of symbols, with nothing to compare: {numbers}."),))


def _verdict(component: ComponentAudit) -> Words:
    return Words(verdict_words(component), strong=component.verdict is not Verdict.MATCH)


def _conventions(result: AuditResult) -> Iterator[Block]:
    if result.conventions:
        yield Heading("How the text was read")
        yield Bullets(
            tuple(
                (Words(f"{check.convention.title}: ", strong=True),
                 *prose(convention_words(check)))
                for check in result.conventions
            )
        )  # fmt: skip


def _component(result: AuditResult, component: ComponentAudit) -> Iterator[Block]:
    language = result.publication.language
    line = f" (line {component.line} of the text)" if component.line else ""
    yield Heading(_name(component), 2)
    counts = f"{counted(len(component.findings), 'finding')}; {component.printed_terms} terms printed"
    yield Paragraph((Words(f"{counts}{line}, {component.derived_terms} derived."),))
    rows = [row for group in component.by_term for row in _finding_rows(group, language)]
    yield Table(("finding", "kind", "printed", "should be", "dimension"), tuple(rows), FINDING_WIDTHS)
    notes = [f for group in component.by_term for f in group[:1] if f.note]
    if notes or component.notes:
        lines = [(Words(f"{f.id}: ", strong=True), *prose(f.note)) for f in notes]
        yield Bullets((*lines, *(prose(note) for note in component.notes)))
    if component.evidence is not None:
        yield Paragraph((Words("Evidence. ", strong=True), Words(_units(" ".join(evidence_words(result, component))))))
    if component.corrected:
        yield Paragraph((Words("Corrected:", strong=True),))
        yield display(component, language)


def _units(text: str) -> str:
    """Units as print has them, on the line of their number."""
    return text.replace(" m/s^2", "\u00a0m/s²").replace(" N m", "\u00a0N\u00a0m").replace(" N;", "\u00a0N;")


def _finding_rows(group: Sequence[Finding], language: str) -> Iterator[tuple[Line, ...]]:
    """A row for each error; the terms stand in the first."""
    for k, finding in enumerate(group):
        terms: tuple[Line, ...] = ((Words("the same term"),), ())
        if k == 0:
            terms = (_term(finding.printed, language), _term(finding.derived, language))
        yield (Words(finding.id),), (Words(str(finding.kind)),), *terms, (Words(dimension_words(finding)),)


def _term(text: str | None, language: str) -> Line:
    return (Words("nothing"),) if text is None else (piece(text, language),)


def piece(text: str, language: str) -> Piece:
    """A term, set where it can be."""
    return Formula(text) if language == "latex" and settable(text) else Code(text)


def display(component: ComponentAudit, language: str) -> Display:
    """The corrected equation."""
    code = language != "latex" or not all(settable(term) for term, _ in component.corrected)
    left = component.quantity if code else left_side(component.quantity)
    return Display(left, component.corrected, code)


def left_side(name: str) -> str:
    r"""The name of a component in LaTeX: `\dot{v}_{C_{5x}}` for vC5x, `F_{5z}`, `\tau_{2}`."""
    quantity = name.rstrip("0123456789xyz")
    index = name.removeprefix(quantity)
    if quantity == "vC":
        return rf"\dot{{v}}_{{C_{{{index}}}}}"
    return rf"{chr(92) + quantity if quantity == 'tau' else quantity}_{{{index}}}"


def prose(text: str) -> Line:
    """Words with the formulas and names in them set apart."""
    pieces: list[Piece] = []
    for word in WORD.findall(text):
        quoted = len(word) > 1 and word[0] == word[-1] and word[0] in "'`"
        body = word[1:-1] if quoted else word.rstrip(",;.:)")
        part = _part(body, quoted)
        if isinstance(part, Words):
            part, tail = Words(word), ""
        else:
            tail = "" if quoted else word[len(body) :]
        pieces += [part, Words(tail)] if tail else [part]
    return tuple(_merged(pieces))


def _part(text: str, quoted: bool) -> Piece:
    if re.search(r"\\|\{\}|[_^]\{", text):
        return Formula(text) if settable(text) else Code(text)
    return Code(text) if quoted or re.search(r"\w[_^]\w", text) else Words(text)


def _merged(pieces: Iterable[Piece]) -> Iterator[Piece]:
    """Neighbouring words as one piece."""
    waiting = ""
    for one in pieces:
        if isinstance(one, Words):
            waiting += one.text
            continue
        if waiting:
            yield Words(waiting)
            waiting = ""
        yield one
    if waiting:
        yield Words(waiting)


def _right(result: AuditResult) -> Iterator[Block]:
    right = [component for component in result.components if component.verdict is Verdict.MATCH]
    if right:
        yield Heading("Right as printed")
        names: dict[str, list[ComponentAudit]] = {}
        for component in right:
            names.setdefault(f"({component.equation})", []).append(component)
        listed = "; ".join(f"{number} {', '.join(c.quantity for c in group)}" for number, group in names.items())
        yield Paragraph((Words(f"{listed}."),))
        noted = [component for component in right if component.notes]
        if noted:
            yield Bullets(
                tuple(
                    (Words(f"{component.quantity}: ", strong=True), *prose(note))
                    for component in noted
                    for note in component.notes
                )
            )


def _name(component: ComponentAudit) -> str:
    return f"({component.equation}) {component.quantity}"
