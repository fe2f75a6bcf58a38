"""What every benchmark writes: its figures, with machine and versions, as JSON."""

from __future__ import annotations

import argparse
import json
import os
import platform
from importlib import metadata
from pathlib import Path
from typing import Any

RESULTS = Path(__file__).parent / "results"

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


def finish(name: str, figures: dict[str, Any], save: bool) -> None:
    """Print the figures, and write them whole if asked to."""
    versions = {package: metadata.version(package) for package in PACKAGES}
    text = json.dumps({"benchmark": name, "machine": machine(), "versions": versions, **figures}, indent=2) + "\n"
    print(text, end="")
    if save:
        RESULTS.mkdir(exist_ok=True)
        target = RESULTS / f"{name}.json"
        partial = target.with_suffix(".json.partial")
        partial.write_text(text)
        partial.replace(target)
