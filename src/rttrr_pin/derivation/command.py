"""`rttrr-pin derive`."""

from __future__ import annotations

import time
from functools import partial

import click

from rttrr_pin.derivation import DEFAULT, almost_right_angles, default_symbols, only_leaf, payload_symbols
from rttrr_pin.derivation import derive as run_derive
from rttrr_pin.derivation.symbol_file import published_symbols
from rttrr_pin.derivation.writers import WRITERS, show_derivation
from rttrr_pin.loading import load
from rttrr_pin.reporting.options import (
    base,
    check_targets,
    flag,
    friction,
    gravity,
    numbers_of,
    payload_link,
    quiet,
    reading,
    reading_of,
    robot,
    target,
    xacro,
)
from rttrr_pin.reporting.output import AGREE, Output, write_text

NEXT = "to write them, add --latex FILE, --markdown FILE, --python FILE or --c FILE; '-' is stdout"

ALMOST = "some rotations are almost right angles, which makes many small terms: add --right-angles to read them as such"


@click.command
@robot()
@click.option(
    "--quantity", multiple=True, help="v_dot_C, F, N, f, n, tau, M, C or g. Repeats. Without it n, tau, M, C, g."
)
@click.option(
    "--form", default="auto", help="expanded (all in the robot's symbols), stepwise (with named steps), or auto."
)
@flag("--numbers", help="Keep the numbers of the file; without it each has a symbol.")
@flag("--right-angles", help="Read rotations within 1e-4 of right angles as such.")
@payload_link
@gravity
@base
@friction
@xacro
@reading
@target("--latex", "a LaTeX document")
@target("--markdown", "Markdown")
@target("--python", "a Python module")
@target("--c", "C99")
@quiet
def derive(
    robot: str,
    quantity: tuple[str, ...],
    form: str,
    numbers: bool,
    right_angles: bool,
    payload_link: str | None,
    gravity: str | None,
    base: str,
    friction: bool,
    xacro: bool,
    xacro_arg: tuple[str, ...],
    lenient: bool,
    no_mimic: bool,
    package: tuple[str, ...],
    latex: str | None,
    markdown: str | None,
    python: str | None,
    c: str | None,
    quiet: bool,
) -> int:
    """Derive a robot's dynamics in symbols: joint moments n, driving forces tau, M(q), C(q, v), g(q), and more.

    Exit code: 0 derived, 2 unusable input.
    """
    targets = {"latex": latex, "markdown": markdown, "python": python, "c": c}
    wanted = {name: where for name, where in targets.items() if where is not None}
    outputs = {f"--{name}": where for name, where in wanted.items()}
    check_targets(outputs, [robot])
    field = None if gravity is None else numbers_of("--gravity", gravity, 3)
    how = reading_of(xacro, xacro_arg, lenient, no_mimic, package)
    model = load(robot, field, base, friction, **how).model  # type: ignore[arg-type]
    check_targets(outputs)
    link = only_leaf(model) if payload_link is None else model.link_index(payload_link)
    start = time.perf_counter()
    published = None if numbers else published_symbols(robot, model, link)
    unpublished = payload_symbols if numbers else default_symbols
    parameters = published.robot.parameters if published else unpublished(model, link)
    derivation = run_derive(model, quantity or DEFAULT, form, parameters, link, right_angles)
    seconds = time.perf_counter() - start
    for name, where in wanted.items():
        write_text(where, partial(WRITERS[name], derivation, published.preface if published else ""))
    console = Output(quiet=quiet or "-" in targets.values(), soft_wrap=False)
    show_derivation(derivation, seconds, wanted, console)
    if not right_angles and almost_right_angles(model):
        console.print(ALMOST, markup=False, soft_wrap=True)
    if not wanted:
        console.print(NEXT, markup=False, soft_wrap=True)
    return AGREE
