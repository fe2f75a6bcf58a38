"""The console of the commands."""

from __future__ import annotations

import io

from rich.console import Console, ConsoleOptions, RenderResult

from rttrr_pin.reporting.output import Output


class Report:
    """Counts how often it is laid out."""

    times = 0

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        self.times += 1
        yield "a report"


def test_what_is_not_printed_is_not_laid_out() -> None:
    report = Report()
    Output(quiet=True).print(report)
    assert report.times == 0
    Output(file=io.StringIO()).print(report)
    assert report.times == 1


def test_a_name_between_colons_is_no_picture() -> None:
    text = io.StringIO()
    Output(file=text).print("link :robot: of :arm:")
    assert text.getvalue() == "link :robot: of :arm:\n"
