"""The command line: parses, calls, and turns results into exit codes; no mathematics.

Exit codes: 0 agree, 1 disagree, 2 unusable input, 130 interrupted.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from typing import Annotated, Any

import typer
from rich.console import Console

from rttrr_pin.commands.audit import audit
from rttrr_pin.commands.derive import derive
from rttrr_pin.commands.inspect import inspect
from rttrr_pin.commands.new import new
from rttrr_pin.commands.output import AGREE, DISAGREE, INTERRUPTED, UNUSABLE, discard_stdout
from rttrr_pin.commands.validate import validate

UsageError: Any = typer.BadParameter.__base__
"""Typer brings its own copy of click and does not export this class."""

COMMANDS: tuple[Callable[..., int], ...] = (validate, audit, derive, inspect, new)
"""A new command is a module in `commands` and an entry here."""

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


for _command in COMMANDS:
    app.command()(_command)


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
    except BrokenPipeError:  # before a verdict, as in --help
        discard_stdout()
        code = AGREE
    if code == INTERRUPTED:
        errors.print("interrupted: nothing was written")
    return code if isinstance(code, int) else AGREE
