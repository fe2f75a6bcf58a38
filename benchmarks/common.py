"""What every benchmark writes and reads: figures, with machine and versions, as JSON."""

from __future__ import annotations

import argparse
import json
import os
import platform
import re
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path
from typing import Any

RESULTS = Path(__file__).parent / "results"

WIDTH = 100
"""Of a line of results, about; a record of numbers and words alone is one line, however long."""

Lines = list[str]
"""Of a page."""

PACKAGES = ("rttrr-pin", "pin", "numpy", "yourdfpy", "llvmlite")


def machine() -> dict[str, Any]:
    """The kind of machine: processor, cores, system."""
    model, vectors = platform.processor() or platform.machine(), ""
    info = Path("/proc/cpuinfo")
    if info.exists():
        lines = [line.partition(":") for line in info.read_text().splitlines()]
        model = next((value.strip() for key, _, value in lines if key.strip() == "model name"), model)
        flags = next((value.split() for key, _, value in lines if key.strip() == "flags"), [])
        vectors = "AVX-512" if "avx512f" in flags else "AVX2" if "avx2" in flags else "no AVX2"
    return {
        "processor": model,
        "vectors": vectors,
        "cores": os.cpu_count(),
        "system": platform.system(),
        "python": platform.python_version(),
    }


def arguments(description: str) -> argparse.ArgumentParser:
    """A parser with the option that all have."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--save", action="store_true", help="write benchmarks/results/<name>.json")
    return parser


def result(name: str) -> dict[str, Any]:
    """What a benchmark saved."""
    data: dict[str, Any] = json.loads((RESULTS / f"{name}.json").read_text())
    return data


def machine_of(data: dict[str, Any]) -> str:
    """The kind of machine that a result was measured on."""
    kind = data["machine"]
    return ", ".join([kind["processor"], *([kind["vectors"]] if "vectors" in kind else []), f"{kind['cores']} cores"])


def written(value: Any, indent: int = 0) -> str:
    """JSON with one line for each record, floats to nine significant digits."""
    if isinstance(value, float):
        return json.dumps(float(f"{value:.9g}"))
    if not isinstance(value, dict | list):
        return json.dumps(value)
    if isinstance(value, dict):
        pieces = [f"{json.dumps(str(key))}: {written(item, indent + 1)}" for key, item in value.items()]
    else:
        pieces = [written(item, indent + 1) for item in value]
    left, right = "{}" if isinstance(value, dict) else "[]"
    inside = list(value.values()) if isinstance(value, dict) else value
    short = sum(map(len, pieces)) < WIDTH and not any("\n" in piece for piece in pieces)
    record = indent and not any(isinstance(item, dict) or (isinstance(item, list) and len(item) > 4) for item in inside)
    if short or record:
        return left + ", ".join(pieces) + right
    start = "\n" + " " * (indent + 1)
    return left + start + f",{start}".join(pieces) + "\n" + " " * indent + right


def table(header: Iterable[Any], rows: Iterable[Iterable[Any]]) -> Lines:
    """A table in Markdown."""
    cells = [[str(cell) for cell in row] for row in (header, *rows)]
    lines = [re.sub(r" +(?=\|)", " ", f"| {' | '.join(row)} |") for row in cells]
    return [lines[0], "|" + "---|" * len(cells[0]), *lines[1:]]


def finish(name: str, figures: dict[str, Any], save: bool, show: bool = True) -> None:
    """Print the figures unless a run is still going on, and write them whole if asked to."""
    installed = {distribution.name for distribution in metadata.distributions()}
    versions = {package: metadata.version(package) for package in PACKAGES if package in installed}
    text = written({"benchmark": name, "machine": machine(), "versions": versions, **figures}) + "\n"
    if show:
        print(text, end="")
    if save:
        RESULTS.mkdir(exist_ok=True)
        target = RESULTS / f"{name}.json"
        partial = target.with_suffix(".json.partial")
        partial.write_text(text)
        partial.replace(target)
