"""The command line: parses, calls, and turns results into exit codes; no mathematics.

Exit codes: 0 agree, 1 disagree, 2 unusable input, 130 interrupted.
"""

from __future__ import annotations

import os
import shlex
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, Literal

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeRemainingColumn

AGREE, DISAGREE, UNUSABLE, INTERRUPTED = 0, 1, 2, 130

SHOW_PROGRESS_AFTER = 1.0
"""Seconds."""

UsageError: Any = typer.BadParameter.__base__
"""Typer brings its own copy of click and does not export this class."""

app = typer.Typer(
    name="rttrr-pin",
    help="Validates rigid-body dynamics: a hand-written Newton-Euler recursion against Pinocchio, link by link.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


@app.callback(invoke_without_command=True)
def _program(
    version: Annotated[bool, typer.Option("--version", help="Print the version and leave.")] = False,
) -> None:
    """Validates rigid-body dynamics: a hand-written Newton-Euler recursion against Pinocchio, link by link."""
    if version:
        from rttrr_pin import __version__

        typer.echo(f"rttrr-pin {__version__}")
        raise typer.Exit(AGREE)


@app.command()
def validate(
    robot: Annotated[str, typer.Argument(help="A bundled robot's name, or the path of a URDF.")] = "rttrr",
    states: Annotated[int, typer.Option(help="How many states to compare.")] = 10_000,
    seed: Annotated[int, typer.Option(help="The same seed gives the same states.")] = 0,
    family: Annotated[
        str,
        typer.Option(help="How states are drawn: uniform, corners, zeros, one-joint, large-velocities, mixed."),
    ] = "uniform",
    payload: Annotated[
        str | None,
        typer.Option(
            help="What the robot exerts on its surroundings: 'random', or six numbers fx,fy,fz,nx,ny,nz [N, N m]."
        ),
    ] = None,
    payload_link: Annotated[
        str | None, typer.Option(help="The link whose frame the payload acts at; without it, the tool.")
    ] = None,
    payload_axes: Annotated[str, typer.Option(help="The axes of the six numbers: link or base.")] = "link",
    gravity: Annotated[
        str | None, typer.Option(help="Gravity field gx,gy,gz in the base frame [m/s^2]; without it 0,0,-9.81.")
    ] = None,
    oracle: Annotated[str, typer.Option(help="The program to compare with.")] = "pinocchio",
    state: Annotated[int | None, typer.Option(help="Print this one state in full, ours beside the oracle's.")] = None,
    json: Annotated[str | None, typer.Option(help="Write the outcome as JSON to this file; '-' is stdout.")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")] = False,
    full: Annotated[bool, typer.Option("--full", help="Show every row of a long table.")] = False,
) -> int:
    """Compare our recursion with Pinocchio's on random states: tau, F, N, f, n at every joint and link.

    Exit code: 0 agree, 1 disagree, 2 unusable input.
    """
    import rttrr_pin
    from rttrr_pin import report
    from rttrr_pin import validate as validation

    loaded = rttrr_pin.load(robot, **({} if gravity is None else {"gravity": _numbers("--gravity", gravity, 3)}))
    chosen: dict[str, Any] = {
        "seed": seed,
        "family": family,
        "payload": _payload(payload, payload_link, payload_axes),
        "oracle": oracle,
    }
    console = _Output(quiet=quiet or json == "-", soft_wrap=False)
    if state is not None:
        one = validation.compare_state(loaded, state, **chosen)
        _write_json(json, lambda: report.state_data(one))
        report.show_state(one, console)
        return AGREE if one.agrees else DISAGREE
    with _progress(states, quiet) as advance:
        result = validation.validate(loaded, states, **chosen, progress=advance)
    _write_json(json, lambda: report.validation_data(result))
    report.show_validation(result, console, _rerun(sys.argv[1:]), full)
    return AGREE if result.agrees else DISAGREE


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Args:
        arguments: the words after the program's name; None takes the process's own.

    Returns:
        The exit code.
    """
    from rttrr_pin.errors import ModelMismatchError, RttrrError

    errors = Console(stderr=True, markup=False, highlight=False, soft_wrap=True)
    try:
        code = app(args=None if arguments is None else list(arguments), standalone_mode=False, prog_name="rttrr-pin")
        sys.stdout.flush()
    except UsageError as error:
        told = error.format_message()
        errors.print(told if told.startswith("Usage") else f"error: {told}\nsee: {error.ctx.command_path} --help")
        code = UNUSABLE
    except ModelMismatchError as error:
        errors.print(f"DISAGREE: {error}")
        code = DISAGREE
    except RttrrError as error:
        errors.print(f"error: {error}")
        code = UNUSABLE
    except (typer.Abort, KeyboardInterrupt):  # by its version, Typer raises or returns the code
        code = INTERRUPTED
    except BrokenPipeError:
        _discard_stdout()
        code = AGREE
    if code == INTERRUPTED:
        errors.print("interrupted: nothing was written")
    return code if isinstance(code, int) else AGREE


class _Output(Console):
    """Standard output whose reader may leave early, as `head` does: the exit code stays that of the verdict."""

    def on_broken_pipe(self) -> None:
        """Throw away what follows."""
        _discard_stdout()


def _discard_stdout() -> None:
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


@contextmanager
def _progress(total: int, quiet: bool) -> Iterator[Any]:
    """A function to call with the states done; it shows a bar on stderr once the run has lasted a second."""
    started = time.monotonic()
    columns = (TextColumn("{task.completed:,} of {task.total:,} states"), BarColumn(), TimeRemainingColumn())
    bar = Progress(*columns, console=Console(stderr=True), transient=True)
    shown: list[TaskID] = []

    def advance(done: int) -> None:
        if quiet or not bar.console.is_terminal:
            return
        if not shown and time.monotonic() - started > SHOW_PROGRESS_AFTER:
            bar.start()
            shown.append(bar.add_task("", total=total))
        for task in shown:
            bar.update(task, completed=done)

    try:
        yield advance
    finally:
        if shown:
            bar.stop()


def _write_json(target: str | None, data: Any) -> None:
    """JSON to stdout or, whole or not at all, to a file."""
    from rttrr_pin import report

    if target == "-":
        sys.stdout.write(report.as_json(data()))
    elif target is not None:
        report.write_whole(Path(target), report.as_json(data()))


def _payload(text: str | None, link: str | None, axes: str) -> Any:
    """None, "random", or a wrench."""
    from rttrr_pin import Wrench
    from rttrr_pin.errors import InputError

    if text is None or text == "random":
        if link is not None or axes != "link":
            raise InputError("--payload-link and --payload-axes go with six numbers: pass --payload fx,fy,fz,nx,ny,nz")
        return text
    if axes not in ("link", "base"):
        raise InputError(f"--payload-axes is {axes!r}: expected link or base")
    numbers = _numbers("--payload", text, 6)
    named: Literal["link", "base"] = "base" if axes == "base" else "link"
    return Wrench(force=numbers[:3], moment=numbers[3:], link=link, expressed_in=named)


def _numbers(option: str, text: str, count: int) -> list[float]:
    """Numbers separated by commas or blanks."""
    from rttrr_pin.errors import InputError

    words = text.replace(",", " ").split()
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        numbers = []
    if len(numbers) != count:
        example = ",".join("0" for _ in range(count))
        raise InputError(f"{option} is {text!r}: expected {count} numbers separated by commas, such as {example}")
    return numbers


def _rerun(words: Sequence[str]) -> str:
    """The command that was run, to which --state can be added."""
    return shlex.join(["rttrr-pin", *words])
