"""The command line: a table of commands; each is loaded when it is called.

Exit codes: 0 agree, 1 disagree, 2 unusable input, 130 interrupted, 143 terminated.
"""

from __future__ import annotations

import errno
import signal
import sys
import warnings
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module

import click

from rttrr_pin.errors import CacheWarning, LoadWarning, ModelMismatchError, RttrrError
from rttrr_pin.reporting import interrupts
from rttrr_pin.reporting.output import AGREE, DISAGREE, UNUSABLE, discard_stdout, open_streams, shown
from rttrr_pin.urdf.files import forget_reads

COMMANDS = {
    "validate": "rttrr_pin.validation.command:validate",
    "state": "rttrr_pin.validation.command:state",
    "search": "rttrr_pin.validation.command:search",
    "sample": "rttrr_pin.diagnosis.sample_command:sample",
    "diagnose": "rttrr_pin.diagnosis.command:diagnose",
    "laws": "rttrr_pin.laws.command:laws",
    "conform": "rttrr_pin.conformance.command:conform",
    "vectors": "rttrr_pin.conformance.vectors.vectors_command:vectors",
    "mutate": "rttrr_pin.conformance.mutation.mutate_command:mutate",
    "compare": "rttrr_pin.diagnosis.compare_command:compare",
    "audit": "rttrr_pin.auditing.command:audit",
    "derive": "rttrr_pin.derivation.command:derive",
    "loads": "rttrr_pin.loads.command:loads",
    "inspect": "rttrr_pin.inspection.command:inspect",
    "view": "rttrr_pin.viewing.command:view",
    "new": "rttrr_pin.modular_arm.command:new",
}
"""By name, the function that parses, calls and returns an exit code; a new command is an entry here."""


def _version(ctx: click.Context, option: click.Parameter, asked: bool) -> None:
    if asked:
        from rttrr_pin import __version__

        click.echo(f"rttrr-pin {__version__}")
        ctx.exit(AGREE)


class LazyGroup(click.Group):
    """Commands that are imported when they are asked for: `inspect` never loads what `validate` needs."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Their names, in the order of the table."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command of that name; None where there is none."""
        if cmd_name not in COMMANDS:
            return None
        module, name = COMMANDS[cmd_name].split(":")
        command: click.Command = getattr(import_module(module), name)
        return command


@click.group(cls=LazyGroup, context_settings={"show_default": True})
@click.option(
    "--version", is_flag=True, is_eager=True, expose_value=False, callback=_version, help="Print the version."
)
def program() -> None:
    """Tells whether inverse dynamics are right, and if not, which link and which quantity is wrong."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Args:
        arguments: the words after the program's name; None takes the process's own.

    Returns:
        The exit code.
    """
    open_streams()
    forget_reads()
    words = sys.argv[1:] if arguments is None else list(arguments)
    undo = interrupts.install()
    code = UNUSABLE
    try:
        code = _guarded(words)
        ended, sentence = interrupts.ending()
    except BaseException as error:  # a library may make another exception of a signal's: Element.extend a TypeError
        ended, sentence = interrupts.ending(signal.SIGINT if isinstance(error, KeyboardInterrupt) else 0)
        if not ended:
            undo()
            raise
    if ended:
        code = ended
        _say(sentence)
    undo()
    return code


def _guarded(words: list[str]) -> int:
    """The exit code; what went wrong is said in a sentence."""
    try:
        with warnings.catch_warnings():
            quiet = not {"-q", "--quiet"}.isdisjoint(words)
            for own in (LoadWarning, CacheWarning):  # no error either, whatever -W says
                warnings.simplefilter("ignore" if quiet else "always", own)
            warnings.showwarning = _warn
            return _run(words)
    except ModelMismatchError as error:
        _say(f"DISAGREE: {error}")
        return DISAGREE
    except RttrrError as error:
        _say(f"error: {error.in_options()}")
    except Warning as warning:
        _say(f"error: {warning} ({type(warning).__name__}; -W or PYTHONWARNINGS makes it an error)")
    except BrokenPipeError:  # before a verdict, as in --help
        discard_stdout()
        return AGREE
    except (MemoryError, RecursionError) as error:
        what = "there is not enough memory" if isinstance(error, MemoryError) else str(error)
        _say(f"error: {what}: the robot is too large for the limits of this process")
    except ImportError as error:  # under a limit of memory, or where an installation is damaged
        _say(f"error: a library cannot be loaded: {error}")
    except OSError as error:  # a folder that may not be read; without a name, a full disk behind stdout
        gone = error.errno == errno.ENOENT and error.filename is None
        if error.filename is None and not gone:
            discard_stdout()
        _say(f"error: {error.filename or ('the current folder' if gone else 'standard output')}: {error.strerror}")
    return UNUSABLE


def _run(words: list[str]) -> int:
    """Parse the words and call the command; its exit code."""
    try:
        with program.make_context("rttrr-pin", words) as context:
            code = program.invoke(context)
        sys.stdout.flush()
    except click.exceptions.Exit as leaving:
        code = leaving.exit_code
    except click.exceptions.NoArgsIsHelpError as error:
        _say(error.format_message())
        code = UNUSABLE
    except click.UsageError as error:
        command = f"rttrr-pin {words[0]}" if words[0] in COMMANDS else "rttrr-pin"
        _say(f"error: {error.format_message()}\nsee: {command} --help")
        code = UNUSABLE
    return code if isinstance(code, int) else AGREE


def _warn(message: Warning | str, *_: object, **__: object) -> None:
    """A warning as a sentence, without the line of our own source that gave it."""
    _say(f"warning: {message}")


def _say(message: str) -> None:
    """A message on stderr, where that takes one."""
    with suppress(OSError):
        print(shown(message), file=sys.stderr, flush=True)
