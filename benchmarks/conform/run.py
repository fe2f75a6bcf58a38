"""Claim: the levels tell libraries apart, and each failure has a cause: every library that installs, and our own two.

Run: python benchmarks/conform/run.py [--save] [--only NAME ...] [--again] [--envs FOLDER] [--states N].
Environments that are missing are made first (`peers_setup.py`); each library is asked through its adapter
(`adapters/`), as `rttrr-pin conform` would ask any program, and timed in its own batch form. With --save
each library's outcome is written to benchmarks/results/conform.json as soon as it is there, and kept by the next run
unless --again; `python benchmarks/tables.py` then makes docs/table.md.
"""

from __future__ import annotations

import argparse
import gc
import json
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from failures import failure
from own import OWN, own_times

from common import RESULTS, finish
from peers_run import ENVIRONMENTS, python_of, requirements
from peers_setup import install
from rttrr_pin.conformance import LEVELS, LevelResult, cases, conform, level_robots
from rttrr_pin.core.model import Model
from rttrr_pin.errors import RttrrError
from rttrr_pin.implementations import Implementation, make_implementation
from rttrr_pin.implementations.program import Program

ADAPTERS = Path(__file__).parent / "adapters"

COUNTS = (1, 256, 100_000)
"""States of a call that is timed."""

TIMED = "arm6"
"""The robot that is timed."""

PLACES = ("{urdf}", "{base}", "{gravity}", "{effects}")

PATIENCE = 100.0
"""Seconds for a state; six times as long for the first, in which JAX compiles."""

LONGEST = 1500.0
"""Seconds for the timing of one library."""


def main() -> int:
    libraries: dict[str, list[str]] = requirements()["conform"]
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--save", action="store_true", help="write benchmarks/results/conform.json")
    parser.add_argument("--only", nargs="+", choices=[*OWN, *libraries], default=[*OWN, *libraries], metavar="NAME")
    parser.add_argument("--again", action="store_true", help="ask those again whose outcome is saved")
    parser.add_argument("--envs", type=Path, default=ENVIRONMENTS, help="folder of the environments")
    parser.add_argument("--states", type=int, default=32, help="states of each case")
    parser.add_argument("--times", action="store_true", help="measure the times of those that are saved anew, no more")
    parser.add_argument("--no-diagnose", action="store_true", help="do not look for causes, which takes longest")
    chosen = parser.parse_args()
    saved = json.loads(path.read_text()) if (path := RESULTS / "conform.json").exists() else {}
    entries = {(own["name"], own["float"]): own for own in saved.get("entries", [])}
    left_out: dict[str, str] = saved.get("left_out", {})
    order = [(name, "float64") for name in OWN]
    order += [(name, real) for name, (_, _, *reals) in libraries.items() for real in reals]
    for name, real in order:
        known = (name, real) in entries
        if name not in chosen.only or (chosen.times and not known) or (known and not (chosen.again or chosen.times)):
            continue
        print(f"{name} {real} ...", file=sys.stderr, flush=True)
        try:
            if chosen.times:
                entries[name, real] |= {"ns": times(name, words_of(name, real, libraries, chosen.envs))}
            else:
                entries[name, real] = asked(name, real, libraries, chosen)
            left_out.pop(name, None)
            print(f"  {entries[name, real]['standing']}", file=sys.stderr, flush=True)
        except (RttrrError, RuntimeError, OSError) as error:
            left_out[name] = plain(str(error))
            print(f"  left out: {left_out[name]}", file=sys.stderr, flush=True)
        figures = {
            "states": chosen.states,
            "timed": TIMED,
            "counts": list(COUNTS),
            "levels": {level.id: level.sentence for level in LEVELS},
            "entries": [entries[key] for key in order if key in entries],
            "left_out": left_out,
        }
        finish("conform", figures, chosen.save, show=False)
    for own in entries.values():
        print(f"{own['name']} {own['float']}: {own['standing']}")
    return 0


def words_of(name: str, real: str, libraries: dict[str, list[str]], envs: Path) -> list[str]:
    """The command of a library's adapter, whose environment is made if it is not there; none for our own programs."""
    if name in OWN:
        return []
    environment, adapter, *_ = libraries[name]
    return [str(ready(environment, envs)), str(ADAPTERS / f"{adapter}.py"), *PLACES, "--float", real]


def asked(name: str, real: str, libraries: dict[str, list[str]], chosen: argparse.Namespace) -> dict[str, Any]:
    """One library's way through the levels, and its times."""
    begin = time.perf_counter()
    words = words_of(name, real, libraries, chosen.envs)
    about: dict[str, Any] = {"versions": {}, "call": OWN.get(name, ""), "conventions": ""}
    if words:
        about = answer([*words[:2], "--about"])
    record: dict[int, Implementation] = {}  # by model; robots of levels are made once

    def program(model: Model) -> Implementation:
        record[id(model)] = Program(words, model, PATIENCE) if words else make_implementation(name, model)
        return record[id(model)]

    result = conform(program, n_states=chosen.states, precision=real, diagnose=not chosen.no_diagnose)  # type: ignore[arg-type]
    by_id = {case.id: case for case in cases(n_states=chosen.states)}
    found = [
        failure(own, by_id[own.id], record[id(by_id[own.id].robot.model)])
        for own in result.results
        if own.outcome == "fail"
    ]
    record.clear()
    gc.collect()  # ends the adapters, which would share the processor with what is timed
    return {
        "name": name,
        "float": real,
        "versions": about["versions"] or {"rttrr-pin": result.versions.get("rttrr-pin", "")},
        "call": about["call"],
        "conventions": about["conventions"],
        "adapter": Path(words[1]).name if words else "",
        "standing": result.standing.sentence(),
        "reached": result.standing.reached,
        "cases": [row(own) for own in result.results],
        "failures": found,
        "ns": times(name, words),
        "seconds": round(time.perf_counter() - begin, 1),
    }


def times(name: str, words: Sequence[str]) -> dict[str, Any]:
    """Nanoseconds a state, by number of states."""
    return timed(words) if words else own_times(name, TIMED, COUNTS)


def row(result: LevelResult) -> dict[str, Any]:
    """What the table needs of a case."""
    out: dict[str, Any] = {"id": result.id, "level": result.level, "outcome": result.outcome}
    if result.message:
        out["message"] = plain(result.message)
    if result.farthest is not None and result.worst is not None:
        out |= {"eps": result.farthest[1].eps, "of_allowance": result.worst[1].of_allowance}
        out["quantities"] = [own.quantity for own in result.quantities]
    if result.outcome in ("fail", "error"):
        out["cause"] = plain(result.cause) or "not looked for"
    return out


def plain(message: str) -> str:
    """A message without the command that was run, what stood on its stderr, and folders of this machine."""
    text = message.partition("\nits stderr ends:")[0].rpartition("replied with an error: ")[2]
    text = re.sub(r" at state \d+$", "", text)
    text = re.sub(r"(?:/[\w.+-]+)+/(?=[\w.+-])", "", text)
    return " ".join(text.split())


def ready(environment: str, envs: Path) -> Path:
    """The interpreter of an environment, which is made if it is not there."""
    python = python_of(envs / environment)
    if not python.exists():
        problem = install(envs / environment, requirements()["environments"][environment], 1800.0)
        if problem:
            raise RuntimeError(f"cannot be installed: {problem.splitlines()[-1]}")
    return python


def answer(words: Sequence[str]) -> dict[str, Any]:
    """What an adapter says once."""
    done = subprocess.run(words, capture_output=True, text=True, timeout=LONGEST)
    if done.returncode and not done.stdout:
        raise RuntimeError(f"cannot be imported: {done.stderr.strip().splitlines()[-1]}")
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found


def timed(words: Sequence[str]) -> dict[str, Any]:
    """Nanoseconds a state, by number of states; or what the library said instead."""
    case = next(case for case in cases(levels=["accelerations"], n_states=256) if case.name == TIMED)
    with tempfile.TemporaryDirectory() as folder:
        states = Path(folder, "states.npz")
        np.savez(states, q=case.batch.q, v=case.batch.v, a=case.batch.a)
        filled = [str(level_robots()[TIMED]) if word == "{urdf}" else word for word in words]
        filled = [{"{base}": "fixed", "{gravity}": "0,0,-9.81", "{effects}": "{}"}.get(word, word) for word in filled]
        try:
            found = answer([*filled, "--time", str(states), "--counts", *map(str, COUNTS)])
        except subprocess.TimeoutExpired:
            return {"error": f"not timed within {LONGEST:.0f} s"}
    return found


if __name__ == "__main__":
    sys.exit(main())
