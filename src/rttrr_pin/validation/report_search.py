"""The worst case that a search found: a line for a terminal, and JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.text import Text

if TYPE_CHECKING:
    from rttrr_pin.validation.search import WorstCase


def show_search(found: WorstCase, console: Console, several: bool = False) -> None:
    """What was found, beside what chance had found; of several oracles, against which."""
    verdict = Text("PASS", "bold green") if found.agrees else Text("FAIL", "bold red")
    against = f" against {found.oracle}" if several else ""
    told = (
        f"worst of {found.evaluations:,} states searched, seed {found.seed}: share {found.share:.3f} in "
        f"{found.quantity} at {found.at}{against}, where random states had {found.random:.3f}"
    )
    console.print(verdict, Text(told), soft_wrap=True)


def search_data(found: WorstCase) -> dict[str, Any]:
    """The same as data, with the state."""
    return {
        "quantity": found.quantity,
        "at": found.at,
        "oracle": found.oracle,
        "share": found.share,
        "share_of_random_states": found.random,
        "evaluations": found.evaluations,
        "seed": found.seed,
        "q": found.states.q[0].tolist(),
        "v": found.states.v[0].tolist(),
        "a": found.states.a[0].tolist(),
        "loads": [
            {"link": x.link, "f": x.f.reshape(3).tolist(), "n": x.n.reshape(3).tolist()} for x in found.states.loads
        ],
    }
