"""Stage 1: the text of an equation -> its terms, in every way that it can be divided into components."""

from __future__ import annotations

from rttrr_pin.auditing.printed import PrintedComponent, Split
from rttrr_pin.auditing.publication import Equation, Publication
from rttrr_pin.auditing.reading import read_latex, read_python


def read(publication: Publication, equation: Equation) -> tuple[Split, ...]:
    """The terms of an equation; several ways where its text does not show where components end."""
    if publication.language == "latex" and len(equation.texts) == 1:
        return read_latex(equation.texts[0], publication.vocabulary, max(1, len(equation.components)))
    return (Split(tuple(read_component(publication, text) for text in equation.texts)),)


def read_component(publication: Publication, text: str) -> PrintedComponent:
    """The terms of one component whose text stands by itself."""
    if publication.language == "latex":
        return read_latex(text, publication.vocabulary, 1)[0].components[0]
    return read_python(text, publication.spellings)
