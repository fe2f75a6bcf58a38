"""The short way for one state or few: straight to compiled code, past the checks that it makes itself."""

from __future__ import annotations

from collections.abc import Callable
from operator import itemgetter
from typing import Any

One = Callable[..., bool | None]
"""Computes one state; None where it declines what it was given."""


def shortcut(one: One | None, inputs: str, outputs: tuple[str, ...], single: bool) -> One | None:
    """The executable's way to compute one state, as a function of (q, v, a, out); it returns None where it declines."""
    if one is None or (single and inputs == "qva"):
        return one
    reads = [name in inputs for name in "qva"]

    def to_one(q: Any, v: Any, a: Any, out: Any) -> bool | None:
        if [x is not None for x in (q, v, a)] != reads:
            return None
        return one(*(x for x in (q, v, a) if x is not None), out)

    pick = itemgetter(*outputs) if len(outputs) > 1 else lambda out: (out[outputs[0]],)

    def to_several(q: Any, v: Any, a: Any, out: Any) -> bool | None:
        if type(out) is not dict or len(out) != len(outputs):
            return None
        try:
            return one(q, v, a, *pick(out))
        except KeyError:  # said in words where all is checked
            return None

    if not single:
        return to_several if inputs == "qva" else None
    return to_one
