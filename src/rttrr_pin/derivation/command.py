"""`rttrr-pin derive`."""

from __future__ import annotations

import time
from functools import partial
from typing import Annotated

import typer

from rttrr_pin.core.model import Model
from rttrr_pin.derivation import DEFAULT, Letters, almost_right_angles, default_letters, only_leaf, payload_letters
from rttrr_pin.derivation import derive as run_derive
from rttrr_pin.derivation.writers import WRITERS, show_derivation
from rttrr_pin.errors import InputError
from rttrr_pin.loading import load
from rttrr_pin.reporting.numbers import numbers_of
from rttrr_pin.reporting.output import AGREE, Output, write_text

NEXT = "to write them, add --latex FILE, --markdown FILE, --python FILE or --c FILE; '-' is stdout"

ALMOST = "some rotations are almost right angles, which makes many small terms: add --right-angles to read them as such"

PAPERS_ARM = "rttrr"

PREFACES = {
    PAPERS_ARM: "The arm of Detesan, The dynamic model of RTTRR serial robot - Iterations outwards and inwards the "
    "robot's mechanical structure, Acta Technica Napocensis: the moments n_i, which the paper leaves to a link that no "
    "longer answers, and what comes next. docs/rttrr_model.md of rttrr-pin is what `rttrr-pin derive --markdown FILE` "
    "writes; the tests write it anew, read its equations again, and hold every formula in it against Pinocchio."
}
"""What stands before the model of a bundled robot."""


def derive(
    robot: Annotated[
        str, typer.Argument(help="A bundled robot's name, the path of a URDF, or example:NAME.")
    ] = "rttrr",
    quantity: Annotated[
        list[str] | None,
        typer.Option(help="v_dot_C, F, N, f, n, tau, M, C or g; repeatable. Without it n, tau, M, C, g."),
    ] = None,
    form: Annotated[
        str, typer.Option(help="expanded (all in the robot's letters), stepwise (with names on the way), or auto.")
    ] = "auto",
    numbers: Annotated[
        bool, typer.Option("--numbers", help="Keep the numbers of the file; without it each has a letter.")
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
    as_published = robot == PAPERS_ARM and gravity is None and base == "fixed" and payload_link is None
    letters = _papers_letters() if as_published and not numbers else letters_for(model, link, numbers)
    derivation = run_derive(model, quantity or DEFAULT, form, letters, link, right_angles)
    seconds = time.perf_counter() - start
    texts = {name: WRITERS[name](derivation, PREFACES.get(robot, "")) for name in wanted}
    for name, target in wanted.items():
        write_text(target, partial(str, texts[name]))
    console = Output(quiet=quiet or "-" in targets.values(), soft_wrap=False)
    show_derivation(derivation, seconds, wanted, console)
    if not right_angles and almost_right_angles(model):
        console.print(ALMOST, markup=False, soft_wrap=True)
    if not wanted:
        console.print(NEXT, markup=False, soft_wrap=True)
    return AGREE


def _papers_letters() -> Letters:
    """The letters of the paper: l_2, l_3, l_4, and h_1 to h_6 for the heights that it prints in no equation."""
    from rttrr_pin.auditing import read_publication

    return read_publication().robot.letters


def letters_for(model: Model, payload_link: int | None, numbers: bool) -> Letters:
    """What stands for a robot's numbers; the payload has letters in any case."""
    return payload_letters(model, payload_link) if numbers else default_letters(model, payload_link)


def _check(wanted: dict[str, str]) -> None:
    """Only one text goes to standard output, and every file is another."""
    for target in wanted.values():
        options = [f"--{name}" for name, other in wanted.items() if other == target]
        if len(options) > 1:
            where = "standard output" if target == "-" else target
            raise InputError(f"{' and '.join(options)} both go to {where}: give each a file of its own")
