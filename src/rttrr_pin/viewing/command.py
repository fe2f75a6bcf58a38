"""`rttrr-pin view`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from rttrr_pin.core.payload import RandomPayload
from rttrr_pin.errors import InputError
from rttrr_pin.reporting.options import flag, numbers_of, robot, target
from rttrr_pin.reporting.output import AGREE
from rttrr_pin.validation.options import RunOptions, conditions, payload


@click.command
@robot()
@click.argument("trajectory", required=False, help="A trajectory to play: a file, or pick-and-place.")
@click.option("--subject", metavar="PROGRAM", help="Show how far this program is from the reference; see validate.")
@click.option("--reference", default="kernel", metavar="PROGRAM", help="What --subject is compared with.")
@click.option("--q", metavar="X,Y,...", help="Coordinates at first, in the order of `inspect` [rad or m].")
@click.option("--v", metavar="X,Y,...", help="Rates at first.")
@click.option("--a", metavar="X,Y,...", help="Accelerations at first.")
@flag("--worst", help="Begin at the worst state of the trajectory, or of 1,000 random ones of --subject.")
@flag("--no-meshes", help="Draw no meshes: solids, or else a skeleton.")
@click.option("--port", default=0, help="Of this machine; 0 is any that is free.")
@target("--html", "the state, or the trajectory, as a page of its own instead,")
@payload
@conditions
def view(
    trajectory: str | None,
    subject: str | None,
    q: str | None,
    v: str | None,
    a: str | None,
    worst: bool,
    no_meshes: bool,
    port: int,
    html: str | None,
    reference: str,
    **run: Any,
) -> int:
    """Show the robot in a browser: bodies, frames, and the forces and moments at every joint and link.

    It serves on this machine alone, says its address, and ends with Ctrl-C.
    """
    from rttrr_pin.trajectories import named
    from rttrr_pin.viewing.run import state_of
    from rttrr_pin.viewing.run import view as show

    options = RunOptions(subject=subject or "kernel", reference=(reference,), **run)
    options.check_target(html, [] if trajectory is None else [Path(trajectory)], "--html")
    loaded = options.load(html, "--html")
    wrench = options.chosen()["payload"]
    if isinstance(wrench, RandomPayload):
        raise InputError("--payload is 'random', and one state is shown: expected six numbers")
    state = None
    if not (q is v is a is wrench is None):
        model = loaded.model
        given = {"q": (q, model.nq), "v": (v, model.nv), "a": (a, model.nv)}
        numbers = {name: None if x is None else numbers_of(f"--{name}", x, size) for name, (x, size) in given.items()}
        state = state_of(loaded, payload=wrench, **numbers)
    show(
        loaded,
        None if trajectory is None else named(trajectory, loaded),
        subject=subject,
        reference=reference,
        state=state,
        worst=worst,
        meshes=not no_meshes,
        port=port,
        html=html,
    )
    return AGREE
