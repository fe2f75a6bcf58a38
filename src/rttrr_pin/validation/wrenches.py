"""The wrenches of the joints in one state, as another program says them."""

from __future__ import annotations

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from rttrr_pin.core.conventions import convention
from rttrr_pin.core.joint_wrenches import JointWrenches, joint_wrenches
from rttrr_pin.errors import InputError
from rttrr_pin.validation.state import StateReport


def wrenches_of(report: StateReport, name: str) -> JointWrenches:
    """What the subject gave as f and n, in a convention, a batch of one.

    Raises:
        UnknownNameError: there is no such convention.
        InputError: the subject gives no f, or no n.
    """
    row, values = convention(name), report.result.values
    if not {"f", "n"} <= values.keys():
        raise InputError(f"{report.subject} gives no f and n, which --convention shows: name another --subject")
    return joint_wrenches(row, report.batch.model, report.batch.q, values["f"], values["n"])


def show_wrenches(wrenches: JointWrenches, console: Console) -> None:
    """A row for each joint, six numbers each, in the order of the program."""
    row = wrenches.convention
    halves = {"force": "f", "moment": "n"}
    first = row.first
    names = [halves[key] + axis for key in (first, *({*halves} - {first})) for axis in "xyz"]
    console.print(Text(f"{row.program}: {row.quantity.replace('`', '')}", "bold"), soft_wrap=True)
    table = Table("link", *names, box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for column in table.columns[1:]:
        column.justify = "right"
    for link, numbers in zip(wrenches.links, wrenches.vector[0], strict=True):
        table.add_row(Text(link), *(f"{x:.6g}" for x in numbers))
    console.print(table)
    console.print(Text(row.words), soft_wrap=True)
