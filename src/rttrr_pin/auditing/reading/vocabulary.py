"""Which symbol each printed spelling means."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from fractions import Fraction
from math import prod

from rttrr_pin.auditing.reading.grammar import UnreadableError
from rttrr_pin.auditing.reading.nodes import Atom, Factor, Group, Named, Product
from rttrr_pin.auditing.reading.trees import atom_of
from rttrr_pin.errors import InputError

COORDINATE = "q_"
"""How the names of coordinates begin; an index from 1 follows."""

FUNCTIONS = {"c": "c", "C": "c", r"\cos": "c", "s": "s", "S": "s", r"\sin": "s"}
"""Spellings of cosine and sine, and what the names of their values begin with."""


LARGEST_MULTIPLE = 12
"""Of all coordinates in one angle."""

PART = re.compile(r"m?\d+")
"""What the name of an angle is made of: 1_1_m2 is 2 q_1 - q_2."""

Multiples = Mapping[int, int]
"""An angle: whole multiples of coordinates, by their indices; none of them 0."""


def angle_of(function: str, multiples: Multiples | None, start: int) -> Named:
    """The cosine ("c") or sine ("s") of an angle that stands at `start`; the first multiple in its name is positive.

    Raises:
        UnreadableError: the angle is no sum of whole multiples of coordinates.
    """
    total = sum(map(abs, (multiples or {}).values()))
    if not multiples or total > LARGEST_MULTIPLE:
        raise UnreadableError("the angle is wanted as a coordinate, or a sum or multiple of coordinates", start)
    turn = -1 if multiples[min(multiples)] < 0 else 1
    parts = [f"{'m' if n * turn < 0 else ''}{k}" for k, n in sorted(multiples.items()) for _ in range(abs(n))]
    return Named("_".join([function, *parts]), sign=turn if function == "s" else 1)


def multiples_of(products: Sequence[Product], coordinate: Callable[[Factor], int | None]) -> Multiples | None:
    """The angle that a sum is; None where it is none. `coordinate` gives the index of a factor that is one."""
    total: Counter[int] = Counter()
    for product in products:
        number = Fraction(prod(product.signs[-1]) if product.signs else 1)
        inner: Multiples | None = None
        for factor in product.factors:
            if isinstance(factor.body, Fraction) and factor.operator != "/" and factor.power == 1:
                number *= factor.body
                continue
            if inner is not None or factor.operator == "/" or factor.power != 1:
                return None
            if isinstance(factor.body, Group):
                inner = None if factor.body.divisor else multiples_of(factor.body.products, coordinate)
            else:
                index = coordinate(factor)
                inner = None if index is None else {index: 1}
            if inner is None:
                return None
        if inner is None or number.denominator != 1 or abs(number) > LARGEST_MULTIPLE:
            return None
        for index, multiple in inner.items():
            total[index] += int(number) * multiple
    return {index: multiple for index, multiple in total.items() if multiple}


def index_of(name: str) -> int | None:
    """The index of a coordinate by its name; None for any other name."""
    digits = name.removeprefix(COORDINATE)
    return int(digits) if name.startswith(COORDINATE) and digits.isdecimal() else None


def unclashing(name: str, known: Collection[str]) -> str:
    """A name for a symbol that is not known, with `_` behind it as often as it takes to be no known symbol's."""
    function, *indices = name.split("_")
    angle = function in FUNCTIONS.values() and bool(indices) and all(map(PART.fullmatch, indices))
    return unclashing(f"{name}_", known) if angle or name in known else name


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
        return angle_of(FUNCTIONS[atom.letters], multiples, 0)

    def _multiples(self, subscript: str) -> Multiples:
        """The angle of an index: digits, numbers or coordinates, each once, with signs or commas between them."""
        if subscript.isdecimal():
            terms: list[tuple[int, int | None]] = [(1, int(digit)) for digit in subscript]
        else:
            parts = re.findall(r"(,?[+-]?)([^+,-]+)", subscript)
            if "".join(sign + part for sign, part in parts) != subscript or len(parts) > LARGEST_MULTIPLE:
                return {}
            terms = [(-1 if sign.endswith("-") else 1, self._index(part)) for sign, part in parts]
        indices = {index: sign for sign, index in terms if index is not None}
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
