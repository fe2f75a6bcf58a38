r"""The layout of a display: what it says of which component, by rows, matrices, equals signs and line breaks.

Everything here works on the tokens of the grammar. A long sum is broken over rows, and its sign is printed at the end
of a row, at the start of the next, or at both; a component ends where a matrix row or a line ends without one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

from lark import Token

from rttrr_pin.auditing.reading.grammar import CLOSES, OPERATORS, SHOWN, UnreadableError, end_of, start_of
from rttrr_pin.auditing.reading.rows import Row, rows_of

MOST = 200
"""Splits of one display."""


@dataclass(frozen=True, slots=True)
class Part:
    """What is printed for one component.

    Attributes:
        lines: of its sum.
        start, end: where it stands.
    """

    lines: list[list[Token]]
    start: int
    end: int

    def tokens(self) -> list[Token]:
        """The lines as one sum; the grammar takes a break only between signs.

        Raises:
            UnreadableError: there is no sign between two lines.
        """
        tokens: list[Token] = []
        for line in filter(None, self.lines):
            if not tokens or tokens[-1].type in CLOSES.values() or line[0].type in CLOSES:
                tokens += line
            elif tokens[-1].type == "SIGN" or line[0].type == "SIGN":
                tokens += [Token("BREAK", "\\\\", end_of(tokens[-1])), *line]
            elif line[0].type in OPERATORS or tokens[-1].type in OPERATORS:
                tokens += line[1:] if tokens[-1].type == line[0].type else line
            else:
                message = (
                    "neither does the line before end with a sign nor does this one begin with one; write the sign, "
                    "or state more components"
                )
                raise UnreadableError(message, start_of(line[0]))
        return tokens


def layouts(tokens: Sequence[Token], text: str, components: int, grid: bool = False) -> list[tuple[list[Part], str]]:
    """The ways to divide a display into components, each with what had to be decided; `grid`: a matrix has columns.

    Raises:
        UnreadableError: the display has another number of components, or is no display of equations.
    """
    rows, matrix = rows_of(tokens, grid)
    if not rows:
        raise UnreadableError("there is no equation here", 0)
    return [_layout(rows, starts, note) for starts, note in _divisions(text, rows, matrix, components)]


def _divisions(text: str, rows: Sequence[Row], matrix: bool, components: int) -> list[tuple[tuple[int, ...], str]]:
    """The rows at which components after the first may begin, with notes.

    Left-hand sides decide where there are any. Else a component may end where a line does not end with a sign, and it
    certainly does where the next one does not begin with a sign either.
    """
    breaks = range(1, len(rows))
    wanted = components - 1
    stated = [i for i in breaks if rows[i].stated]
    unsigned = [i for i in breaks if not rows[i - 1].open_end]
    certain = [i for i in unsigned if not rows[i].signed]
    if stated:
        unsigned = certain = stated
    if wanted == 0 and not matrix and not stated:
        return [((), "")]
    if matrix and len(unsigned) == wanted:
        return [(tuple(unsigned), "")]
    if len(certain) == wanted:
        return [(tuple(certain), "")]
    if len(unsigned) == wanted:
        return [(tuple(unsigned), "components divided where a line ends without a sign")]
    if len(certain) > wanted or len(breaks) < wanted:
        raise UnreadableError(
            f"the display shows {len(certain) + 1} components in {len(rows)} rows, expected {components}; "
            "state the right number of components, or end a row that goes on with its sign",
            start_of(rows[0].tokens[0]),
        )
    return _guessed(text, rows, certain, wanted)


def _guessed(text: str, rows: Sequence[Row], certain: Sequence[int], wanted: int) -> list[tuple[tuple[int, ...], str]]:
    """The certain boundaries, and each choice of line breaks for those that are lost."""
    others = [i for i in range(1, len(rows)) if i not in certain]
    divisions: list[tuple[tuple[int, ...], str]] = []
    for added in combinations(others, wanted - len(certain)):
        if len(divisions) == MOST:
            raise UnreadableError(f"the display can be divided in more than {MOST} ways", start_of(rows[0].tokens[0]))
        starts = tuple(sorted((*certain, *added)))
        beginnings = " and ".join(
            f"{starts.index(i) + 2} begins with row {i + 1}, `{_beginning(text, rows[i])}`" for i in added
        )
        note = f"the boundary is not printed: component {beginnings}"
        if any(rows[i - 1].open_end for i in added):
            note += "; the sign at the end of the row before it left out"
        divisions.append((starts, note))
    return divisions


def _beginning(text: str, row: Row) -> str:
    start = start_of(row.tokens[0])
    words = text[start : start + SHOWN].split(" ")
    return " ".join(" ".join(words[:-1] if len(words) > 1 else words).split())  # the last may be cut in two


def _layout(rows: Sequence[Row], starts: Sequence[int], note: str) -> tuple[list[Part], str]:
    notes = [note] if note else []
    parts: list[Part] = []
    for begin, stop in pairwise((0, *starts, len(rows))):
        lines = [list(row.tokens) for row in rows[begin:stop]]
        start, end = start_of(lines[0][0]), end_of(lines[-1][-1])
        if stop < len(rows) and rows[stop - 1].open_end:
            lines[-1] = lines[-1][:-1]
        alone = _unpaired(lines) if starts else []  # around components that are divided, brackets are the vector's
        notes += [f"the bracket `{token}` of component {len(parts) + 1} has no partner, left out" for token in alone]
        parts.append(Part(lines, start, end))
    return parts, "; ".join(notes)


def _unpaired(lines: list[list[Token]]) -> list[Token]:
    """Takes out brackets without a partner that open a line or end one; gives them."""
    opened: list[tuple[Token, list[Token]]] = []
    alone: list[tuple[Token, list[Token]]] = []
    for line in lines:
        for token in line:
            if token.type in CLOSES.values():
                opened.append((token, line))
            elif token.type in CLOSES and opened and opened[-1][0].type == CLOSES[token.type]:
                opened.pop()
            elif token.type in CLOSES:
                alone.append((token, line))
    unpaired = [(token, line) for token, line in alone if token is line[-1]]
    unpaired += [(token, line) for token, line in opened if token is line[0]]
    for token, line in unpaired:
        line[:] = [other for other in line if other is not token]
    return [token for token, _ in unpaired]
