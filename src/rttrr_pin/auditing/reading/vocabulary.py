"""Which symbol each printed spelling means."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from fractions import Fraction

from rttrr_pin.auditing.reading.angles import LARGEST_MULTIPLE, Angle, angle_of, is_angle
from rttrr_pin.auditing.reading.grammar import UnreadableError
from rttrr_pin.auditing.reading.nodes import Atom, Named
from rttrr_pin.auditing.reading.trees import atom_of
from rttrr_pin.errors import InputError

COORDINATE = "q_"
"""How the names of coordinates begin; an index from 1 follows."""

FUNCTIONS = {"c": "c", "C": "c", r"\cos": "c", "s": "s", "S": "s", r"\sin": "s"}
"""Spellings of cosine and sine, and what the names of their values begin with."""


def index_of(name: str) -> int | None:
    """The index of a coordinate by its name; None for any other name."""
    digits = name.removeprefix(COORDINATE)
    return int(digits) if name.startswith(COORDINATE) and digits.isdecimal() else None


def unclashing(name: str, known: Collection[str]) -> str:
    """A name for a symbol that is not known, with `_` behind it as often as it takes to be no known symbol's."""
    return unclashing(f"{name}_", known) if is_angle(name) or name in known else name


class Vocabulary:
    r"""The symbols that a text uses, by their LaTeX spelling.

    A spelling is read by the grammar that reads equations, so that `l_{3}` and `l_3`, or `J^*_{xy}` and `J_{xy}^*`,
    are one. Cosines and sines of coordinates need no spelling: they follow from those of the coordinates.

    Attributes:
        names: all names that it gives.
        coordinates: the indices k of its coordinates q_k.
    """

    def __init__(self, spellings: Mapping[str, str]) -> None:
        r"""Reads the spellings.

        Args:
            spellings: name by LaTeX spelling, such as `{r"\dot{q}_4": "v_4"}`; several may give one name.

        Raises:
            InputError: a spelling is not one symbol, or two spellings of one symbol give two names.
        """
        self._names: dict[Atom, str] = {}
        for spelling, name in spellings.items():
            try:
                atom = atom_of(spelling)
            except UnreadableError as error:
                raise InputError(
                    f"`{spelling}` is no spelling of a symbol: {error.placed(spelling)}; "
                    r"wanted one letter with its scripts and accents, such as `\dot{q}_1`"
                ) from error
            if self._names.setdefault(atom, name) != name:
                raise InputError(
                    f"`{spelling}` is to be {name}, but the same symbol is {self._names[atom]} already: "
                    "a symbol has one name; take one of the two out"
                )
        self.names = frozenset(self._names.values())
        self.coordinates = frozenset(index for name in self.names if (index := index_of(name)) is not None)

    def __contains__(self, atom: Atom) -> bool:
        return atom in self._names

    def coordinate(self, atom: Atom) -> int | None:
        """The index of a coordinate; None for any other symbol."""
        name = self._names.get(atom)
        return None if name is None else index_of(name)

    def indexed_angle(self, atom: Atom) -> Named | None:
        """What `c_4`, `s_{12}`, `c_{1,12}`, `c_{1-2}` or `s_{q_4}` means; None for any symbol that is no such thing."""
        if atom != Atom(atom.letters, atom.subscript) or atom.letters not in FUNCTIONS or atom in self:
            return None
        multiples = self._multiples(atom.subscript)
        if not multiples or not self.coordinates.issuperset(multiples):
            return None
        angle = angle_of(FUNCTIONS[atom.letters], multiples, 0)
        return angle if isinstance(angle, Named) else None

    def _multiples(self, subscript: str) -> Angle:
        """The angle of an index: digits, numbers or coordinates, each once, with signs or commas between them."""
        if subscript.isdecimal():
            terms: list[tuple[int, int | None]] = [(1, int(digit)) for digit in subscript]
        else:
            parts = re.findall(r"(,?[+-]?)([^+,-]+)", subscript)
            if "".join(sign + part for sign, part in parts) != subscript or len(parts) > LARGEST_MULTIPLE:
                return {}
            terms = [(-1 if sign.endswith("-") else 1, self._index(part)) for sign, part in parts]
        indices = {index: Fraction(sign) for sign, index in terms if index}
        return indices if len(indices) == len(terms) else {}

    def _index(self, text: str) -> int | None:
        if text.isdecimal():
            return int(text[:10])
        try:
            return self.coordinate(atom_of(text))
        except UnreadableError:
            return None

    def identifier(self, atom: Atom) -> str:
        """The name of a symbol, known or not.

        An unknown one is called by its letters, then `_`, then its leading superscript, where the subscript does not
        have it, and its subscript; stars do not show. No known name is given twice: `_` is put behind.
        """
        known = self._names.get(atom)
        if known is not None:
            return known
        letters = "_".join(_plain(part) for part in (*atom.accents, atom.letters))
        prefix, subscript = _plain(atom.prefix), _plain(atom.subscript)
        scripts = ("" if prefix in subscript else prefix) + subscript + _plain(atom.superscript)
        return unclashing(f"{letters}_{scripts}" if scripts else letters, self.names)


def _plain(text: str) -> str:
    return "".join(character for character in text.replace("'", "prime") if character.isalnum())
