"""Claim: the compiled kernel gives Pinocchio's torques, and is the fastest of all peers in the same run.

Run: python benchmarks/peers_setup.py, then python benchmarks/kernel_speed.py [--states N ...] [--only NAME ...].
A peer whose torques differ from Pinocchio's by more than 1e-6 of their norm in any state is reported, not ranked. The
kernel and `rneaInParallel` run in this process in turns; other peers in processes of their own, on the same states.
Exit 1 if the kernel disagrees.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

import rttrr_pin
from common import arguments, finish
from kernel_speed_limits import available_states, copy, operations, peak
from kernel_speed_report import check, compare, plot, show
from peers_run import ENVIRONMENTS, PEERS, Array, interpreter, requirements, run_peer
from rttrr_pin.implementations import Batch
from rttrr_pin.validation.sampling import Sampler

sys.path.insert(0, str(PEERS))
import pinocchio_parallel
from protocol import Job, calls_for, read, timed

ROBOTS = {
    "rttrr": "rttrr",
    "ur5_robot": "example:ur5_robot",
    "panda": "example:panda",
    "talos_reduced": "example:talos_reduced",
}
AGREEMENT = 1e-6
"""Largest difference of tau, of the norm of the state's tau, at which a time means something."""

SEED = 0


def main() -> int:
    chosen = parsed()
    check(chosen.compare, chosen.plot)
    others = [name for name in requirements()["peers"] if name != "pinocchio_parallel"]
    robots = [name for name in ROBOTS if name in chosen.only] or list(ROBOTS)
    peers = [name for name in others if name in chosen.only]
    if not chosen.only or (not peers and "kernel" not in chosen.only):
        peers = others
    rows: list[dict[str, Any]] = []
    for name in robots:
        rows += measure(name, peers, chosen)
    fits = [row for row in rows if row["what"].startswith("kernel")]
    holds = all(row["verdict"] == "agrees" for row in fits)
    needs = {name: operations(rttrr_pin.load(ROBOTS[name]).compile("tau").program) for name in robots}
    rate = peak()
    limits = {
        "peak_fma_per_ns": round(rate, 2),
        "operations": needs,
        "ns_at_peak": {name: round(need / rate, 2) for name, need in needs.items()},
    }
    figures = {
        "seed": SEED,
        "repeats": chosen.repeats,
        "one_core": limits,
        "agreement": AGREEMENT,
        "holds": holds,
        "rows": rows,
    }
    show(rows)
    if chosen.compare:
        compare(rows, chosen.compare)
    if chosen.plot:
        plot(rows, chosen.plot)
    finish("kernel_speed", figures, chosen.save)
    return int(not holds)


def parsed() -> argparse.Namespace:
    """The options."""
    names = [*ROBOTS, "kernel", *requirements()["peers"]]
    parser = arguments(__doc__ or "")
    parser.add_argument("--states", type=int, nargs="+", default=[1_000, 100_000, 1_000_000], metavar="N")
    parser.add_argument("--peer-states", type=int, nargs="*", default=[100_000], metavar="N", help="at which peers run")
    parser.add_argument("--peer-threads", choices=("one", "all"), default="one", help="one thread, or all as well")
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--only", nargs="+", choices=names, default=[], metavar="NAME", help=", ".join(names))
    parser.add_argument("--envs", type=Path, default=ENVIRONMENTS, help="folder made by peers_setup.py")
    parser.add_argument("--patience", type=float, default=300.0, help="for one run of one peer [s]")
    parser.add_argument("--compare", type=Path, metavar="OLD.json", help="an earlier result to hold this one against")
    parser.add_argument("--plot", type=Path, metavar="FILE.png")
    return parser.parse_args()


def measure(name: str, peers: list[str], chosen: argparse.Namespace) -> list[dict[str, Any]]:
    """All rows of one robot."""
    robot = rttrr_pin.load(ROBOTS[name])
    counts = sorted({available_states(count, robot.model.nv) for count in chosen.states})
    states = Sampler(robot.model, "uniform", SEED).draw(0, counts[-1])
    kernel = robot.compile(outputs="tau")
    rows: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as folder:
        urdf, file = Path(folder, f"{name}.urdf"), Path(folder, "states.npz")
        urdf.write_text(robot.model.urdf)
        for count in counts:
            write(file, robot, states, count)
            for threads in sorted({1, len(os.sched_getaffinity(0))}):
                here = {"robot": name, "states": count, "threads": threads}
                found, reference = in_process(kernel, read(file, urdf, threads), chosen.repeats, here)
                if count in chosen.peer_states and (threads == 1 or chosen.peer_threads == "all"):
                    found += in_own_processes(peers, file, urdf, reference, here, chosen)
                rows += rated(found, here)
    return rows


def write(file: Path, robot: rttrr_pin.Robot, states: Batch, count: int) -> None:
    """STATES.npz with the first states."""
    q, v, a = (x[:count] for x in (states.q, states.v, states.a))
    np.savez(file, q=q, v=v, a=a, joints=list(robot.joint_names), gravity=robot.model.gravity)


def in_process(kernel: Any, job: Job, repeats: int, here: dict[str, Any]) -> tuple[list[dict[str, Any]], Array]:
    """Pinocchio, the kernel on rows and on columns, and a copy of the same bytes, in turns; with Pinocchio's tau."""
    say(f"{here}: kernel and rneaInParallel")
    rows_out = np.empty_like(job.v)
    columns = [np.ascontiguousarray(x.T).T for x in (job.q, job.v, job.a)]
    columns_out = np.empty_like(job.v.T, order="C").T
    pinocchio = pinocchio_parallel.prepare(job)
    work = {
        "pinocchio_parallel": pinocchio.run,
        "kernel_rows": lambda: kernel(job.q, job.v, job.a, out=rows_out, threads=job.threads),
        "kernel_columns": lambda: kernel(*columns, out=columns_out, threads=job.threads),
        "copy": copy(job.q, job.v, job.a, job.threads),
    }
    calls = {what: calls_for(run) for what, run in work.items()}
    seconds: dict[str, list[float]] = {what: [] for what in work}
    for _ in range(repeats):
        for what, run in work.items():
            seconds[what].append(timed(run, calls[what]) / len(job.q))
    reference = pinocchio.result()
    taus = {"pinocchio_parallel": reference, "kernel_rows": rows_out, "kernel_columns": columns_out}
    versions = {"pinocchio_parallel": "pin", "kernel_rows": "rttrr-pin", "kernel_columns": "rttrr-pin", "copy": "numpy"}
    notes = {"pinocchio_parallel": pinocchio.note, "copy": "q, v, a read and tau written, no more"}
    rows = []
    for what, package in versions.items():
        version = f"{package} {metadata.version(package)}"
        rows.append(row(here, what, version, seconds[what], taus.get(what), reference, notes.get(what, "")))
    return rows, reference


def in_own_processes(
    peers: list[str], file: Path, urdf: Path, reference: Array, here: dict[str, Any], chosen: argparse.Namespace
) -> list[dict[str, Any]]:
    """One row for each other peer that is installed, or says why it has no figure."""
    rows, single = [], requirements()["single"]["peers"]
    for peer in peers:
        python = interpreter(peer, chosen.envs)
        if here["threads"] > 1 and peer in single:
            continue
        if python is None:
            rows.append({**here, "what": peer, "verdict": "not installed", "note": "python benchmarks/peers_setup.py"})
            continue
        say(f"{here}: {peer}")
        run = run_peer(peer, python, file, urdf, here["threads"], chosen.repeats, chosen.patience)
        if run.problem:
            rows.append({**here, "what": peer, "verdict": "failed", "note": run.problem})
        else:
            rows.append(row(here, peer, run.version, run.seconds, run.tau, reference, run.note))
    return rows


def row(
    here: dict[str, Any], what: str, version: str, seconds: Any, tau: Array | None, reference: Array, note: str
) -> dict[str, Any]:
    """One figure, with the proof that it is of the same torques."""
    worst = 0.0
    if tau is not None:
        known = reference[: len(tau)]
        norms = np.linalg.norm(known, axis=1)
        worst = float((np.linalg.norm(tau - known, axis=1) / np.where(norms > 0, norms, 1.0)).max())
    times = [1e9 * x for x in seconds]
    return {
        **here,
        "what": what,
        "verdict": "limit" if tau is None else "agrees" if worst <= AGREEMENT else "disagrees",  # NaN disagrees
        "worst": worst,
        "ns_per_state": round(float(np.median(times)), 2),
        "least_and_most": [round(min(times), 2), round(max(times), 2)],
        "version": version,
        "note": note,
    }


def rated(rows: list[dict[str, Any]], here: dict[str, Any]) -> list[dict[str, Any]]:
    """The same rows with how many times as fast as `rneaInParallel`, and as the copy, each is."""
    base = {row["what"]: row["ns_per_state"] for row in rows if row["what"] in ("pinocchio_parallel", "copy")}
    for entry in rows:
        if entry["verdict"] in ("agrees", "limit"):
            entry["times_as_fast_as_pinocchio"] = round(base["pinocchio_parallel"] / entry["ns_per_state"], 3)
            entry["share_of_copy_speed"] = round(base["copy"] / entry["ns_per_state"], 4)
    return rows


def say(line: str) -> None:
    """Progress."""
    print(line, file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
