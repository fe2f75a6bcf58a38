"""`rttrr-pin loads`."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Any

import click

from rttrr_pin.core.payload import RandomPayload
from rttrr_pin.core.wrench import Wrench
from rttrr_pin.errors import InputError
from rttrr_pin.reporting.options import check_targets, flag, group, numbers_of, outcome, page
from rttrr_pin.reporting.output import AGREE, DISAGREE, Output, progress, write_json
from rttrr_pin.robot import Robot
from rttrr_pin.trajectories import Trajectory, named, read_trajectory
from rttrr_pin.validation.options import RunOptions, payload_frame, surroundings

body = group(
    click.option("--payload", help="What the robot exerts on its surroundings: fx,fy,fz,nx,ny,nz [N, N m]."),
    click.option("--payload-mass", metavar="KG", help="Mass of a body that the robot carries, with the next two."),
    click.option("--payload-com", metavar="X,Y,Z", help="Its centre of mass, from the origin of its link [m]."),
    click.option(
        "--payload-inertia",
        metavar="IXX,IXY,IXZ,IYY,IYZ,IZZ",
        help="Its tensor about the centre of mass, as in URDF [kg m^2]; without it a point.",
    ),
)
files = group(
    click.option(
        "--output", "-o", metavar="FILE", help="Write a row for each row: .csv, .parquet or .npz, units in the schema."
    ),
    click.option("--quantities", default="tau", help="What is written: some of tau,F,N,f,n,power,energy."),
    click.option("--convention", help="Write f and n as another program says them, such as gazebo (docs/wrenches.md)."),
    click.option(
        "--wrench-stamped", metavar="FILE", help="Write f and n as geometry_msgs/WrenchStamped: .csv, .parquet, .mcap."
    ),
    click.option(
        "--load-cases", metavar="FILE", help="Write what acts on each link in the states that matter, as .csv."
    ),
)
motion = group(
    click.option("--topic", help="Of a bag, where it has several."),
    click.option("--time-unit", metavar="UNIT", help="s, ms, us or ns; without it by the distance of rows."),
    click.option(
        "--cutoff",
        type=float,
        metavar="HZ",
        help="Frequency up to which derived v and a follow the rows; by the noise.",
    ),
    flag("--no-band", help="Leave out the band of 95 percent where v or a are derived."),
)


@click.command
@click.argument("robot", help="A bundled robot's name, the path of a URDF, or example:NAME.")
@click.argument("trajectory", help="A file with time and q_<joint>, ... (docs/loads.md), or pick-and-place.")
@files
@click.option("--ratings", metavar="FILE", help="Ratings of gears by joint, .toml, for their lives (docs/loads.md).")
@flag("--no-bearings", help="Leave out what bearings carry.")
@body
@payload_frame
@motion
@surroundings
@outcome
@page
@flag("--full", help="Show means, times and states too.")
def loads(
    robot: str,
    trajectory: str,
    json: str | None,
    html: str | None,
    figures: str | None,
    quiet: bool,
    full: bool,
    **words: Any,
) -> int:
    """What every joint and bearing carries along a trajectory: peaks, means, margins, lives of gears.

    Exit code: 0 within the limits, 1 one is exceeded, 2 unusable input.
    """
    from rttrr_pin.loads.report import show_loads
    from rttrr_pin.loads.run import compute_loads
    from rttrr_pin.trajectories.read import READERS

    if Path(robot).suffix.lower() in READERS:
        right = shlex.join(["rttrr-pin", "loads", trajectory, robot])
        raise InputError(f"{robot} is a trajectory, and the robot comes first: {right}")
    run = RunOptions(robot=robot, **{name: words[name] for name in ROBOT})
    targets = {"--json": json, "--html": html, **{option: words[name] for name, option in TARGETS.items()}}
    check_targets(targets, [robot, trajectory, *filter(None, [words["ratings"]])])
    loaded = _carrying(run.load(None), words)
    motion = _trajectory(trajectory, loaded, words)
    check_targets(targets)  # what files of robots name, too
    with progress(motion.n_rows, quiet, "rows") as advance:
        report = compute_loads(
            loaded,
            motion,
            quantities=tuple(word.strip() for word in words["quantities"].split(",")),
            payload=_wrench(run),
            convention=words["convention"],
            output=words["output"],
            wrench_stamped=words["wrench_stamped"],
            load_cases=words["load_cases"],
            band=not words["no_band"],
            bearings=not words["no_bearings"],
            ratings=words["ratings"],
            progress=advance,
        )
    write_json(json, report.to_dict)
    if html is not None or figures is not None:
        from rttrr_pin.loads.page import loads_page
        from rttrr_pin.reporting.html import write_page

        write_page(lambda: loads_page(report, loaded), html, figures)
    show_loads(report, Output(quiet=quiet or "-" in (json, html), soft_wrap=False), full)
    return AGREE if report.passed else DISAGREE


ROBOT = (
    *("payload", "payload_link", "payload_axes", "gravity", "base", "friction", "xacro", "xacro_arg", "lenient"),
    *("no_mimic", "package"),
)
"""What says which robot, and what it carries."""

TARGETS = {"output": "--output", "wrench_stamped": "--wrench-stamped", "load_cases": "--load-cases"}


def _trajectory(text: str, robot: Robot, words: dict[str, Any]) -> Trajectory:
    """What the command line's TRAJECTORY means."""
    how = {name: words[name] for name in ("topic", "cutoff", "time_unit") if words[name] is not None}
    return read_trajectory(text, robot, **how) if how else named(text, robot)


def _wrench(run: RunOptions) -> Wrench | None:
    wrench = run.chosen()["payload"]
    if isinstance(wrench, RandomPayload):
        raise InputError("--payload is 'random': expected what it is, six numbers fx,fy,fz,nx,ny,nz [N, N m]")
    assert wrench is None or isinstance(wrench, Wrench)
    return wrench


def _carrying(robot: Robot, words: dict[str, Any]) -> Robot:
    """The robot with the body that it carries, if any."""
    mass, com, inertia = (words[f"payload_{name}"] for name in ("mass", "com", "inertia"))
    if mass is None:
        named = [option for option, own in (("--payload-com", com), ("--payload-inertia", inertia)) if own is not None]
        if named:
            raise InputError(f"{named[0]} goes with a body: pass --payload-mass KG too")
        return robot
    [kilograms] = numbers_of("--payload-mass", mass, 1)
    centre = [0.0] * 3 if com is None else numbers_of("--payload-com", com, 3)
    tensor = None
    if inertia is not None:
        xx, xy, xz, yy, yz, zz = numbers_of("--payload-inertia", inertia, 6)
        tensor = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    return robot.with_payload_body(kilograms, centre, tensor, words["payload_link"])
