"""Tables of the kernel: speed for the README, peers and operations for docs/kernel.md."""

from __future__ import annotations

from typing import Any

from saved import machine, result

Rows = list[dict[str, Any]]

ROBOTS = {"rttrr": "RTTRR", "ur5_robot": "UR5", "panda": "Panda with fingers", "talos_reduced": "Talos reduced"}

STATES = 100_000

OURS = {"kernel_rows": "rttrr-pin, rows (N, n)", "kernel_columns": "rttrr-pin, columns (n, N)"}

LIMITS = {"copy": "limit: copy of the same bytes"}


def speed() -> list[str]:
    """How many times faster than Pinocchio, and what starting costs."""
    data, one, start = result("kernel_speed"), result("kernel_one"), result("kernel_start")
    pin = data["versions"]["pin"]
    lines = [
        f"Speed of `robot.compile()` against Pinocchio {pin} ({machine(data)}; `python benchmarks/kernel_speed.py`, "
        "`kernel_one.py`, `kernel_start.py`; results are compared before anything is timed, medians):",
        "",
        f"| tau, {STATES:,} states | ns a state, one thread | times `rneaInParallel`, one thread | all threads "
        "| in columns, one thread | one state from Python, times `rnea` | with all wrenches, times `rnea` + `data.f` "
        "| compile; from cache |",
        "|---|---|---|---|---|---|---|---|",
    ]
    cores = data["machine"]["cores"]
    for (key, name), single, first in zip(ROBOTS.items(), one["robots"], start["first_calls"], strict=True):
        rows, columns = (_row(data["rows"], key, what) for what in OURS)
        lines.append(
            f"| {name} | {rows['ns_per_state']:.0f} | **{rows['times_as_fast_as_pinocchio']:.0f}** "
            f"| {_row(data['rows'], key, 'kernel_rows', cores)['times_as_fast_as_pinocchio']:.0f} "
            f"| {columns['times_as_fast_as_pinocchio']:.0f} | {single['ratio_tau']:.1f} | {single['ratio_all']:.1f} "
            f"| {first['compile_s']:.1f} s; {first['cached_s']:.2f} s |"
        )
    best = _best_peer(data["rows"])
    return [
        *lines,
        "",
        f"The fastest other program in the same run: {best}. All peers: [docs/kernel.md](docs/kernel.md).",
    ]


def _best_peer(rows: Rows) -> str:
    told = []
    for key, name in ROBOTS.items():
        others = [
            row
            for row in rows
            if row["robot"] == key and row["states"] == STATES and row["threads"] == 1 and row["verdict"] == "agrees"
            if row["what"] not in OURS
        ]
        best = min(others, key=lambda row: row["ns_per_state"])
        told.append(f"{best['what']} with {best['ns_per_state']:,.0f} ns on {name}")
    return ", ".join(told)


def peers() -> list[str]:
    """Every peer on every robot, and the limits."""
    data = result("kernel_speed")
    here = [row for row in data["rows"] if row["states"] == STATES and row["threads"] == 1]
    names = list(dict.fromkeys(row["what"] for row in here))
    first = [*OURS, *LIMITS]
    rest = sorted((name for name in names if name not in first), key=lambda name: _figure(here, "rttrr", name)[1])
    lines = [
        f"ns a state for tau of {STATES:,} states, one thread ({machine(data)}; `python benchmarks/peers_setup.py`, "
        "then `python benchmarks/kernel_speed.py`):",
        "",
        f"| | version | {' | '.join(ROBOTS.values())} |",
        f"|---|---|{'---|' * len(ROBOTS)}",
    ]
    for name in [*first, *rest]:
        version = next((row["version"] for row in here if row["what"] == name and "version" in row), "")
        cells = [_figure(here, robot, name)[0] for robot in ROBOTS]
        lines.append(f"| {OURS.get(name) or LIMITS.get(name) or name} | {version} | {' | '.join(cells)} |")
    peak = data["one_core"]
    at_peak = " | ".join(f"{peak['ns_at_peak'][robot]:.0f}" for robot in ROBOTS)
    lines.append(f"| limit: operations at {peak['peak_fma_per_ns']} fused multiply-adds a ns | | {at_peak} |")
    return lines


def _figure(rows: Rows, robot: str, what: str) -> tuple[str, float]:
    """As shown, and as sorted."""
    for row in rows:
        if row["robot"] == robot and row["what"] == what:
            if row["verdict"] in ("agrees", "limit"):
                return f"{row['ns_per_state']:,.0f}", row["ns_per_state"]
            return row["verdict"], float("inf")
    return "", float("inf")


def _row(rows: Rows, robot: str, what: str, threads: int = 1) -> dict[str, Any]:
    """One row at the states of the table."""
    return next(
        row
        for row in rows
        if (row["robot"], row["what"], row["threads"], row["states"]) == (robot, what, threads, STATES)
    )


def operations() -> list[str]:
    """Ours step by step, and published programs."""
    data = result("operation_counts")
    lines = ["| robot | traced | lumped | collected | compiled | angles |", "|---|---|---|---|---|---|"]
    for robot, steps in data["ours"].items():
        cells = [f"{step['multiplications']} / {step['additions']}" for step in steps.values()]
        lines.append(f"| {robot} | {' | '.join(cells)} | {steps['compiled']['sincos']} |")
    lines += ["", "| published or generated by others | |", "|---|---|"]
    for robot, programs in data["published"].items():
        told = "; ".join(f"{name} {counts[0]} / {counts[1]}" for name, counts in programs.items())
        lines.append(f"| {robot} | {told} |")
    return lines


def joints() -> list[str]:
    """The cost of chains of many lengths, by straight lines and by calls."""
    data = result("kernel_joints")
    lines = [
        f"Chains of revolute joints about any axes, ns a state and joint, and seconds to compile ({machine(data)}; "
        "`python benchmarks/kernel_joints.py`):",
        "",
        "| joints | as it is chosen | compiled in | by calls | compiled in |",
        "|---|---|---|---|---|",
    ]
    for count, kinds in data["joints"].items():
        chosen, calls = kinds["chosen"], kinds["calls"]
        kind = "straight lines" if chosen["kind"] == "lines" else "calls"
        lines.append(
            f"| {count} | {chosen['ns_per_state_and_joint']:.0f} ({kind}) | {chosen['compile_s']:.1f} s "
            f"| {calls['ns_per_state_and_joint']:.0f} | {calls['compile_s']:.1f} s |"
        )
    return lines
