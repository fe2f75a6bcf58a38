"""The tables of the documents, made from benchmarks/results: `python benchmarks/tables.py [--check]`.

A page holds the table of a name between `<!-- table: NAME -->` and `<!-- end: NAME -->`. Without --check the pages are
rewritten; with it, exit 1 if one is out of date.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from common import Lines, machine_of, result, table
from conform_tables import CONFORM
from loads_tables import LOADS
from rttrr_pin.core.conventions import CONVENTIONS, POINTS

TOP = Path(__file__).parents[1]

PAGES = [TOP / "README.md", *sorted((TOP / "docs").glob("*.md"))]

Rows = list[dict[str, Any]]

ROBOTS = {"rttrr": "RTTRR", "ur5_robot": "UR5", "panda": "Panda with fingers", "talos_reduced": "Talos reduced"}

EXAMPLES = {"example:panda": "Panda with fingers", "example:talos_reduced": "Talos reduced"}

STATES = 100_000
"""Of the tables of speed."""

OURS = {"kernel_rows": "rttrr-pin, rows (N, n)", "kernel_columns": "rttrr-pin, columns (n, N)"}

LIMITS = {"copy": "limit: copy of the same bytes"}


def measured(data: dict[str, Any], script: str) -> str:
    """On what a result was measured, and by what."""
    return f"{machine_of(data)}; `python benchmarks/{script}.py`"


def agreement() -> Lines:
    data = result("agreement")
    worst, pin = data["worst"], data["versions"]["pin"]
    return [
        f"{data['states']:,} random states of RTTRR with a random payload, rttrr-pin and Pinocchio {pin}: "
        f"**{data['verdict']}** ({measured(data, 'agreement')}).",
        "",
        *table(
            ["", *worst],
            [
                ["worst difference, eps of the link's own norm", *(f"{x['worst_eps']:.0f}" for x in worst.values())],
                ["worst error / tolerance", *(f"{x['worst_of_tolerance']:.2f}" for x in worst.values())],
            ],
        ),
    ]


def cost() -> Lines:
    data = result("cost")
    return [
        f"Cost of the whole command, process start included ({measured(data, 'validate_cost')}):",
        "",
        *table(
            ["`rttrr-pin validate --states`", "wall time, median", "peak memory, median"],
            [(f"{x['states']:,}", f"{x['wall_s'][1]} s", f"{x['peak_mib'][1]:.0f} MiB") for x in data["rows"]],
        ),
    ]


def validate_speed() -> Lines:
    data, all_robots = result("validate_speed"), result("example_robots")
    walls = data["million_wall_s"]
    return [
        "`validate` in one process, all five quantities against Pinocchio with allowances and adjudication, beside "
        f"`rneaInParallel` on the same {data['states']:,} states, which gives tau alone: microseconds of the processor "
        f"for a state, all threads together, least and median ({measured(data, 'validate_speed')}):",
        "",
        *table(
            ["", "links", "`validate`", "`rneaInParallel`", "times that, median"],
            [
                (x["robot"], x["links"], *(f"{a}, {b}" for a, b in (x["validate"], x["rneaInParallel"])), x["quotient"])
                for x in data["rows"]
            ],
        ),
        "",
        f"`rttrr-pin validate --states 1000000`: {walls[0]} to {walls[-1]} s from outside. All example robots, "
        f"{all_robots['states']:,} states on each base: {all_robots['seconds']} s.",
    ]


def robots() -> Lines:
    data, trees = result("example_robots"), result("random_trees")
    by_name: dict[str, Rows] = {}
    for entry in data["entries"]:
        by_name.setdefault(entry["name"], []).append(entry)
    unusable = {name: sum(e["verdict"] == "unusable" for e in both) for name, both in by_name.items()}
    stopped = sorted(name for name, count in unusable.items() if count == len(by_name[name]))
    partly = sorted(name for name, count in unusable.items() if count and name not in stopped)
    defects = {e["name"]: e["defect"].split(": ", 2)[-1] for e in data["entries"] if e.get("defect")}
    agree = data["files"] - len(stopped) - data["verdicts"].get("disagree", 0)
    return [
        f"Other robots ({measured(data, 'example_robots')}, `benchmarks/random_trees.py`):",
        "",
        *table(
            ["", "robots", "states, each base", "agree", "worst normwise error", "worst error / tolerance", "time"],
            [
                (
                    f"all URDFs of example-robot-data {data['example-robot-data']}, fixed and floating base",
                    data["files"],
                    f"{data['states']:,}",
                    agree,
                    *_worst(data),
                ),
                (
                    f"random trees of {trees['joints']} joints of all types, fixed and floating base",
                    f"{trees['trees']:,}",
                    trees["states_per_tree_and_base"],
                    f"{trees['trees'] - len(trees['disagree']):,}",
                    *_worst(trees),
                ),
            ],
        ),
        "",
        "The trees also pass states at 300 m/s and 300 rad/s, where terms that cancel leave their rounding",
        "in both programs; the verdict rests on error / tolerance.",
        "",
        f"{len(stopped)} of the {data['files']} are stopped by a defect of their file:",
        "",
        *(f"- `{name}`: {defects[name]}" for name in stopped),
        *([""] if partly else []),
        *(f"`{name}` agrees on a floating base; on a fixed one it has no joint to compare." for name in partly),
    ]


def _worst(data: dict[str, Any]) -> tuple[str, str, str]:
    return f"{data['worst_eps']:,.0f} eps", f"{data['worst_of_tolerance']:.2f}", f"{data['seconds']:.0f} s"


def audit() -> Lines:
    paper, misprints = result("audit_paper"), result("audit_misprints")
    derived = next(row["n"][1] for row in result("derive")["rows"] if row["robot"] == "rttrr")
    kinds = ", ".join(f"{count} {kind}" for kind, count in sorted(paper["kinds"].items(), key=lambda pair: -pair[1]))
    seen = misprints["copies_with_slips"] - len(misprints["copies_not_reported"])
    return [
        f"Audit of the paper ({measured(paper, 'audit_paper')}, `benchmarks/derive.py`, "
        f"`tests/fuzz/misprint_campaign.py`): of {paper['components']} components with {paper['printed_terms']:,} "
        f"printed terms, **{paper['match']} match, {paper['differs']} differ, {paper['unparsed']} are unparsed**; "
        f"{paper['findings']} findings: {kinds}. {paper['dimensionally_wrong']} printed terms have the wrong "
        "dimension, which needs no derivation. Every corrected equation is symbolically equal to the derivation and "
        f"lies in the same interval. {paper['seconds_median']:.1f} s; all moments n_i, derived and written, in "
        f"{derived:.1f} s.",
        "",
        f"Planted misprints: {misprints['slips']:,} errors in {misprints['copies_with_slips']:,} copies, one to three "
        f"in each; {seen:,} copies found, {100 * misprints['named_with_kind_and_term']:.1f} % of the errors named with "
        f"kind and term; {len(misprints['clean_components_reported'])} findings in "
        f"{misprints['clean_copies_of_60_components']} clean copies of all 60.",
    ]


def bounds() -> Lines:
    data = result("bounds")
    rows = []
    for name, robot in data["robots"].items():
        tau, n = robot["quantities"]["tau"], robot["quantities"]["n"]
        over = f"{tau['bound_over_error_median']:.0f}; {n['bound_over_error_median']:.0f}"
        largest, time = f"{tau['largest_error_eps']:.1f}", f"{robot['time_with_bounds_over_plain']:.1f}"
        rows.append((EXAMPLES.get(name, name.upper()), f"{robot['states']:,}", over, largest, time))
    over = "bound over true error, median (tau; n)"
    return [
        f"The kernel's own rounding bound, proven in interval arithmetic ({measured(data, 'bounds')}): "
        f"**{data['violations']} violations**.",
        "",
        *table(["", "states", over, "largest true error of tau, eps", "time with bounds, times plain"], rows),
    ]


def errors() -> Lines:
    data = result("accuracy")
    rows = []
    for name, robot in data["robots"].items():
        eps = robot["errors_eps"]
        for quantity, kernel in eps["kernel"].items():
            nearer, farther = (100 * eps[f"{who}_nearer"][quantity] for who in ("kernel", "pinocchio"))
            both = (_spread(figures) for figures in (kernel, eps["pinocchio"][quantity]))
            rows.append((name, quantity, *both, f"{nearer:.0f} %; {farther:.0f} %"))
    return [
        "Distance from the true value in eps of the norm of the true vector, of the link that is farthest off, in "
        f"{data['states']:,} uniform states ({measured(data, 'accuracy')}): median / 99.9 % / worst.",
        "",
        *table(["", "", "rttrr-pin", "Pinocchio", "states in which rttrr-pin is nearer; farther"], rows),
    ]


def _spread(figures: dict[str, float]) -> str:
    return f"{figures['median']:.2f} / {figures['p999']:,.1f} / {figures['worst']:,.0f}"


def speed() -> Lines:
    """How many times faster than Pinocchio, and what starting costs."""
    data, one, start = result("kernel_speed"), result("kernel_one"), result("kernel_start")
    cores, rows = data["machine"]["cores"], []
    for (key, name), single, first in zip(ROBOTS.items(), one["robots"], start["first_calls"], strict=True):
        by_rows, by_columns = (_row(data["rows"], key, what) for what in OURS)
        all_threads = _row(data["rows"], key, "kernel_rows", cores)
        times = [x["times_as_fast_as_pinocchio"] for x in (by_rows, all_threads, by_columns)]
        rows.append(
            (
                name,
                f"{by_rows['ns_per_state']:.0f}",
                f"**{times[0]:.0f}**",
                *(f"{x:.0f}" for x in times[1:]),
                f"{single['ratio_tau']:.1f}",
                f"{single['ratio_all']:.1f}",
                f"{first['compile_s']:.1f} s; {first['cached_s']:.2f} s",
            )
        )
    header = [
        f"tau, {STATES:,} states", "ns a state, one thread", "times `rneaInParallel`, one thread", "all threads",
        "in columns, one thread", "one state from Python, times `rnea`", "with all wrenches, times `rnea` + `data.f`",
        "compile; from cache",
    ]  # fmt: skip
    return [
        f"Speed of `robot.compile()` against Pinocchio {data['versions']['pin']} ({measured(data, 'kernel_speed')}, "
        "`kernel_one.py`, `kernel_start.py`; results are compared before anything is timed, medians):",
        "",
        *table(header, rows),
        "",
        f"The fastest other program in the same run: {_best_peers(data['rows'])}. All peers: "
        "[docs/kernel.md](docs/kernel.md).",
    ]


def calls() -> Lines:
    """One state, by the calls that a user writes, and what Pinocchio takes for the same."""
    data = result("kernel_one")
    rows = [
        (ROBOTS[key], *(f"{single['us'][name]:.1f}, {single['ratios'][name]:.2f}" for name in single["ratios"]))
        for key, single in zip(ROBOTS, data["robots"], strict=True)
    ]
    names = data["robots"][0]["ratios"]
    return [
        f"Microseconds a call of one state, and their ratio to Pinocchio's ({measured(data, 'kernel_one')}, in turns, "
        "medians):",
        "",
        *table(["", *(f"`{name}` / {data['references'][name]}" for name in names)], rows),
    ]


def float32() -> Lines:
    """Both types in turns, and the bound in float32."""
    data = result("kernel_float32")
    rows = []
    for key, own in data["robots"].items():
        few, many = own["speed"]
        cells = [
            f"{of['ns_per_state'][f'float64, {layout}']:.0f} / {of['ns_per_state'][f'float32, {layout}']:.0f} = "
            f"**{of['times_as_fast'][layout]:.1f}**"
            for of in (few, many)
            for layout in ("rows", "columns")
        ]
        proof = own["proof"]
        bound = (
            f"{proof['largest_share_of_bound']:.2f}; {proof['bound_times_error_median']:.0f}",
            f"{proof['allowance_times_bound_median']:.0f}",
        )
        rows.append((ROBOTS[key], *cells, *bound))
    proven = data["robots"]["rttrr"]["proof"]["states"]
    few, many = (f"{own['states']:,}" for own in data["robots"]["rttrr"]["speed"])
    return [
        f"ns a state in float64 / in float32, tau on one thread, CPU time, in turns; errors of tau at {proven:,} "
        f"uniform states, proven by intervals ({measured(data, 'kernel_float32')}):",
        "",
        *table(
            [
                *("", f"{few} rows", f"{few} columns", f"{many} rows", f"{many} columns"),
                "largest error / bound; bound / error, median",
                "allowance of an unknown float32 program / bound, median",
            ],
            rows,
        ),
    ]


def _row(rows: Rows, robot: str, what: str, threads: int = 1) -> dict[str, Any]:
    """One row at the states of the table."""
    wanted = (robot, what, threads, STATES)
    return next(row for row in rows if (row["robot"], row["what"], row["threads"], row["states"]) == wanted)


def _best_peers(rows: Rows) -> str:
    peers = [row for row in rows if (row["states"], row["threads"], row["verdict"]) == (STATES, 1, "agrees")]
    best = {
        name: min(
            (row for row in peers if row["robot"] == key and row["what"] not in OURS),
            key=lambda row: float(row["ns_per_state"]),
        )
        for key, name in ROBOTS.items()
    }
    return ", ".join(f"{row['what']} with {row['ns_per_state']:,.0f} ns on {name}" for name, row in best.items())


def peers() -> Lines:
    """Every peer on every robot, and the limits."""
    data = result("kernel_speed")
    here = [row for row in data["rows"] if row["states"] == STATES and row["threads"] == 1]
    first = [*OURS, *LIMITS]
    others = dict.fromkeys(row["what"] for row in here if row["what"] not in first)
    rows = []
    for what in [*first, *sorted(others, key=lambda what: _nanoseconds(here, "rttrr", what)[1])]:
        version = next((row["version"] for row in here if row["what"] == what and "version" in row), "")
        cells = (_nanoseconds(here, robot, what)[0] for robot in ROBOTS)
        rows.append((OURS.get(what) or LIMITS.get(what) or what, version, *cells))
    peak = data["one_core"]
    at_peak = (f"{peak['ns_at_peak'][robot]:.0f}" for robot in ROBOTS)
    rows.append((f"limit: operations at {peak['peak_fma_per_ns']} fused multiply-adds a ns", "", *at_peak))
    return [
        f"ns a state for tau of {STATES:,} states, one thread ({machine_of(data)}; `python benchmarks/peers_setup.py`, "
        "then `python benchmarks/kernel_speed.py`):",
        "",
        *table(["", "version", *ROBOTS.values()], rows),
    ]


def batches() -> Lines:
    """Small and large batches, by kind of call."""
    data = result("kernel_batches")
    threads = data["processors"]
    kinds = ["rows", "columns", "rows of float32", f"rows, {threads} threads", f"columns, {threads} threads"]
    rows = []
    for key, name in ROBOTS.items():
        for count in dict.fromkeys(row["states"] for row in data["rows"]):
            here = {row["what"]: row for row in data["rows"] if (row["robot"], row["states"]) == (key, count)}
            cells = (f"{here[kind]['ns_per_state']:.0f}, {here[kind]['times']:.0f}" for kind in kinds)
            several, copied = (
                here[what]["ns_per_state"] for what in ("all outputs", "copy of the bytes of all outputs")
            )
            rows.append((name, f"{count:,}", *cells, f"{several:.0f}, {several / copied:.1f}"))
    load = " to ".join(f"{x:.1f}" for x in data["load"])
    return [
        "ns a state for tau, and how many times as fast as `rneaInParallel` on one thread; all of tau, F, N, f, n, and "
        f"how many times as long as a copy of their bytes ({measured(data, 'kernel_batches')}; one thread by its "
        f"processor time, several by the clock, while the machine had {load} processes to run):",
        "",
        *table(["", "states", *kinds, "all outputs, rows"], rows),
    ]


def _nanoseconds(rows: Rows, robot: str, what: str) -> tuple[str, float]:
    """As shown, and as sorted."""
    for row in rows:
        if row["robot"] == robot and row["what"] == what:
            if row["verdict"] in ("agrees", "limit"):
                return f"{row['ns_per_state']:,.0f}", row["ns_per_state"]
            return row["verdict"], float("inf")
    return "", float("inf")


def operations() -> Lines:
    """The kernel's, step by step, and those of published programs."""
    data = result("operation_counts")
    rows = [
        (name, *(f"{x['multiplications']} / {x['additions']}" for x in steps.values()), steps["compiled"]["sincos"])
        for name, steps in data["ours"].items()
    ]
    published = {
        name: "; ".join(f"{program} {n[0]} / {n[1]}" for program, n in programs.items())
        for name, programs in data["published"].items()
    }
    return [
        *table(["robot", "traced", "compiled: regrouped", "angles"], rows),
        "",
        *table(["published or generated by others", ""], published.items()),
    ]


def joints() -> Lines:
    """The cost of chains of many lengths, by straight lines and by calls."""
    data = result("kernel_joints")
    rows = []
    for count, kinds in data["joints"].items():
        chosen, calls = kinds["chosen"], kinds["calls"]
        kind = "straight lines" if chosen["kind"] == "lines" else "calls"
        nanoseconds = f"{chosen['ns_per_state_and_joint']:.0f} ({kind})", f"{calls['ns_per_state_and_joint']:.0f}"
        seconds = f"{chosen['compile_s']:.1f} s", f"{calls['compile_s']:.1f} s"
        rows.append((count, nanoseconds[0], seconds[0], nanoseconds[1], seconds[1]))
    return [
        f"Chains of revolute joints about any axes, ns a state and joint, and seconds to compile "
        f"({measured(data, 'kernel_joints')}):",
        "",
        *table(["joints", "as it is chosen", "compiled in", "by calls", "compiled in"], rows),
    ]


def gpu() -> Lines:
    """What NVRTC makes of the kernels of a GPU."""
    data = result("cuda_registers")
    rows = []
    for row in data["rows"]:
        spills = f"{row['spill_store_bytes'] + row['spill_load_bytes']:,}" if row["spill_store_bytes"] else "none"
        shared = f"{row['threads']}, {row['shared_bytes']:,}" if row["shared_bytes"] else f"{row['threads']}, none"
        name = EXAMPLES.get(row["robot"]) or ROBOTS[row["robot"].removeprefix("example:")]
        rows.append((name, row["outputs"], row["dtype"], row["registers"], spills, shared, f"{row['compile_s']:.1f} s"))
    nvrtc, core = data["nvrtc"]["nvidia-cuda-nvrtc"], data["nvrtc"]["cuda-core"]
    return [
        f"Compiled for {data['architecture']} by NVRTC {nvrtc} through cuda-core {core}, without a GPU "
        f"({measured(data, 'cuda_registers')}):",
        "",
        *table(
            [
                "robot",
                "outputs",
                "type",
                "registers a thread",
                "bytes spilled",
                "threads, shared bytes",
                "processor time",
            ],
            rows,
        ),
    ]


def faults() -> Lines:
    """What is named of planted faults, and how long it takes."""
    bench, times = result("fault_bench"), result("diagnose_time")
    counts = bench["counts"]
    rows = [
        (
            what,
            f"{counts[what]:,}",
            f"{counts[f'{what} detected']:,}",
            f"{counts[f'{what} named']:,}",
            f"{counts[f'{what} the same in other words']:,}",
            f"{100 * bench['named_or_the_same'][what]:.1f} %",
        )
        for what in ("singles", "pairs")
    ]
    seconds = {
        EXAMPLES.get(row["robot"], row["robot"].upper()): max(
            other["seconds"] for other in times["rows"] if other["robot"] == row["robot"]
        )
        for row in times["rows"]
    }
    fewest, most = bench["hypotheses_of_a_robot"]
    return [
        f"Faults from the whole catalogue, planted in {bench['robots']} random robots "
        f"({measured(bench, 'fault_bench')}; {fewest:,} to {most:,} hypotheses each; tau alone):",
        "",
        *table(["", "planted", "detected", "named", "the same in other words", "together"], rows),
        "",
        f"{counts['clean']:,} clean results, half of them printed to six digits: {counts.get('false alarms', 0)} false "
        "alarms. "
        f"`rttrr-pin diagnose` with one fault in {times['rows'][0]['states']} states, start included "
        f"(`python benchmarks/diagnose_time.py`): "
        + ", ".join(f"{name} {x:.1f} s" for name, x in seconds.items())
        + ".",
    ]


def main_path() -> Lines:
    commands = result("main_path")["commands"]
    keys = ("files", "functions", "classes", "modules")
    return table(["`rttrr-pin`", *keys], [(f"`{name}`", *(x[key] for key in keys)) for name, x in commands.items()])


def installed_size() -> Lines:
    groups = result("installed_size")["megabytes"]
    rows = [
        (extra, f"`{name}`", x["own_mb"], x["with_its_own_mb"], x["packages"])
        for extra, packages in groups.items()
        for name, x in packages.items()
    ]
    return table(["installed", "package", "MB", "MB with what it alone brings", "packages"], rows)


SUITES = {
    "adam": "one random state, rates of up to 2.5; at rest; unit accelerations; 1e-4, as adam's `test_jax.py` of bias "
    "force, gravity and mass matrix",
    "mujoco_warp": "one random state, rates of up to 0.01; 5e-3 + 5e-3 of it, as MuJoCo Warp's `inverse_test.py`",
    "gravity": "ten poses at rest; 1e-6",
    "loose": "ten random states; 1e-2",
    "usual": "ten random states; 1e-6",
    "rounding": "a hundred random states; what rounding explains, as `rttrr-pin validate`",
}
"""By name, what a suite of benchmarks/mutation_scores.py compares."""


def mutation_scores() -> Lines:
    """What each suite lets pass, on each robot."""
    data = result("mutation_scores")
    suites = data["suites"]
    rows = [(said, *(_passing(x) for x in suites[name]["robots"].values())) for name, said in SUITES.items()]
    robots = [f"{robot}, of {x['10 %']['mutants']:,}" for robot, x in suites["adam"]["robots"].items()]
    return [
        "Wrong dynamics that pass, where numbers that may be any are 10 % wrong (in parentheses: 1 %), tau alone "
        "(`python benchmarks/mutation_scores.py`):",
        "",
        *table(["states and tolerance [N, N m]", *robots], rows),
    ]


def _passing(by_size: dict[str, Any]) -> str:
    large, small = (by_size[size] for size in ("10 %", "1 %"))
    return (
        f"{large['passing']:,}, {large['passing'] / large['mutants']:.0%} ({small['passing'] / small['mutants']:.0%})"
    )


def kit() -> Lines:
    """Time of the kit."""
    data = result("kit_time")
    low, median, high = data["processor_seconds"]
    count = data["checks"]["passed"]
    return [
        f"All checks of a plain NumPy function on RTTRR ({count}, {data['states']} states each), start of pytest "
        f"included: **{median:.1f} s** of one processor ({low:.1f} to {high:.1f} s; {measured(data, 'kit_time')})."
    ]


def single_precision() -> Lines:
    """How much of the float32 bound right programs use, and how far beyond it a mass that is off lies."""
    data = result("single_precision")
    most, many = [max(own["mass_off"]["most"] for own in rows) for rows in (data["rows"], data["rows"][-1:])]
    few = min(own["mass_off"]["least"] for own in data["rows"][:-1])
    least = data["rows"][-1]["mass_off"]["least"]
    return [
        "Two programs in NumPy's float32, our recursion and Featherstone's in spatial vectors, use at most "
        f"{100 * data['worst']:.0f} % of it in {data['states']:,} states of every level. Faults are seen all the same: "
        f"0.1 % of the mass of any one link is {few:.0f} to {most:.0f} times the bound in F of that "
        f"link; on sixty joints, at whose ends float32 has lost it, {least:.1f} to {many:.0f} times "
        f"({measured(data, 'single_precision')}).",
    ]


def three_numbers() -> Lines:
    """What the README claims, each with the page that has all of it."""
    million, all_robots, fast = result("agreement"), result("example_robots"), result("kernel_batches")
    bad = {entry["name"] for entry in all_robots["entries"] if entry["verdict"] != "agree"}
    stopped = {
        name for name in bad if all(e["verdict"] == "unusable" for e in all_robots["entries"] if e["name"] == name)
    }
    disagree = all_robots["verdicts"].get("disagree", 0)
    agree = all_robots["files"] - len(stopped) - disagree
    times = [row["times"] for row in fast["rows"] if (row["states"], row["what"]) == (STATES, "rows")]
    return [
        f"- {million['states']:,} random states of the bundled arm: **{million['verdict']}**, link by link.",
        f"- **{agree} of {all_robots['files']}** example robots agree on both bases; the others' files are defective.",
        f"- **{min(times):.0f} to {max(times):.0f} times** `rneaInParallel` on one thread, {STATES:,} states at once.",
        "",
        f"{machine_of(fast)}; scripts and tables: [docs/benchmarks.md](docs/benchmarks.md).",
    ]


def vectors() -> Lines:
    data, checked = result("vectors"), result("vectors_check")
    counts = [sum(own["widths"][name] for own in checked["robots"].values()) for name in data["widths"]]
    rows = [
        [
            name,
            ", ".join(own["levels"]),
            own["links"],
            f"{own['states']:,}",
            f"{own['numbers']:,}",
            f"{own['outside']:,}",
        ]
        for name, own in checked["robots"].items()
    ]
    return [
        f"The bundled set: {data['states']:,} states, {sum(data['widths'].values()):,} true values, "
        f"{data['bytes'] / 1e6:.1f} MB, {data['bytes_packed'] / 1e6:.1f} MB packed ({measured(data, 'vectors')}).",
        "",
        f"Checked on {checked['states']:,} states by a program of its own with {checked['digits']} digits "
        f"({measured(checked, 'vectors_check')}): **{checked['outside']:,} of {checked['numbers']:,} true values "
        f"outside** their enclosure. Of the enclosures {counts[0]:,} are one double, {counts[1]:,} two neighbours, "
        f"{counts[2] + counts[3]:,} wider.",
        "",
        *table(["robot", "levels", "links", "states", "true values", "outside"], rows),
    ]


def conventions() -> Lines:
    header = ("program", "where", "axes", "moment about", "acts on", "first", "how we know")
    return table(
        header,
        [
            (
                f"`{x.name}`<br>{x.program}",
                x.quantity,
                "child link" if x.axes == "link" else "world",
                POINTS[x.point],
                f"the {x.acts_on}",
                x.first,
                x.verified,
            )
            for x in CONVENTIONS
        ],
    )


def convention_remarks() -> Lines:
    def linked(source: str) -> str:
        name = re.sub(r"#.*", "", source).rstrip("/").rpartition("/")[2] or source
        return f"[{name}]({source})" if source.startswith("http") else source

    rows = [(f"`{x.name}`", x.fixed, x.remark, ", ".join(map(linked, x.source))) for x in CONVENTIONS]
    return table(("", "fixed joint", "mind that", "read"), rows)


TABLES: dict[str, Callable[[], Lines]] = {
    "agreement": agreement, "audit": audit, "batches": batches, "bounds": bounds, "calls": calls,
    "convention remarks": convention_remarks, "conventions": conventions, "cost": cost, "errors": errors,
    "faults": faults, "float32": float32, "gpu": gpu, "installed size": installed_size, "joints": joints, "kit": kit,
    "main path": main_path,
    "single precision": single_precision, "mutation scores": mutation_scores, "operations": operations,
    "peers": peers, "robots": robots, "speed": speed, "three numbers": three_numbers,
    "validate speed": validate_speed, "vectors": vectors,
} | CONFORM | LOADS  # fmt: skip
"""By the name in the marker."""

MARKED = re.compile(r"(<!-- table: ([\w ]+) -->\n).*?(<!-- end: \2 -->)", re.DOTALL)


def rebuilt(page: Path) -> str:
    """A page with its tables made anew."""
    text = MARKED.sub(lambda match: match[1] + "\n".join([*TABLES[match[2]](), match[3]]), page.read_text())
    return text if page.parent == TOP else text.replace("](docs/", "](")


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--check", action="store_true")
    check = parser.parse_args().check
    stale = {page: text for page in PAGES if (text := rebuilt(page)) != page.read_text()}
    if check:
        print(
            f"run python benchmarks/tables.py: {[page.name for page in stale]}"
            if stale
            else "the tables are up to date"
        )
        return int(bool(stale))
    for page, text in stale.items():
        page.write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
