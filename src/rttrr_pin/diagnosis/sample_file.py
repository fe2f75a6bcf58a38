"""A sample as a file: CSV or Parquet with the columns of docs/notation.md and `kind`, or JSON lines as requests."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.diagnosis.states import Sample
from rttrr_pin.errors import ImplementationError
from rttrr_pin.implementations.program import request
from rttrr_pin.implementations.text_results import column_names, payload_columns
from rttrr_pin.reporting.files import write_whole
from rttrr_pin.reporting.output import write_text

KIND = "kind"
"""The column that says what a state shows; tables of results pass it over."""


def write_sample(sample: Sample, target: str) -> None:
    """Write states, whole or not at all.

    Args:
        sample: the states.
        target: a file, whose name says the format (`FORMATS`); or "-", which is stdout, as CSV.

    Raises:
        InputError: the file cannot be written.
        ImplementationError: Parquet, and pyarrow is not installed.
    """
    if target == "-":
        write_text(target, lambda: as_csv(sample))
    else:
        write_whole(Path(target), FORMATS[Path(target).suffix.lower()](sample))


def as_csv(sample: Sample) -> str:
    """A header and a row for each state, all digits of each number."""
    names, numbers = table(sample)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*names, KIND])
    writer.writerows([*(f"{x:.17g}" for x in row), kind] for row, kind in zip(numbers, sample.kinds, strict=True))
    return text.getvalue()


def as_json_lines(sample: Sample) -> str:
    """A line for each state, as a program reads it."""
    return b"".join(request(sample.states, k) for k in range(len(sample))).decode()


def as_parquet(sample: Sample) -> bytes:
    """The columns of the CSV file as float64, and `kind` as text."""
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError as error:
        raise ImplementationError(
            "a Parquet table needs pyarrow, which is not installed: pip install 'rttrr-pin[parquet]', or write .csv"
        ) from error
    names, numbers = table(sample)
    columns = dict(zip(names, numbers.T, strict=True)) | {KIND: list(sample.kinds)}
    sink = io.BytesIO()
    parquet.write_table(pyarrow.table(columns), sink)
    return sink.getvalue()


def table(sample: Sample) -> tuple[list[str], Array]:
    """The names of the columns of q, v, a and payloads, and their numbers, (states, columns)."""
    states = sample.states
    names, of_payload = column_names(states.model), payload_columns(states.model)
    columns = [*names["q"], *names["v"], *names["a"]]
    for load in states.loads:
        columns += of_payload[states.model.link_names[load.link], load.in_base]
    parts = [states.q, states.v, states.a, *(x for load in states.loads for x in (load.f, load.n))]
    return columns, np.hstack(parts)


Content: TypeAlias = str | bytes

FORMATS: dict[str, Callable[[Sample], Content]] = {
    ".csv": as_csv,
    ".parquet": as_parquet,
    ".jsonl": as_json_lines,
}
"""By the end of the file's name."""
