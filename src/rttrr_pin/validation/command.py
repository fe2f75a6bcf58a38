"""`rttrr-pin validate`."""

from __future__ import annotations

import shlex
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from rttrr_pin.core.wrench import Wrench
from rttrr_pin.errors import InputError
from rttrr_pin.laws.report import laws_data, show_laws
from rttrr_pin.laws.run import check_laws
from rttrr_pin.loading import load
from rttrr_pin.reporting.numbers import numbers_of
from rttrr_pin.reporting.output import AGREE, DISAGREE, UNUSABLE, Output, progress, write_json
from rttrr_pin.urdf.sources import EXAMPLE, examples, robots_in
from rttrr_pin.validation.many import BASES, Task, validate_many
from rttrr_pin.validation.report import show_state, show_validation
from rttrr_pin.validation.report_data import state_data, validation_data
from rttrr_pin.validation.report_many import many_data, show_many
from rttrr_pin.validation.report_search import search_data, show_search
from rttrr_pin.validation.run import validate as run_validation
from rttrr_pin.validation.search import search as run_search
from rttrr_pin.validation.state import compare_state

MOST_LAW_STATES = 1000
"""Laws cost far more than the comparison, and a law that fails does so in nearly every state."""


STATES = 10_000
"""Compared unless another number is asked for."""

DEFAULT = ("pinocchio",)
"""Compared with unless others are named."""


def validate(
    robot: Annotated[
        str,
        typer.Argument(
            help="A bundled robot's name, the path of a URDF, or example:NAME; several at once: a folder, example:all."
        ),
    ] = "rttrr",
    states: Annotated[int, typer.Option(help="How many states to compare.")] = STATES,
    seed: Annotated[int, typer.Option(help="The same seed gives the same states.")] = 0,
    sampling: Annotated[
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
    base: Annotated[str, typer.Option(help="fixed (bolted down) or floating.")] = "fixed",
    friction: Annotated[
        bool, typer.Option("--friction", help="Take damping and friction of <dynamics> into tau.")
    ] = False,
    oracle: Annotated[
        list[str] | None,
        typer.Option(
            help="What to compare with: pinocchio (unless another is named), mujoco (extra 'mujoco'), lagrange "
            "(driving forces alone). May be repeated."
        ),
    ] = None,
    laws: Annotated[
        bool, typer.Option("--laws", help="Also try the laws of mechanics, which need no other program.")
    ] = False,
    state: Annotated[int | None, typer.Option(help="Print this one state in full, ours beside the oracle's.")] = None,
    search: Annotated[
        int | None, typer.Option(help="Look for the worst state, at about so many; 20000 is a start.")
    ] = None,
    json: Annotated[str | None, typer.Option(help="Write the outcome as JSON to this file; '-' is stdout.")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")] = False,
    full: Annotated[bool, typer.Option("--full", help="Show every row of a long table.")] = False,
) -> int:
    """Compare our recursion with Pinocchio's, or others', on random states: tau, F, N, f, n at every joint and link.

    Several robots each go through a fixed and a floating base, and those that cannot be compared are listed with what
    in their file stops them.

    With --laws, also power balance, momentum, symmetry, linearity, invariance and the like, on the first 1,000 states.
    With --search, an optimiser looks for the state at which the two differ most.

    Exit code: 0 agree, 1 disagree or a law violated, 2 unusable input (of several robots, at least one).
    """
    oracles = tuple(oracle or DEFAULT)
    several = _several(robot)
    if several:
        one_robot = {
            "--state": state is not None,
            "--payload": payload is not None,
            "--payload-link": payload_link is not None,
            "--payload-axes": payload_axes != "link",
            "--gravity": gravity is not None,
            "--base": base != "fixed",
            "--friction": friction,
            "--full": full,
            "--laws": laws,
            "--search": search is not None,
            "--oracle more than once": len(oracles) > 1,
        }
        _refuse([option for option, given in one_robot.items() if given])
        return _validate_several(several, Task(states, seed, sampling, oracles[0]), json, quiet)
    loading: dict[str, Any] = {"base": base, "friction": friction}
    if gravity is not None:
        loading["gravity"] = numbers_of("--gravity", gravity, 3)
    loaded = load(robot, **loading)
    chosen: dict[str, Any] = {
        "seed": seed,
        "sampling": sampling,
        "payload": _payload(payload, payload_link, payload_axes),
        "oracle": oracles,
    }
    console = Output(quiet=quiet or json == "-", soft_wrap=False)
    if state is not None:
        for option, given in (("--laws", laws), ("--search", search is not None)):
            if given:
                raise InputError(f"{option} tries many states, and --state names one: leave one of them out")
        one = compare_state(loaded, state, **chosen, states=states)
        write_json(json, lambda: state_data(one))
        show_state(one, console)
        return AGREE if one.agrees else DISAGREE
    with progress(states, quiet) as advance:
        result = run_validation(loaded, states, **chosen, progress=advance)
    tried = _laws(loaded, min(states, MOST_LAW_STATES), chosen, quiet) if laws else None
    found = _search(loaded, search, chosen, quiet)
    extra = ({} if tried is None else {"laws": laws_data(tried)}) | (
        {} if found is None else {"search": search_data(found)}
    )
    write_json(json, lambda: validation_data(result) | extra)
    again = {
        "--states": states if states != STATES else None,
        "--seed": seed or None,
        "--sampling": sampling if sampling != "uniform" else None,
        "--payload": payload,
        "--payload-link": payload_link,
        "--payload-axes": payload_axes if payload_axes != "link" else None,
        "--gravity": gravity,
        "--base": base if base != "fixed" else None,
        "--oracle": oracles if oracles != DEFAULT else None,
    }
    show_validation(result, console, _rerun(robot, again, friction), full)
    if tried is not None:
        show_laws(tried, console)
    if found is not None:
        show_search(found, console, several=len(oracles) > 1)
    right = (result.agrees, tried is None or tried.holds, found is None or found.agrees)
    return AGREE if all(right) else DISAGREE


def _search(robot: Any, evaluations: int | None, chosen: Mapping[str, Any], quiet: bool) -> Any:
    """The worst case, looked for; None where it was not asked for."""
    if evaluations is None:
        return None
    with progress(evaluations, quiet) as advance:
        return run_search(robot, evaluations, chosen["seed"], chosen["payload"], chosen["oracle"], advance)


def _laws(robot: Any, states: int, chosen: Mapping[str, Any], quiet: bool) -> Any:
    """The laws on the first of the states; a random payload is what they take by themselves."""
    payload = chosen["payload"] if isinstance(chosen["payload"], Wrench) else None
    with progress(states, quiet) as advance:
        return check_laws(robot, states, chosen["seed"], chosen["sampling"], payload, progress=advance)


def _several(robot: str) -> dict[str, Path]:
    """The files of `example:all` or of a folder that holds more than one; none where one robot is meant."""
    if not robot.strip():
        return {}
    if robot == f"{EXAMPLE}all":
        return examples()
    found = robots_in(robot) if Path(robot).is_dir() else {}
    return found if len(found) > 1 else {}


def _refuse(options: Sequence[str]) -> None:
    if options:
        raise InputError(f"{', '.join(options)} goes with one robot, and several are named: name one, or leave it out")


def _validate_several(sources: dict[str, Path], task: Any, json: str | None, quiet: bool) -> int:
    """One table for many robots."""
    start = time.perf_counter()
    with progress(len(sources) * len(BASES), quiet, "runs") as advance:
        entries = validate_many(sources, task, progress=advance)
    seconds = time.perf_counter() - start
    write_json(json, lambda: many_data(entries, task, seconds))
    show_many(entries, task, seconds, Output(quiet=quiet or json == "-"))
    verdicts = {entry.verdict for entry in entries}
    return DISAGREE if "disagree" in verdicts else UNUSABLE if "unusable" in verdicts else AGREE


def _payload(text: str | None, link: str | None, axes: str) -> Any:
    """None, "random", or a wrench."""
    from rttrr_pin import Wrench

    if text is None or text == "random":
        if link is not None or axes != "link":
            raise InputError("--payload-link and --payload-axes go with six numbers: pass --payload fx,fy,fz,nx,ny,nz")
        return text
    if axes not in ("link", "base"):
        raise InputError(f"--payload-axes is {axes!r}: expected link or base")
    numbers = numbers_of("--payload", text, 6)
    named: Literal["link", "base"] = "base" if axes == "base" else "link"
    return Wrench(force=numbers[:3], moment=numbers[3:], link=link, expressed_in=named)


def _rerun(robot: str, options: Mapping[str, object], friction: bool) -> str:
    """The command that draws the same states, to which --state can be added."""
    words = ["rttrr-pin", "validate", *([robot] if robot != "rttrr" else [])]
    for option, value in options.items():
        for each in value if isinstance(value, tuple) else (value,):
            words += [option, str(each)] if each is not None else []
    return shlex.join([*words, "--friction"] if friction else words)
