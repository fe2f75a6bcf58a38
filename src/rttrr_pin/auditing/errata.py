"""Errata sheets: what an audit found, as a document that can be sent to the authors."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

from rttrr_pin.auditing.results import AuditResult, ComponentAudit, Finding, Verdict, cells
from rttrr_pin.auditing.wording import (
    MEANING,
    convention_words,
    dimension_summary,
    dimension_words,
    evidence_words,
    verdict_words,
)
from rttrr_pin.derivation.writers import document as doc
from rttrr_pin.derivation.writers.latex import latex
from rttrr_pin.derivation.writers.markdown import markdown
from rttrr_pin.derivation.writers.typeset import settable
from rttrr_pin.reporting.results import counted

WRITERS: Mapping[str, Callable[[doc.Document], str]] = {
    "markdown": partial(markdown, formula="$`{}`$"),  # printed terms have stars and underscores in any place
    "latex": latex,
}
"""By format."""

WORD = re.compile(r"'[^']*'|`[^`]*`|\s+|[^\s'`]+|'|`")
"""A quotation, blanks, or a word; messages put what is printed between backquotes."""

FINDING_WIDTHS = (0.09, 0.13, 0.33, 0.33, 0.12)
"""Id, kind, printed, should be, dimension."""


def errata(result: AuditResult, form: str) -> str:
    """The errata sheet of an audit.

    Args:
        result: the audit.
        form: "markdown" or "latex"; `page.audit_page` is the same as a page.
    """
    return WRITERS[form](errata_document(result))


def errata_document(result: AuditResult) -> doc.Document:
    """The errata sheet, in whatever form."""
    return doc.Document(f"Errata: {result.publication.title}", tuple(_blocks(result)))


def _blocks(result: AuditResult) -> Iterator[doc.Block]:
    yield from _opening(result)
    yield from _summary(result)
    if result.conventions:
        yield doc.Heading("How the text was read")
        yield doc.Bullets(tuple(_item(x.convention.title, prose(convention_words(x))) for x in result.conventions))
    for heading, verdict in (("Not read", Verdict.UNPARSED), ("Symbols to declare", Verdict.UNDECLARED)):
        reasons = [(x, x.unparsed or "; ".join(x.undeclared)) for x in result.components if x.verdict is verdict]
        if reasons:
            yield doc.Heading(heading)
            yield doc.Bullets(tuple(_item(_name(x), prose(reason)) for x, reason in reasons))
    wrong = [component for component in result.components if component.findings]
    if wrong:
        yield doc.Heading("Findings")
    for component in wrong:
        yield from _component(result, component)
    yield from _right(result)


def _item(name: str, text: tuple[doc.Piece, ...]) -> doc.Text:
    return doc.Strong(f"{name}: "), *text


def _opening(result: AuditResult) -> Iterator[doc.Block]:
    publication, totals = result.publication, result.totals
    wrong_dimension = dimension_summary(totals)
    compared = (
        f". {counted(len(publication.equations), 'equation')} with {counted(totals.components, 'component')} "
        "were compared, term by term, with the Newton-Euler recursion run on the same symbols."
    )
    yield doc.Paragraph((doc.Strong(publication.source), compared))
    if result.notes:
        yield doc.Bullets(tuple(_item("The robot's file", prose(note)) for note in result.notes))
    yield doc.Paragraph(
        f"{result.count(Verdict.MATCH)} are right as printed, {result.count(Verdict.DIFFERS)} differ, with "
        f"{counted(totals.findings, 'finding')}, and {result.count(Verdict.UNPARSED)} could not be read."
        + (f" {wrong_dimension}." if wrong_dimension else "")
    )
    if not totals.findings:
        return
    yield doc.Paragraph(
        "Printed and derived terms are paired so that the fewest errors explain the difference. A finding is "
        "one error, and its name is that of the component with a number. Each corrected equation is given "
        "whole, the terms that were changed or added being marked; a term in excess is not in it any more."
    )
    rows = tuple((str(kind), MEANING[kind], str(number)) for kind, number in totals.kinds.items() if number)
    yield doc.Table(("kind", "what it is", "findings"), rows)


def _summary(result: AuditResult) -> Iterator[doc.Block]:
    rows = list(cells(result.components))
    if not rows:
        return
    axes = [axis for axis in ("x", "y", "z", "") if any(axis in row for _, _, row in rows)]
    yield doc.Heading("All equations")
    body = tuple(
        (f"({number})", quantity, *(_verdict(row[axis]) if axis in row else "" for axis in axes))
        for number, quantity, row in rows
    )
    yield doc.Table(("equation", "states", *(axis or "scalar" for axis in axes)), body)
    if result.definitions:
        numbers = ", ".join(f"({number})" for number in result.definitions)
        yield doc.Paragraph(f"Only definitions of symbols, with nothing to compare: {numbers}.")


def _verdict(component: ComponentAudit) -> doc.Text:
    text = verdict_words(component)
    return text if component.verdict is Verdict.MATCH else doc.Strong(text)


def _component(result: AuditResult, component: ComponentAudit) -> Iterator[doc.Block]:
    language = result.publication.language
    line = f" (line {component.line} of the text)" if component.line else ""
    yield doc.Heading(_name(component), 2)
    counts = f"{counted(len(component.findings), 'finding')}; {component.printed_terms} terms printed"
    yield doc.Paragraph(f"{counts}{line}, {component.derived_terms} derived.")
    rows = [row for group in component.by_term for row in _finding_rows(group, language)]
    yield doc.Table(("finding", "kind", "printed", "should be", "dimension"), tuple(rows), FINDING_WIDTHS)
    notes = [_item(group[0].id, prose(group[0].note)) for group in component.by_term if group[0].note]
    if notes or component.notes:
        yield doc.Bullets((*notes, *map(prose, component.notes)))
    if component.evidence is not None:
        yield doc.Paragraph((doc.Strong("Evidence. "), _units(" ".join(evidence_words(result, component)))))
    if component.corrected:
        yield doc.Paragraph(doc.Strong("Corrected:"))
        code = language != "latex" or not all(settable(term) for term, _ in component.corrected)
        left = component.quantity if code else left_side(component.quantity)
        yield doc.Display(left, component.corrected, code)


def _units(text: str) -> str:
    """Units as print has them, on the line of their number."""
    return text.replace(" m/s^2", "\u00a0m/s²").replace(" N m", "\u00a0N\u00a0m").replace(" N;", "\u00a0N;")


def _finding_rows(group: Sequence[Finding], language: str) -> Iterator[tuple[doc.Text, ...]]:
    """A row for each error; the terms stand in the first."""
    for k, finding in enumerate(group):
        terms = (_term(finding.printed, language), _term(finding.derived, language))
        if k:
            terms = ("the same term", "")
        yield finding.id, str(finding.kind), *terms, dimension_words(finding)


def _term(text: str | None, language: str) -> doc.Piece:
    if text is None:
        return "nothing"
    return doc.Formula(text) if language == "latex" and settable(text) else doc.Code(text)


def left_side(name: str) -> str:
    r"""The name of a component in LaTeX: `\dot{v}_{C_{5x}}` for vC5x, `F_{5z}`, `\tau_{2}`."""
    quantity = name.rstrip("0123456789xyz")
    index = name.removeprefix(quantity)
    if quantity == "vC":
        return rf"\dot{{v}}_{{C_{{{index}}}}}"
    return rf"{chr(92) + quantity if quantity == 'tau' else quantity}_{{{index}}}"


def prose(text: str) -> tuple[doc.Piece, ...]:
    """Words with the formulas and names in them set apart."""
    parts: list[doc.Piece] = [""]
    for word in WORD.findall(text):
        quoted = len(word) > 1 and word[0] == word[-1] and word[0] in "'`"
        body = word[1:-1] if quoted else word.rstrip(",;.:)")
        part = _part(body, quoted)
        pieces = [word] if isinstance(part, str) else [part] if quoted else [part, word[len(body) :]]
        for piece in pieces:
            if isinstance(piece, str) and isinstance(parts[-1], str):
                parts[-1] += piece
            else:
                parts.append(piece)
    return tuple(part for part in parts if part)


def _part(text: str, quoted: bool) -> doc.Piece:
    if re.search(r"\\|\{\}|[_^]\{", text):
        return doc.Formula(text) if settable(text) else doc.Code(text)
    return doc.Code(text) if quoted or re.search(r"\w[_^]\w", text) else text


def _right(result: AuditResult) -> Iterator[doc.Block]:
    right = [component for component in result.components if component.verdict is Verdict.MATCH]
    if not right:
        return
    yield doc.Heading("Right as printed")
    names: dict[str, list[str]] = {}
    for component in right:
        names.setdefault(f"({component.equation})", []).append(component.quantity)
    yield doc.Paragraph("; ".join(f"{number} {', '.join(quantities)}" for number, quantities in names.items()) + ".")
    notes = [_item(component.quantity, prose(note)) for component in right for note in component.notes]
    if notes:
        yield doc.Bullets(tuple(notes))


def _name(component: ComponentAudit) -> str:
    return f"({component.equation}) {component.quantity}"
