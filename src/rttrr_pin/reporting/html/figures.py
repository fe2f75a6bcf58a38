"""The pictures of a page as files of their own."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from rttrr_pin.errors import InputError
from rttrr_pin.reporting.files import write_whole
from rttrr_pin.reporting.html.chart import Chart
from rttrr_pin.reporting.options import check_targets

OPTION = "--figures"


def write_figures(folder: str | Path, charts: Iterable[Chart]) -> list[Path]:
    """Each picture as `NAME.svg`, in light colours, in a folder that is made where there is none.

    Raises:
        InputError: the folder cannot be made or written to, or a picture would overwrite an input.
    """
    folder = Path(folder)
    files = {folder / f"{chart.name}.svg": chart for chart in charts}
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{OPTION} {folder} cannot be made: {error.strerror}; choose another folder") from error
    check_targets({f"{OPTION} {path.name}": path for path in files})
    for path, chart in files.items():
        write_whole(path, chart.file())
    return [*files]
