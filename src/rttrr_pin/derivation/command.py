"""`rttrr-pin derive`."""

from __future__ import annotations

import time
from functools import partial
from typing import Annotated

import typer

from rttrr_pin.derivation import DEFAULT, almost_right_angles, default_symbols, only_leaf, payload_symbols
from rttrr_pin.derivation import derive as run_derive
from rttrr_pin.derivation.symbol_file import published_symbols
from rttrr_pin.derivation.writers import WRITERS, show_derivation
from rttrr_pin.errors import InputError
from rttrr_pin.loading import load
from rttrr_pin.reporting.numbers import numbers_of
from rttrr_pin.reporting.output import AGREE, Output, write_text

NEXT = "to write them, add --latex FILE, --markdown FILE, --python FILE or --c FILE; '-' is stdout"

ALMOST = "some rotations are almost right angles, which makes many small terms: add --right-angles to read them as such"


def derive(
    robot: Annotated[
        str, typer.Argument(help="A bundled robot's name, the path of a URDF, or example:NAME.")
    ] = "rttrr",
    quantity: Annotated[
        list[str] | None,
        typer.Option(help="v_dot_C, F, N, f, n, tau, M, C or g; repeatable. Without it n, tau, M, C, g."),
    ] = None,
    form: Annotated[
        str, typer.Option(help="expanded (all in the robot's symbols), stepwise (with named steps), or auto.")
    ] = "auto",
    numbers: Annotated[
        bool, typer.Option("--numbers", help="Keep the numbers of the file; without it each has a symbol.")
    ] = False,
    right_angles: Annotated[
        bool, typer.Option("--right-angles", help="Read rotations within 1e-4 of right angles as such.")
    ] = False,
    payload_link: Annotated[
        str | None, typer.Option(help="The link whose frame the payload acts at; without it, the only last link.")
    ] = None,
    gravity: Annotated[
        str | None, typer.Option(help="Gravity field gx,gy,gz in the base frame [m/s^2]; without it 0,0,-9.81.")
    ] = None,
    base: Annotated[str, typer.Option(help="fixed (bolted down) or floating.")] = "fixed",
    friction: Annotated[
        bool, typer.Option("--friction", help="Take damping and friction of <dynamics> into tau.")
    ] = False,
    latex: Annotated[str | None, typer.Option(help="Write a LaTeX document to this file; '-' is stdout.")] = None,
    markdown: Annotated[str | None, typer.Option(help="Write Markdown to this file; '-' is stdout.")] = None,
    python: Annotated[str | None, typer.Option(help="Write a Python module to this file; '-' is stdout.")] = None,
    c: Annotated[str | None, typer.Option(help="Write C99 to this file; '-' is stdout.")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")] = False,
) -> int:
    """Derive a robot's dynamics in symbols: joint moments n, driving forces tau, M(q), C(q, v), g(q), and more.

    Exit code: 0 derived, 2 unusable input.
    """
    targets = {"latex": latex, "markdown": markdown, "python": python, "c": c}
    wanted = {name: target for name, target in targets.items() if target is not None}
    _check(wanted)
    field = {} if gravity is None else {"gravity": numbers_of("--gravity", gravity, 3)}
    model = load(robot, base=base, friction=friction, **field).model  # type: ignore[arg-type]
    link = only_leaf(model) if payload_link is None else model.link_index(payload_link)
    start = time.perf_counter()
    published = None if numbers else published_symbols(robot, model, link)
    unpublished = payload_symbols if numbers else default_symbols
    parameters = published.robot.parameters if published else unpublished(model, link)
    derivation = run_derive(model, quantity or DEFAULT, form, parameters, link, right_angles)
    seconds = time.perf_counter() - start
    for name, target in wanted.items():
        write_text(target, partial(WRITERS[name], derivation, published.preface if published else ""))
    console = Output(quiet=quiet or "-" in targets.values(), soft_wrap=False)
    show_derivation(derivation, seconds, wanted, console)
    if not right_angles and almost_right_angles(model):
        console.print(ALMOST, markup=False, soft_wrap=True)
    if not wanted:
        console.print(NEXT, markup=False, soft_wrap=True)
    return AGREE


def _check(wanted: dict[str, str]) -> None:
    """Only one text goes to standard output, and every file is another."""
    for target in wanted.values():
        options = [f"--{name}" for name, other in wanted.items() if other == target]
        if len(options) > 1:
            where = "standard output" if target == "-" else target
            raise InputError(f"{' and '.join(options)} both go to {where}: give each a file of its own")
