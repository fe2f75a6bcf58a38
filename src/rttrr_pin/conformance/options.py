"""The option that chooses levels, and what it chooses."""

from __future__ import annotations

from collections.abc import Sequence

import click

from rttrr_pin.conformance.levels import LEVELS
from rttrr_pin.errors import InputError

levels = click.option(
    "--levels", multiple=True, metavar="ID", help=f"Only these: {', '.join(level.id for level in LEVELS)}. Repeats."
)


def chosen_levels(words: Sequence[str]) -> list[str] | None:
    """The ids of `--levels`, which may have several between commas; None without it.

    Raises:
        InputError: it names none.
    """
    ids = [own for several in words for own in several.replace(",", " ").split()]
    if words and not ids:
        raise InputError(f"--levels is {words[0]!r}: expected the name of a level, such as gravity; without it, all")
    return ids or None
