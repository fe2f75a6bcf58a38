"""Stage 6: the corrected terms -> the corrected text, the proof that it is right, and numbers for both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rttrr_pin.auditing.derived import Derived
from rttrr_pin.auditing.evidence import Evidence, Witness
from rttrr_pin.auditing.match import Matching
from rttrr_pin.auditing.normalise import equal, with_printed_symbols
from rttrr_pin.auditing.printed import Quotient
from rttrr_pin.auditing.publication import Publication
from rttrr_pin.auditing.quotients import Comparison, as_quotient, compare, written
from rttrr_pin.auditing.read import read_component
from rttrr_pin.auditing.spelling import Writing, writing
from rttrr_pin.derivation.symbols import Term, expression_of, renamed


@dataclass(frozen=True)
class Proof:
    """A corrected component.

    Attributes:
        write: turns terms into text as the publication spells them.
        corrected: the text of each term.
        proven: whether that text, read again, is equal to the derivation.
        evidence: numbers for the printed and the corrected sum.
    """

    write: Writing
    corrected: tuple[str, ...]
    proven: bool
    evidence: Evidence


def prove(
    matching: Matching, terms: Sequence[Term], name: str, derived: Derived, publication: Publication, witness: Witness
) -> Proof:
    """Write a component as it should be printed, read it again, and compare it with the derivation and with numbers."""
    component, aliases = matching.component, publication.aliases
    texts_of_all = (text for equation in publication.equations for text in equation.texts)
    for examples in ((component.printed.text, *texts_of_all), ()):  # s_2 of the text may be a length, and no sine
        write = writing(publication, component.symbols, examples)
        texts = tuple(write(terms))
        proven = _proven(" ".join(texts), name, derived, publication)
        if proven:
            break
    printed, corrected = (Quotient(renamed(x, aliases)) for x in (matching.printed, expression_of(terms)))
    return Proof(write, texts, proven, witness.evidence(name, printed, corrected))


def prove_quotient(
    comparison: Comparison, text: str, name: str, derived: Derived, publication: Publication, witness: Witness
) -> Proof:
    """The same for a quotient: what is right in its place, read again."""
    texts_of_all = (text for equation in publication.equations for text in equation.texts)
    write = writing(publication, comparison.symbols, (text, *texts_of_all))
    quotient = comparison.printed if comparison.right else comparison.derived
    corrected = written(quotient, write, publication.language == "latex")
    component = read_component(publication, corrected)
    proven = not component.unparsed and compare(as_quotient(component), name, derived, publication.aliases).right
    evidence = witness.evidence(name, comparison.printed, comparison.derived)
    return Proof(write, (corrected,), proven, evidence)


def _proven(text: str, name: str, derived: Derived, publication: Publication) -> bool:
    """Whether a component, by its most literal readings, is equal to the derivation."""
    component = read_component(publication, text)
    if component.unparsed:
        return False
    printed = expression_of(term.literal for term in component.terms)
    symbols = with_printed_symbols(derived.symbols, component.terms)
    return equal(printed, derived.expressions[name], symbols, publication.aliases)
