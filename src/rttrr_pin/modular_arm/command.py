"""`rttrr-pin new`."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from rttrr_pin.errors import InputError
from rttrr_pin.modular_arm.build import build_urdf
from rttrr_pin.reporting.files import write_whole
from rttrr_pin.reporting.options import check_targets, flag
from rttrr_pin.reporting.output import AGREE


@click.command
@click.argument("code", help="One letter per joint from the base to the tool: R (revolute), T (prismatic).")
@click.option("--output", "-o", type=Path, help="The file to write; without it, standard output.")
@click.option("--name", help="The robot's name in the file; without it, the code in small letters.")
@flag("--force", help="Overwrite a file that is there.")
def new(code: str, output: Path | None, name: str | None, force: bool) -> int:
    """Build the URDF of a modular arm, such as RTTRR: the modules are those of the bundled arms.

    Exit code: 0 written, 2 unusable input.
    """
    if output is not None and not output.is_dir():
        check_targets({"-o": output})
    text = build_urdf(code, name)
    if output is None:
        sys.stdout.write(text)
        return AGREE
    if output.is_dir():
        raise InputError(f"{output} is a folder, expected a file: write -o {output / (name or code.lower())}.urdf")
    if output.exists() and not force:
        raise InputError(f"{output} exists and is left as it was: choose another file, or add --force to overwrite it")
    write_whole(output, text)
    return AGREE
