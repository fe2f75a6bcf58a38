"""Several oracles side by side: what each makes of every quantity at every place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rich.table import Table
from rich.text import Text

from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.exact import format_eps
from rttrr_pin.validation import Row, Validation


@dataclass(frozen=True, slots=True)
class Place:
    """One quantity at one link or joint.

    Attributes:
        quantity: tau, F, N, f or n.
        at: name of the link (of the joint for tau).
        rows: what was seen there, oracle by oracle; None where an oracle does not give the quantity.
    """

    quantity: str
    at: str
    rows: tuple[Row | None, ...]

    @property
    def given(self) -> list[Row]:
        """The rows that there are."""
        return [row for row in self.rows if row is not None]

    @property
    def share(self) -> float:
        """The largest share of the gate of any oracle."""
        return max(row.share.value for row in self.given)


def places(result: Validation) -> list[Place]:
    """All places, quantity by quantity, each with what every oracle makes of it."""
    by_oracle = [{(row.quantity, row.at): row for row in other.rows} for other in result.against]
    keys = dict.fromkeys(key for rows in by_oracle for key in rows)
    ordered = sorted(keys, key=lambda key: QUANTITIES.index(key[0]))
    return [Place(*key, tuple(rows.get(key) for rows in by_oracle)) for key in ordered]


def several_table(result: Validation, shown: Sequence[Place]) -> Table:
    """Share, error in eps and verdict of each oracle; nothing where it does not give a quantity."""
    table = Table("quantity", "at", *(f"{other.name}\nshare / in eps" for other in result.against), "verdict")
    for column in table.columns[2:-1]:
        column.justify = "right"
    previous = ""
    for place in shown:
        if previous and place.quantity != previous:
            table.add_section()
        first = place.quantity != previous
        previous = place.quantity
        passed = all(row.passed for row in place.given)
        table.add_row(place.quantity if first else "", Text(place.at), *map(_seen, place.rows), word(passed))
    return table


def _seen(row: Row | None) -> Text:
    """What one oracle makes of a place; where it fails, it says so."""
    if row is None:
        return Text("")
    if row.absolute.value == 0.0:
        return Text("equal")
    seen = Text(f"{_short(row.share.value)} / {format_eps(row.relative.value).removesuffix(' eps')}")
    return seen if row.passed else seen.append(" ").append_text(word(False))


def _short(share: float) -> str:
    return f"{share:.3f}" if share < 1e4 else f"{share:.1e}"


def against(result: Validation, row: Row) -> str:
    """Where there are several oracles, which one a row is of, in words."""
    if len(result.against) == 1:
        return ""
    return next(f" against {other.name}" for other in result.against if any(row is seen for seen in other.rows))


def word(passed: bool) -> Text:
    """PASS or FAIL."""
    return Text("PASS", "bold green") if passed else Text("FAIL", "bold red")
