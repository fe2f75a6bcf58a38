"""What was derived, as a table for a terminal, and the formulas where they fit the screen."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

from rich.console import Console
from rich.table import Table
from rich.text import Text

from rttrr_pin.derivation import QUANTITIES, Derivation
from rttrr_pin.derivation.collect import Presenter
from rttrr_pin.derivation.latex import decimal
from rttrr_pin.derivation.quantities import Extent
from rttrr_pin.derivation.symbolic_robot import AXES
from rttrr_pin.derivation.symbols import Role
from rttrr_pin.derivation.writers.printing import Notation, lines

LETTERS = (
    (Role.COORDINATE, "{} is coordinate {}"),
    (Role.RATE, "{} its rate"),
    (Role.ACCELERATION, "{} its acceleration"),
    (Role.COSINE, "{} its cosine"),
    (Role.SINE, "{} its sine"),
)
"""What the first symbol of each role is."""


def show_derivation(derivation: Derivation, seconds: float, written: Mapping[str, str], console: Console) -> None:
    """How long each quantity is, its formulas where the screen has room for them, and where it was written.

    Args:
        derivation: what was derived.
        seconds: that it took.
        written: the files, by format.
        console: where to print.
    """
    console.print(
        Text(f"{derivation.robot.model.name}:", "bold"), Text(f"{derivation.form} form ({derivation.reason}), SI units")
    )
    table = Table("quantity", "meaning", "entries", "terms", "longest")
    for column in (2, 3, 4):
        table.columns[column].justify = "right"
    if derivation.steps:
        lengths = [len(step.terms) for step in derivation.steps]
        table.add_row("steps", "named on the way", *_counts(lengths))
    for name, derived in derivation.quantities.items():
        table.add_row(name, QUANTITIES[name].meaning, *_counts([len(terms) for terms in derived.terms.values()]))
    console.print(table)
    console.print(Text(f"{derivation.count():,} terms in all ({seconds:.1f} s)"))
    if not derivation.steps and not written:
        _show_formulas(derivation, console)
    for format_name, target in written.items():
        console.print(Text(f"{format_name}: {target}"), soft_wrap=True)


def _counts(lengths: list[int]) -> tuple[str, str, str]:
    return str(len(lengths)), f"{sum(lengths):,}", f"{max(lengths, default=0):,}"


def _show_formulas(derivation: Derivation, console: Console) -> None:
    """The quantities in order, each whole, as long as there is room."""
    room = console.height
    shown, left_out = [], []
    for name in derivation.quantities:
        formulas = list(_formulas(derivation, name, console.width))
        if len(formulas) <= room:
            room -= len(formulas)
            shown += formulas
        else:
            left_out.append(name)
    if shown:
        console.print(Text(_letters(derivation), "dim"), soft_wrap=True)
    for line in shown:
        console.print(Text(line), soft_wrap=True)
    if left_out:
        console.print(Text(f"too long for this screen: {', '.join(left_out)}"), soft_wrap=True)


def _formulas(derivation: Derivation, name: str, width: int) -> Iterator[str]:
    """The entries of a quantity, with all that fits on each line."""
    presenter = Presenter(derivation.symbols)
    for at, terms in derivation.quantities[name].terms.items():
        ends = [AXES[at[-1]]] if QUANTITIES[name].extent is Extent.LINKS else [str(k + 1) for k in at[1:]]
        left = f"{name}_{at[0] + 1}{'_' if ends else ''}{''.join(ends)} = "
        first, *others = lines(presenter.expression(terms), PLAIN, max(20, width - len(left) - 1))
        yield left + first
        yield from (" " * len(left) + line for line in others)


def _number(x: Fraction) -> str:
    short = str(x) if x.denominator == 1 else f"({x})"
    return short if len(short) <= 9 else decimal(float(x)).replace(r" \cdot 10^{", "e").replace("}", "")


PLAIN = Notation(_number, lambda name, power: name if power == 1 else f"{name}^{power}", " ", len, "    ")
"""For a terminal: what Python and C call a symbol, blanks for products."""


def _letters(derivation: Derivation) -> str:
    """What the letters of motion are, by the first of each."""
    symbols = derivation.symbols.values()
    first = {role: next((x for x in symbols if x.role is role), None) for role, _ in LETTERS}
    return ", ".join(
        text.format(symbol.name, derivation.robot.model.q_names[0]) for role, text in LETTERS if (symbol := first[role])
    )
