"""The tables of docs/loads.md."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from common import Lines, machine_of, result, table


def loads_speed() -> Lines:
    """What ten million rows take."""
    data = result("loads_speed")
    head = ["what is computed", "rows a second", "seconds", "files", "kernel [s]", "envelope [s]", "memory"]
    rows = [
        [
            run["name"],
            f"{run['rows_a_second']:,.0f}",
            f"{run['seconds']:.1f}",
            f"{100 * run['files_share']:.0f} %",
            f"{run['kernel']:.2f}",
            f"{run['envelope']:.2f}",
            f"{run['peak_bytes'] / 1e6:.0f} MB",
        ]
        for run in data["runs"]
    ]
    said = (
        f"{data['rows']:,} rows with time, q, v, a; *files* is the share of reading, decoding, checking and writing; "
        "*kernel* has the parts of what bearings carry in it; *memory* is the most of the whole process"
    )
    return [f"{said} ({machine_of(data)}; `python benchmarks/loads_speed.py`).", "", *table(head, rows)]


def error_band() -> Lines:
    """How often the true load lies within the band."""
    data = result("error_band")
    head = ["robot, motion", "rows a second", "noise of q", "tau", "f", "n", "power", "error / sigma of tau"]
    rows: list[list[Any]] = [
        [
            f"{case['robot']}, {case['motion']}",
            f"{case['rate']:g}",
            f"{case['noise']:g}",
            *(f"{100 * case['inside'][key]:.1f} %" for key in ("tau", "f", "n", "power")),
            f"{case['rms']['tau']:.2f}",
        ]
        for case in data["cases"]
    ]
    said = f"How often the true load lies within the band of 95 percent, {data['rows']:,} rows each; noise in rad and m"
    return [f"{said} (`python benchmarks/error_band.py`).", "", *table(head, rows)]


LOADS: dict[str, Callable[[], Lines]] = {"loads speed": loads_speed, "error band": error_band}
"""By the name in the marker."""
