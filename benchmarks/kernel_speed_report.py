"""The figures of kernel_speed.py as a table, as a comparison with earlier ones, and as a picture."""

from __future__ import annotations

import json
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

Rows = list[dict[str, Any]]


def show(rows: Rows) -> None:
    """The table, fastest first, on stderr; the JSON goes to stdout."""
    table = Table(title="inverse dynamics, tau only")
    for heading in ("robot", "states", "threads", "what"):
        table.add_column(heading, justify="left" if heading in ("robot", "what") else "right")
    for heading in ("ns/state", "x rneaInParallel", "share of copy speed", "worst difference"):
        table.add_column(heading, justify="right")
    table.add_column("note")
    last = None
    for entry in sorted(rows, key=_order):
        if last not in (None, entry["robot"], _place(entry)):
            table.add_section()
        last = _place(entry)
        table.add_row(*map(str, last), entry["what"], *_figures(entry))
    Console(stderr=True, width=200).print(table)


def _figures(entry: dict[str, Any]) -> list[str]:
    if "ns_per_state" not in entry:
        return ["", "", "", "", f"{entry['verdict']}: {entry['note']}"]
    if entry["verdict"] == "disagrees":
        return ["", "", "", f"{entry['worst']:.1e}", f"disagrees, not ranked; {entry['version']}"]
    ratio, share = entry["times_as_fast_as_pinocchio"], entry["share_of_copy_speed"]
    worst = "" if entry["verdict"] == "limit" else f"{entry['worst']:.1e}"
    return [
        f"{entry['ns_per_state']:,.1f}",
        f"{ratio:.3g}",
        f"{share:.3f}",
        worst,
        f"{entry['version']}; {entry['note']}",
    ]


def _place(entry: dict[str, Any]) -> tuple[str, int, int]:
    return entry["robot"], entry["states"], entry["threads"]


def _order(entry: dict[str, Any]) -> tuple[Any, ...]:
    ranked = entry["verdict"] in ("agrees", "limit")
    return (*_place(entry), not ranked, entry.get("ns_per_state", 0.0))


def check(old: Path | None, picture: Path | None) -> None:
    """Fail before the measuring, not after it, if what is wanted at its end cannot be made."""
    if old is not None:
        try:
            json.loads(old.read_text())["rows"]
        except (OSError, ValueError, KeyError) as error:
            raise SystemExit(f"--compare {old}: no result of kernel_speed.py ({error!r})") from None
    if picture is not None and find_spec("matplotlib") is None:
        raise SystemExit("--plot needs matplotlib: pip install matplotlib")


def compare(rows: Rows, old: Path) -> None:
    """How long each takes now, of what it took in an earlier result."""
    before = {(*_place(entry), entry["what"]): entry for entry in json.loads(old.read_text())["rows"]}
    table = Table(
        "robot", "states", "threads", "what", "old ns/state", "new ns/state", "new/old", title=f"against {old}"
    )
    for entry in sorted(rows, key=_order):
        earlier = before.get((*_place(entry), entry["what"]), {})
        if "ns_per_state" in entry and "ns_per_state" in earlier:
            new, past = entry["ns_per_state"], earlier["ns_per_state"]
            figures = (f"{past:,.1f}", f"{new:,.1f}", f"{new / past:.3f}")
            table.add_row(*map(str, _place(entry)), entry["what"], *figures)
    Console(stderr=True, width=160).print(table)


def plot(rows: Rows, target: Path) -> None:
    """Bars of ns/state of one thread, one panel a robot, at the number of states that most were timed at."""
    from matplotlib.figure import Figure

    ranked = [entry for entry in rows if entry["threads"] == 1 and entry["verdict"] in ("agrees", "limit")]
    robots = list(dict.fromkeys(entry["robot"] for entry in ranked))
    figure = Figure(figsize=(12, 3.2 * -(-len(robots) // 2)), layout="constrained")
    panels = figure.subplots(-(-len(robots) // 2), min(2, len(robots)), squeeze=False).flat
    for robot, panel in zip(robots, panels, strict=False):
        own = [entry for entry in ranked if entry["robot"] == robot]
        counts = [entry["states"] for entry in own]
        most = max(counts, key=lambda count: (counts.count(count), count))
        bars = sorted((entry for entry in own if entry["states"] == most), key=_order, reverse=True)
        colours = ["tab:red" if entry["what"].startswith("kernel") else "tab:gray" for entry in bars]
        drawn = panel.barh([entry["what"] for entry in bars], [entry["ns_per_state"] for entry in bars], color=colours)
        panel.bar_label(drawn, [f"{entry['ns_per_state']:,.0f}" for entry in bars], padding=2, fontsize=7)
        panel.set(xscale="log", title=f"{robot}, {most:,} states, one thread", xlabel="ns/state")
        panel.tick_params(labelsize=7)
        panel.set_xlim(right=4 * max(entry["ns_per_state"] for entry in bars))  # the numbers stand within the frame
    figure.savefig(target, dpi=150)
