"""The command line: a table of commands; each is loaded when it is called.

Exit codes: 0 agree, 1 disagree, 2 unusable input, 130 interrupted.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from rttrr_pin.errors import ModelMismatchError, RttrrError
from rttrr_pin.reporting.output import AGREE, DISAGREE, INTERRUPTED, UNUSABLE, discard_stdout, open_streams

UsageError: Any = typer.BadParameter.__base__
"""Typer brings its own copy of click and does not export this class."""

COMMANDS = {
    "validate": "rttrr_pin.validation.command:validate",
    "state": "rttrr_pin.validation.command:state",
    "search": "rttrr_pin.validation.command_search:search",
    "laws": "rttrr_pin.laws.command:laws",
    "audit": "rttrr_pin.auditing.command:audit",
    "derive": "rttrr_pin.derivation.command:derive",
    "inspect": "rttrr_pin.inspection.command:inspect",
    "new": "rttrr_pin.modular_arm.command:new",
}
"""By name, the function that parses, calls and returns an exit code; a new command is an entry here."""


class LazyGroup(TyperGroup):
    """Commands that are imported when they are asked for: `inspect` never loads what `validate` needs."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Their names, in the order of the table."""
        return list(COMMANDS)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """The command of that name; None where there is none."""
        if cmd_name not in COMMANDS:
            return None
        module, name = COMMANDS[cmd_name].split(":")
        one = typer.Typer(add_completion=False, rich_markup_mode=None)
        one.command(cmd_name)(getattr(import_module(module), name))
        return typer.main.get_command(one)


app = typer.Typer(
    name="rttrr-pin",
    help="Validates rigid-body dynamics: a hand-written Newton-Euler recursion against Pinocchio, link by link.",
    cls=LazyGroup,
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


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Args:
        arguments: the words after the program's name; None takes the process's own.

    Returns:
        The exit code.
    """
    open_streams()
    words = sys.argv[1:] if arguments is None else list(arguments)
    try:
        code = app(args=words, standalone_mode=False, prog_name="rttrr-pin")
        sys.stdout.flush()
    except UsageError as error:
        message = error.format_message()
        _say(message if message.startswith("Usage") else f"error: {message}\nsee: {_command_of(words)} --help")
        code = UNUSABLE
    except ModelMismatchError as error:
        _say(f"DISAGREE: {error}")
        code = DISAGREE
    except RttrrError as error:
        _say(f"error: {error}")
        code = UNUSABLE
    except (typer.Abort, KeyboardInterrupt):  # by its version, Typer raises or returns the code
        code = INTERRUPTED
    except BrokenPipeError:  # before a verdict, as in --help
        discard_stdout()
        code = AGREE
    except OSError as error:  # a folder that may not be read; without a name, a full disk behind stdout
        if error.filename is None:
            discard_stdout()
        _say(f"error: {error.filename or 'standard output'}: {error.strerror}")
        code = UNUSABLE
    if code == INTERRUPTED:
        _say("interrupted: nothing was written")
    return code if isinstance(code, int) else AGREE


def _command_of(words: Sequence[str]) -> str:
    """The command that was called, as far as it exists."""
    return f"rttrr-pin {words[0]}" if words and words[0] in COMMANDS else "rttrr-pin"


def _say(message: str) -> None:
    """A message on stderr, where that takes one."""
    with suppress(OSError):
        print(message, file=sys.stderr, flush=True)
