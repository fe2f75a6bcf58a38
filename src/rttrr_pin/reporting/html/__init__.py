"""Pages that stand by themselves, and the pictures in them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from rttrr_pin.reporting.html.chart import Chart, Key
from rttrr_pin.reporting.html.columns import bars, histogram
from rttrr_pin.reporting.html.figures import write_figures
from rttrr_pin.reporting.html.lines import line_chart, scatter
from rttrr_pin.reporting.html.markup import slug
from rttrr_pin.reporting.html.page import (
    Bars,
    Block,
    Causes,
    Code,
    Figures,
    Page,
    Points,
    Rows,
    Said,
    Written,
    by_decades,
    code,
    html,
    of_longest,
    points,
)
from rttrr_pin.reporting.html.robot import drawing, robot_drawing
from rttrr_pin.reporting.html.skeleton import Bone
from rttrr_pin.reporting.output import write_text

__all__ = [
    "Bars",
    "Block",
    "Bone",
    "Causes",
    "Chart",
    "Code",
    "Figures",
    "Key",
    "Page",
    "Points",
    "Rows",
    "Said",
    "Written",
    "bars",
    "by_decades",
    "code",
    "drawing",
    "histogram",
    "html",
    "line_chart",
    "of_longest",
    "points",
    "robot_drawing",
    "scatter",
    "slug",
    "write_figures",
    "write_page",
]


def write_page(page: Callable[[], Page], target: str | None, figures: str | Path | None = None) -> None:
    """A page to a file, or to stdout where that is "-"; its pictures to a folder. It is made where one is wanted."""
    if target is None and figures is None:
        return
    made = page()
    write_text(target, lambda: html(made))
    if figures is not None:
        write_figures(figures, made.charts)
