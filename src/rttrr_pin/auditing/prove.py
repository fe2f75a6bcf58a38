"""Stage 6: what is wrong -> the corrected text, the proof that it is right, and numbers for both."""

from __future__ import annotations

from dataclasses import dataclass

from rttrr_pin.auditing.classify import Classified
from rttrr_pin.auditing.derived import Derived
from rttrr_pin.auditing.evidence import Evidence, Witness
from rttrr_pin.auditing.normalise import equal, sums_of_angles, with_printed_symbols
from rttrr_pin.auditing.printed import PrintedComponent
from rttrr_pin.auditing.publication import Publication
from rttrr_pin.auditing.read import read_component
from rttrr_pin.auditing.spelling import Writing, writing
from rttrr_pin.derivation.symbols import expression_of, renamed


@dataclass(frozen=True)
class Proof:
    """A corrected component.

    Attributes:
        writing: turns terms into text as the publication spells them.
        corrected: the text of each term.
        proven: whether that text, read again, is equal to the derivation.
        evidence: numbers for the printed and the corrected sum.
    """

    writing: Writing
    corrected: tuple[str, ...]
    proven: bool
    evidence: Evidence


def prove(classified: Classified, name: str, derived: Derived, publication: Publication, witness: Witness) -> Proof:
    """Write the corrected component, read it again, and compare it with the derivation and with numbers.

    Args:
        classified: what is wrong.
        name: of the component.
        derived: what is right, in the robot's symbols.
        publication: whose notation is used.
        witness: a random state.
    """
    component, terms = classified.matching.component, [term for term, _ in classified.corrected]
    texts_of_all = tuple(text for equation in publication.equations for text in equation.texts)
    for examples in ((component.printed.text, *texts_of_all), ()):  # s_2 of the text may be a length, and no sine
        write = writing(publication, component.symbols, examples)
        texts = write(terms)
        proven = _proven(read_component(publication, " ".join(texts)), name, derived, publication)
        if proven:
            break
    return Proof(write, tuple(texts), proven, _evidence(classified, name, publication, witness))


def _proven(read: PrintedComponent, name: str, derived: Derived, publication: Publication) -> bool:
    """Whether a component as read, by its most literal readings, is equal to the derivation."""
    if read.unparsed:
        return False
    printed = expression_of(term.literal for term in read.terms)
    symbols = with_printed_symbols(derived.symbols, read.terms)
    return equal(printed, derived.expressions[name], symbols, publication.aliases)


def _evidence(classified: Classified, name: str, publication: Publication, witness: Witness) -> Evidence:
    """Numbers of a component as printed and as corrected, at the state of the witness."""
    matching, aliases = classified.matching, publication.aliases
    witness.add_sums_of_angles(sums_of_angles(matching.component.symbols))
    printed = renamed(matching.printed, aliases)
    corrected = renamed(expression_of(term for term, _ in classified.corrected), aliases)
    return witness.evidence(name, printed, corrected)
