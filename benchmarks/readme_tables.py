"""The tables of the documents, made from benchmarks/results: `python benchmarks/readme_tables.py [--check]`.

Without --check the pages are rewritten between their markers; with it, exit 1 if one is out of date.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from typing import Any

import kernel_tables
import proof_tables
from saved import TOP, machine, result


def agreement_table() -> list[str]:
    data = result("agreement")
    pin = data["versions"]["pin"]
    return [
        f"{data['states']:,} random states of RTTRR with a random payload, ours against Pinocchio {pin}: "
        f"**{data['verdict']}** ({machine(data)}; `python benchmarks/agreement.py`).",
        "",
        "| | tau | F | N | f | n |",
        "|---|---|---|---|---|---|",
        "| worst difference, eps of the link's own norm | "
        + " | ".join(f"{data['worst'][key]['worst_eps']:.0f}" for key in data["worst"])
        + " |",
        "| worst share of what rounding can explain | "
        + " | ".join(f"{data['worst'][key]['worst_share_of_gate']:.2f}" for key in data["worst"])
        + " |",
    ]


def cost_table() -> list[str]:
    data = result("cost")
    lines = [
        f"Cost of the whole command, process start included ({machine(data)}; `python benchmarks/validate_cost.py`):",
        "",
        "| `rttrr-pin validate --states` | wall time, median | peak memory, median |",
        "|---|---|---|",
    ]
    lines += [f"| {row['states']:,} | {row['wall_s'][1]} s | {row['peak_mib'][1]:.0f} MiB |" for row in data["rows"]]
    return lines


def robots_table() -> list[str]:
    robots, trees = result("example_robots"), result("random_trees")
    by_name: dict[str, list[dict[str, Any]]] = {}
    for entry in robots["entries"]:
        by_name.setdefault(entry["name"], []).append(entry)
    unusable = {name: [e for e in both if e["verdict"] == "unusable"] for name, both in by_name.items()}
    stopped = sorted(name for name, found in unusable.items() if len(found) == len(by_name[name]))
    partly = sorted(name for name, found in unusable.items() if found and name not in stopped)
    compared = robots["files"] - len(stopped)
    found = [entry for entry in robots["entries"] if entry.get("defect")]
    defects = {entry["name"]: entry["defect"].split(": ", 2)[-1] for entry in found}
    version = robots["example-robot-data"]
    bad = robots["verdicts"].get("disagree", 0)
    lines = [
        f"Other robots ({machine(robots)}; `python benchmarks/example_robots.py`, `benchmarks/random_trees.py`):",
        "",
        "| | robots | states, each base | agree | worst normwise error | worst share | time |",
        "|---|---|---|---|---|---|---|",
        f"| all URDFs of example-robot-data {version}, fixed and floating base | {robots['files']} "
        f"| {robots['states']:,} | {compared - bad} | {robots['worst_eps']:,.0f} eps "
        f"| {robots['worst_share_of_gate']:.2f} | {robots['seconds']:.0f} s |",
        f"| random trees of {trees['joints']} joints of all types, fixed and floating base | {trees['trees']:,} "
        f"| {trees['states_per_tree_and_base']} | {trees['trees'] - len(trees['disagree']):,} "
        f"| {trees['worst_eps']:,.0f} eps | {trees['worst_share_of_gate']:.2f} | {trees['seconds']:.0f} s |",
        "",
        "The trees also pass states at 300 m/s and 300 rad/s, where terms that cancel leave their rounding",
        "in both programs; *share* is what the verdict rests on.",
        "",
        f"{len(stopped)} of the {robots['files']} are stopped by a defect of their file:",
        "",
    ]
    lines += [f"- `{name}`: {defects[name]}" for name in stopped]
    told = {name: f"`{name}` agrees on a floating base; on a fixed one it has no joint to compare." for name in partly}
    return [*lines, "", *told.values()] if told else lines


TABLES: dict[str, dict[str, Callable[[], list[str]]]] = {
    "README.md": {
        "agreement": agreement_table,
        "speed": kernel_tables.speed,
        "cost": cost_table,
        "robots": robots_table,
        "audit": proof_tables.audit,
        "bounds": proof_tables.bounds,
    },
    "docs/gate.md": {"errors": proof_tables.errors},
    "docs/kernel.md": {
        "joints": kernel_tables.joints,
        "operations": kernel_tables.operations,
        "peers": kernel_tables.peers,
    },
}
"""By page, then by marker."""


def rebuilt(page: str, text: str) -> str:
    """A page with its tables made anew."""
    for name, table in TABLES[page].items():
        begin, end = f"<!-- table: {name} -->\n", f"<!-- end: {name} -->"
        head, rest = text.split(begin)
        text = head + begin + "\n".join(table()) + "\n" + end + rest.split(end, 1)[1]
    return text


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true")
    check = parser.parse_args().check
    old = {page: (TOP / page).read_text() for page in TABLES}
    new = {page: rebuilt(page, text) for page, text in old.items()}
    if check:
        print("the tables are up to date" if new == old else "run python benchmarks/readme_tables.py")
        return int(new != old)
    for page, text in new.items():
        (TOP / page).write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
