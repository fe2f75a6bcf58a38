"""`rttrr-pin sample`."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Any

import click
from rich.text import Text

from rttrr_pin.core.payload import RandomPayload
from rttrr_pin.errors import InputError
from rttrr_pin.reporting.options import (
    base,
    flag,
    friction,
    gravity,
    quiet,
    reading,
    robot,
    seed,
    xacro,
)
from rttrr_pin.reporting.output import AGREE, Output
from rttrr_pin.validation.options import RunOptions

REPEATED = ("gravity", "base", "friction", "xacro", "xacro_arg", "lenient", "no_mimic", "package")
"""Options that `diagnose` must be given as they were given here."""


@click.command
@robot()
@click.option("--states", "-n", default=500, help="How many states.")
@click.option(
    "--output",
    "-o",
    metavar="FILE",
    default="-",
    help="The table to write: .csv, .parquet, or .jsonl (requests for a program); '-' is stdout, as CSV.",
)
@flag("--force", help="Overwrite a file that is there.")
@seed
@click.option(
    "--payload", default="random", help="random: states with a payload at each last link are among them; or none."
)
@click.option("--payload-link", help="The link that payloads act at; without it each last link in turn.")
@gravity
@base
@friction
@xacro
@reading
@quiet
def sample(states: int, output: str, force: bool, payload: str, quiet: bool, **run: Any) -> int:
    """Write states at which a program shows what it does otherwise, for `rttrr-pin diagnose`.

    Gravity alone, one rate, one acceleration, two rates, all at once, a payload: first at round numbers, then at
    random, within the limits of the file. Gravity and friction are no states: they are repeated in the command that
    is printed.

    Exit code: 0 written, 2 unusable input.
    """
    from rttrr_pin.diagnosis.sample_file import FORMATS, write_sample
    from rttrr_pin.diagnosis.states import sample_states

    options = RunOptions(**run)
    if payload not in ("random", "none"):
        raise InputError(f"--payload is {payload!r}: expected random or none")
    if payload == "none" and options.payload_link is not None:
        raise InputError("--payload-link goes with a payload: leave --payload none out")
    loaded = options.load(output, "-o")
    if output != "-" and Path(output).suffix.lower() not in FORMATS:
        raise InputError(f"-o is {output!r}: expected the name of a {', '.join(FORMATS)} file, or '-'")
    if output != "-" and Path(output).is_file() and not force:
        raise InputError(f"{output} exists and is left as it was: choose another file, or add --force to overwrite it")
    acting = None if payload == "none" else RandomPayload(options.payload_link)
    drawn = sample_states(loaded, states, options.seed, acting)
    write_sample(drawn, output)
    console = Output(quiet=quiet or output == "-", soft_wrap=True)
    counts = ", ".join(f"{count} {kind}" for kind, count in drawn.counts.items())
    console.print(Text(f"{output}: {len(drawn):,} states of {loaded.name} ({counts}), seed {options.seed}"))
    command = shlex.join(["rttrr-pin", "diagnose", options.robot, output, *options.unusual(REPEATED)])
    first = loaded.model.v_names[0] if loaded.model.nv else "joint"
    what = f"add tau_{first}, ... columns" if Path(output).suffix.lower() != ".jsonl" else 'add "tau" to its line'
    console.print(Text(f"run your program on each row, {what}, then: {command}"))
    return AGREE
