"""`rttrr-pin new`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from rttrr_pin.errors import InputError
from rttrr_pin.modular_arm.urdf_text import build_urdf
from rttrr_pin.reporting.files import write_whole
from rttrr_pin.reporting.output import AGREE


def new(
    code: Annotated[
        str, typer.Argument(help="One letter per joint from the base to the tool: R (revolute), T (prismatic).")
    ],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="The file to write; without it, standard output.")
    ] = None,
    name: Annotated[
        str | None, typer.Option(help="The robot's name in the file; without it, the code in small letters.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite a file that is there.")] = False,
) -> int:
    """Build the URDF of a modular arm, such as RTTRR: the modules are those of the bundled arms.

    Exit code: 0 written, 2 unusable input.
    """
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
