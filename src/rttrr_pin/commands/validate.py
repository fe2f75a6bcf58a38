"""`rttrr-pin validate`."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from typing import Annotated, Any, Literal

import typer

from rttrr_pin.commands.output import AGREE, DISAGREE, Output, progress, write_json


def validate(
    robot: Annotated[str, typer.Argument(help="A bundled robot's name, or the path of a URDF.")] = "rttrr",
    states: Annotated[int, typer.Option(help="How many states to compare.")] = 10_000,
    seed: Annotated[int, typer.Option(help="The same seed gives the same states.")] = 0,
    family: Annotated[
        str,
        typer.Option(help="How states are drawn: uniform, corners, zeros, one-joint, large-velocities, mixed."),
    ] = "uniform",
    payload: Annotated[
        str | None,
        typer.Option(
            help="What the robot exerts on its surroundings: 'random', or six numbers fx,fy,fz,nx,ny,nz [N, N m]."
        ),
    ] = None,
    payload_link: Annotated[
        str | None, typer.Option(help="The link whose frame the payload acts at; without it, the tool.")
    ] = None,
    payload_axes: Annotated[str, typer.Option(help="The axes of the six numbers: link or base.")] = "link",
    gravity: Annotated[
        str | None, typer.Option(help="Gravity field gx,gy,gz in the base frame [m/s^2]; without it 0,0,-9.81.")
    ] = None,
    oracle: Annotated[str, typer.Option(help="The program to compare with.")] = "pinocchio",
    state: Annotated[int | None, typer.Option(help="Print this one state in full, ours beside the oracle's.")] = None,
    json: Annotated[str | None, typer.Option(help="Write the outcome as JSON to this file; '-' is stdout.")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")] = False,
    full: Annotated[bool, typer.Option("--full", help="Show every row of a long table.")] = False,
) -> int:
    """Compare our recursion with Pinocchio's on random states: tau, F, N, f, n at every joint and link.

    Exit code: 0 agree, 1 disagree, 2 unusable input.
    """
    import rttrr_pin
    from rttrr_pin import report
    from rttrr_pin import validate as validation

    loaded = rttrr_pin.load(robot, **({} if gravity is None else {"gravity": _numbers("--gravity", gravity, 3)}))
    chosen: dict[str, Any] = {
        "seed": seed,
        "family": family,
        "payload": _payload(payload, payload_link, payload_axes),
        "oracle": oracle,
    }
    console = Output(quiet=quiet or json == "-", soft_wrap=False)
    if state is not None:
        one = validation.compare_state(loaded, state, **chosen)
        write_json(json, lambda: report.state_data(one))
        report.show_state(one, console)
        return AGREE if one.agrees else DISAGREE
    with progress(states, quiet) as advance:
        result = validation.validate(loaded, states, **chosen, progress=advance)
    write_json(json, lambda: report.validation_data(result))
    report.show_validation(result, console, _rerun(sys.argv[1:]), full)
    return AGREE if result.agrees else DISAGREE


def _payload(text: str | None, link: str | None, axes: str) -> Any:
    """None, "random", or a wrench."""
    from rttrr_pin import Wrench
    from rttrr_pin.errors import InputError

    if text is None or text == "random":
        if link is not None or axes != "link":
            raise InputError("--payload-link and --payload-axes go with six numbers: pass --payload fx,fy,fz,nx,ny,nz")
        return text
    if axes not in ("link", "base"):
        raise InputError(f"--payload-axes is {axes!r}: expected link or base")
    numbers = _numbers("--payload", text, 6)
    named: Literal["link", "base"] = "base" if axes == "base" else "link"
    return Wrench(force=numbers[:3], moment=numbers[3:], link=link, expressed_in=named)


def _numbers(option: str, text: str, count: int) -> list[float]:
    """Numbers separated by commas or blanks."""
    from rttrr_pin.errors import InputError

    words = text.replace(",", " ").split()
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        numbers = []
    if len(numbers) != count:
        example = ",".join("0" for _ in range(count))
        raise InputError(f"{option} is {text!r}: expected {count} numbers separated by commas, such as {example}")
    return numbers


def _rerun(words: Sequence[str]) -> str:
    """The command that was run, to which --state can be added."""
    return shlex.join(["rttrr-pin", *words])
