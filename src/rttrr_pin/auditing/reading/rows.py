"""The rows of a display: environments, columns, left-hand sides and numbers of equations taken off."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from lark import Token

from rttrr_pin.auditing.reading.grammar import CLOSES, OPERATORS, UnreadableError, divided, parse, start_of
from rttrr_pin.auditing.reading.trees import products_of, single_symbol

MATRICES = {"matrix", "bmatrix", "pmatrix", "Bmatrix", "smallmatrix", "array"}
"""Environments of which each row is a component, or each cell of the only row."""

LINES = {
    *("aligned", "align", "align*", "split", "gathered", "gather", "gather*", "multline", "multline*", "flalign"),
    *("equation", "equation*", "eqnarray", "eqnarray*", "displaymath", "dmath", "dmath*", "flalign*"),
}
"""Environments of lines."""

STOPS = ("STOP", "COMMA")


@dataclass(frozen=True, slots=True)
class Row:
    """One row, or one cell of a matrix that has a single row.

    Attributes:
        tokens: of the right-hand side; there is at least one.
        stated: it has a left-hand side of its own.
    """

    tokens: tuple[Token, ...]
    stated: bool = False

    @property
    def open_end(self) -> bool:
        """It ends with a sign or an operator, so that its sum goes on."""
        return self.tokens[-1].type in ("SIGN", *OPERATORS)

    @property
    def signed(self) -> bool:
        """It begins with a sign or an operator, so that it may go on a sum."""
        return self.tokens[0].type in ("SIGN", *OPERATORS)


def rows_of(tokens: Sequence[Token], grid: bool = False) -> tuple[list[Row], bool]:
    """The rows that have something on a right-hand side, and whether a matrix holds them.

    Of a matrix that may have rows and columns, `grid`, each cell is a row of the result.

    Raises:
        UnreadableError: environments or equals signs are not those of one equation.
    """
    tokens = plain_lines(tokens)
    begins = [i for i, token in enumerate(tokens) if token.type == "BEGIN"]
    ends = [i for i, token in enumerate(tokens) if token.type == "END"]
    if not begins and not ends:
        return _lines(tokens), False
    if len(begins) != 1 or len(ends) != 1 or begins[0] > ends[0]:
        superfluous = tokens[[*begins[1:], *ends, *begins][0]]
        message = "one matrix is wanted, with its begin and its end; give each its own text"
        raise UnreadableError(message, start_of(superfluous))
    _around(tokens[: begins[0]], tokens[ends[0] + 1 :])
    return _cells(tokens[begins[0] + 1 : ends[0]], grid), True


def plain_lines(tokens: Sequence[Token]) -> list[Token]:
    """The tokens without numbers of equations, and without the begins and ends of lines."""
    return _without_lines(_without_tags(tokens))


def _without_tags(tokens: Sequence[Token]) -> list[Token]:
    """Numbers of equations, printed at the end of a line or of the display, taken off."""
    last = [token.type for token in tokens[-4:]]
    if last[1:] == ["LPAR", "NUMBER", "RPAR"] and last[0] in ("END", *STOPS):
        tokens = tokens[:-3]
    after = [*(token.type for token in tokens[1:]), "END"]
    ending = ("END", "BREAK", "TAG", *STOPS)
    return [
        token for token, follows in zip(tokens, after, strict=False) if token.type != "TAG" or follows not in ending
    ]


def _without_lines(tokens: Sequence[Token]) -> list[Token]:
    """The begins and ends of lines taken off; they are checked to be known."""
    kept = []
    for token in tokens:
        name = token.split("{")[1].split("}")[0].strip() if token.type in ("BEGIN", "END") else None
        if name is not None and name not in MATRICES | LINES:
            known = ", ".join(sorted(MATRICES | LINES))
            raise UnreadableError(f"the environment `{name}` cannot be read; wanted one of {known}", start_of(token))
        if name not in LINES:
            kept.append(token)
    return kept


def _lines(tokens: Sequence[Token]) -> list[Row]:
    plain = [token for token in tokens if token.type != "AMPERSAND"]
    lines: list[list[Token]] = []
    for line in divided(plain, "BREAK"):
        if line and line[0].type == "EQUALS" and lines:
            lines[-1] += line
        elif line:
            lines.append(line)
    rows: list[Row] = []
    stated = False  # `F =` on a line of its own states the row that follows
    for row in map(_row, lines):
        stated = stated or row.stated
        if row.tokens:
            rows.append(Row(row.tokens, stated))
            stated = False
    return rows


def _row(line: list[Token]) -> Row:
    sides = divided(line, "EQUALS")
    if len(sides) > 2:
        second = [token for token in line if token.type == "EQUALS"][1]
        message = "a second = in one line; leave the left-hand side and the side to be read"
        raise UnreadableError(message, start_of(second))
    if len(sides) > 1:
        line = _right(*sides)
    while line and line[-1].type in STOPS:
        line = line[:-1]
    return Row(tuple(line), len(sides) > 1)


def _right(left: list[Token], right: list[Token]) -> list[Token]:
    """The side to be read: the other is the name of what it gives."""
    if _is_name(left):
        return right
    if _is_name(right):
        return left
    message = "one side of = is wanted as one symbol, the name of what the other gives; take its other terms across"
    raise UnreadableError(message, start_of((left + right)[0]) if left or right else 0)


def _is_name(side: Sequence[Token]) -> bool:
    """A side that is one symbol, with a power or without."""
    try:
        return single_symbol(products_of(parse(side, 0))) is not None
    except UnreadableError:
        return False


def _around(before: Sequence[Token], after: Sequence[Token]) -> None:
    """Checks that nothing but a left-hand side, brackets and a stop stand around a matrix."""
    left, right = list(before), [token for token in after if token.type != "TRANSPOSE"]
    while right and right[-1].type in STOPS:
        right.pop()
    if left and left[-1].type in CLOSES.values() and right and right[0].type in CLOSES:
        left, right = left[:-1], right[1:]
    left = [token for token in left if token.type != "AMPERSAND"]
    if left and (left[-1].type != "EQUALS" or not _is_name(left[:-1])):
        message = "only one symbol and = may stand before the matrix; multiply its rows out"
        raise UnreadableError(message, start_of(left[0]))
    if right and (left or right[0].type != "EQUALS" or not _is_name(right[1:])):
        message = "only = and one symbol may stand behind the matrix; add the rest to its rows"
        raise UnreadableError(message, start_of(right[0]))


def _cells(tokens: Sequence[Token], grid: bool) -> list[Row]:
    rows = [row for row in divided(tokens, "BREAK") if row]
    cells = [divided(row, "AMPERSAND") for row in rows]
    if grid:
        return [row for cell in (cell for row in cells for cell in row) if (row := _row(list(cell))).tokens]
    wide = next((row for row in cells if len(row) > 1), None)
    if wide is not None and len(rows) > 1:
        raise UnreadableError("the matrix has rows and columns, wanted one column or one row", start_of(rows[0][0]))
    return [row for cell in (cells[0] if wide is not None else rows) if (row := _row(list(cell))).tokens]
