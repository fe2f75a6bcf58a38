"""From the text of an equation to its terms, each with every way it can be read."""

from __future__ import annotations

from rttrr_pin.auditing.reading.latex import read_latex
from rttrr_pin.auditing.reading.python import read_python
from rttrr_pin.auditing.reading.vocabulary import Vocabulary

__all__ = ["Vocabulary", "read_latex", "read_python"]
