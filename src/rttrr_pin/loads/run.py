"""From a robot and a trajectory to its loads, in one pass and constant memory."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from rttrr_pin.core.arguments import path_of
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.batch import keep_memory
from rttrr_pin.core.conventions import convention as convention_of
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load, Payloads, loads_of
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.loads.bearings import PARTS
from rttrr_pin.loads.evaluation import Evaluator
from rttrr_pin.loads.gathering import Gathered
from rttrr_pin.loads.output.files import ROS, Outputs, Wanted, opener
from rttrr_pin.loads.output.finite_elements import load_cases as load_cases_of
from rttrr_pin.loads.output.tables import WRITERS
from rttrr_pin.loads.output.wrench_stamped import check_frame
from rttrr_pin.loads.quantities import CROSSING, check_convention, checked
from rttrr_pin.loads.ratings import GearRating, Ratings, checked_ratings, read_ratings
from rttrr_pin.loads.results import LoadReport
from rttrr_pin.loads.rows import SIZE, weighted
from rttrr_pin.loads.stopwatch import Stopwatch
from rttrr_pin.loads.sums import Integral
from rttrr_pin.reporting.files import write_whole
from rttrr_pin.robot import Robot, model_of
from rttrr_pin.trajectories import Block, Trajectory, named
from rttrr_pin.version import __version__

Name = str | os.PathLike[str]


def compute_loads(
    robot: Robot,
    trajectory: Trajectory | Name,
    *,
    quantities: str | Sequence[str] = ("tau",),
    payload: Payloads = None,
    convention: str | None = None,
    output: Name | None = None,
    wrench_stamped: Name | None = None,
    load_cases: Name | None = None,
    band: bool = True,
    bearings: bool = True,
    ratings: Ratings | Name | None = None,
    progress: Callable[[int], None] | None = None,
) -> LoadReport:
    """What every joint and bearing carries along a trajectory, whatever its length.

    Files are written while rows go by, and are whole or not there. The same trajectory gives the same bits, in
    whatever blocks it comes. Where v or a were derived, every quantity but energy has half the width of a band of 95
    percent beside it, in columns that end with `_error`.

    Args:
        robot: the robot; a body that it carries comes by `Robot.with_payload_body`.
        trajectory: what `rttrr_pin.trajectories` makes, or a file or name that it knows.
        quantities: what is written, of "tau", "F", "N", "f", "n", "power", and "energy" (what the drive gave so far).
        payload: what the robot exerts on its surroundings in all rows, one wrench or several; a trajectory with columns
            of its own takes none.
        convention: another program's axes, point and sign of f and n, then called force and moment (docs/wrenches.md).
        output: the table, `.csv`, `.parquet` or `.npz`; None for none.
        wrench_stamped: f and n as geometry_msgs/WrenchStamped, `.csv`, `.parquet` or, as a bag, `.mcap`; None for none.
        load_cases: a CSV for finite elements: all that acts on each link in the states that matter; None for none.
        band: whether the band of 95 percent is computed.
        bearings: whether the loads of bearings are.
        ratings: of gears, by joint, or the TOML file that they stand in.
        progress: called with the number of rows done.

    Raises:
        InputError: an argument cannot be used, a file cannot be read or written, or there is no row.
        UnknownNameError: there is no such quantity, convention, kind of file, or joint of a rating.
        NumberError: a load is too large for float64; says in which row.
    """
    began = time.perf_counter()
    model = model_of(robot)
    if not model.links:
        raise InputError(f"robot {model.name!r} has no joint, so that nothing carries a load")
    if not isinstance(trajectory, Trajectory):
        trajectory = named(os.fspath(path_of("trajectory", trajectory)), robot)
    rated = _rated(ratings, model)
    loads = _loads(model, payload)
    wanted = _wanted(model, trajectory, quantities, convention, (output, wrench_stamped), band)
    cases = None if load_cases is None else path_of("load_cases", load_cases)
    if cases is not None and cases.suffix.lower() != ".csv":
        raise UnknownNameError("kind of load_cases", cases.suffix or cases.name, [".csv"])
    run = _Run(robot, trajectory, wanted, loads, bearings, cases)
    run.go(progress, rated)
    return run.report(time.perf_counter() - began)


class _Run:
    """One pass through a trajectory, and what comes of it."""

    def __init__(
        self,
        robot: Robot,
        trajectory: Trajectory,
        wanted: Wanted,
        loads: tuple[Load, ...],
        bearings: bool,
        cases: Path | None,
    ) -> None:
        self._robot, self._trajectory, self._wanted, self._loads, self._cases = robot, trajectory, wanted, loads, cases
        self._parts = PARTS if bearings else ()
        messages = () if wanted.wrench_stamped is None else wanted.crossing
        energy = ("power",) if "energy" in wanted.quantities else ()
        names = [name for name in (*wanted.quantities, *messages, *energy, *self._parts) if name != "energy"]
        self._evaluator = Evaluator(robot, names, trajectory, wanted.convention)
        of_band = [name for name in wanted.quantities if name != "energy"]
        self._of_band = Evaluator(robot, of_band, trajectory, wanted.convention) if wanted.banded else None
        self._gathered, self._work = Gathered(robot.model, bearings), Integral()
        self._payload = described(robot.model, loads)
        self._clock = Stopwatch()

    def go(self, progress: Callable[[int], None] | None, ratings: Ratings) -> None:
        """Through all rows, and to the envelope; files are in their places afterwards."""
        keep_memory()
        with Outputs(self._robot.model, self._wanted) as outputs:
            for rows, weights in self._clock.each("read", weighted(self._blocks())):
                self._add(rows, weights, outputs)
                if progress is not None:
                    progress(rows.start + len(rows))
            if not self._gathered.rows:
                raise InputError(f"{self._trajectory.name} has no row: give one for each time")
            of_links = () if self._cases is None else LINK_QUANTITIES
            at_peaks = Evaluator(self._robot, ("power", *of_links, *self._parts), self._trajectory)
            self._envelope = self._gathered.envelope(at_peaks, ratings)
            if self._cases is not None:
                states = self._envelope.states
                write_whole(self._cases, load_cases_of(self._robot.model, states.named, states.values))

    def _blocks(self) -> Iterator[Block]:
        for block in self._trajectory.blocks(SIZE):
            if block.payload:
                names = dict.fromkeys(self._robot.link_names[load.link] for load in block.payload)
                self._payload = f"the trajectory's, at {', '.join(names)}"
            if block.payload and self._loads:
                link = self._robot.link_names[block.payload[0].link]
                raise InputError(
                    f"{self._trajectory.name} has a payload of its own, at {link}, and a payload is passed too: leave "
                    "one of them out",
                    options={"a payload is passed": "--payload is given"},
                )
            yield replace(block, payload=self._loads) if self._loads else block

    def _add(self, rows: Block, weights: Array, outputs: Outputs) -> None:
        if not self._gathered.rows:
            self._clock.timed("compile", lambda: self._evaluator.of(rows.part(slice(0, 1))))
        values = self._clock.timed("kernel", lambda: self._evaluator.of(rows))
        of_band = self._of_band
        half_widths = None if of_band is None else self._clock.timed("band", lambda: of_band.half_widths(rows))
        self._clock.timed("envelope", lambda: self._gathered.add(rows, weights, values, half_widths))
        if "energy" in self._wanted.quantities:
            values["energy"] = self._work.add(rows.time, values["power"])
        self._clock.timed("write", lambda: outputs.write(rows, values, half_widths))

    def report(self, seconds: float) -> LoadReport:
        """What came of it."""
        wanted, envelope, gathered = self._wanted, self._envelope, self._gathered
        outputs = (*wanted.paths, *([] if self._cases is None else [self._cases]))
        return LoadReport(
            robot=self._robot.name,
            trajectory=self._trajectory.name,
            place=self._trajectory.place,
            rows=gathered.rows,
            start=gathered.start,
            seconds=gathered.seconds,
            payload=self._payload,
            quantities=wanted.asked,
            convention=None if wanted.convention is None else wanted.convention.name,
            differentiation=self._trajectory.differentiation,
            band=wanted.banded,
            notes=self._trajectory.notes,
            findings=self._trajectory.findings,
            joints=envelope.joints,
            bearings=envelope.bearings,
            history=gathered.buckets.history(self._robot.model.nv),
            samples=gathered.sampling.samples(),
            states=envelope.states.named,
            outputs=tuple(map(str, outputs)),
            wall_time=self._clock.seconds | {"all": seconds},
        )


def _wanted(
    model: Model,
    trajectory: Trajectory,
    quantities: str | Sequence[str],
    convention: str | None,
    outputs: tuple[Name | None, Name | None],
    band: bool,
) -> Wanted:
    """What is to be written, once all of it is known to be possible."""
    table, messages = (None if own is None else path_of("output", own) for own in outputs)
    row = None if convention is None else convention_of(convention)
    asked = checked(quantities)
    if table is not None:
        opener("output", table, WRITERS)
        check_convention(asked if messages is None else CROSSING, row)
    if messages is not None:
        opener("wrench_stamped", messages, ROS)
        check_frame(row)
    about = {
        "written by": f"rttrr-pin {__version__}",
        "robot": model.name,
        "trajectory": trajectory.name,
        "wrenches": "f and n, docs/notation.md" if row is None else f"{row.name}: {row.words}",
    }
    return Wanted(table, messages, asked, row, band and trajectory.differentiation is not None, about)


def _rated(ratings: Ratings | Name | None, model: Model) -> dict[str, GearRating]:
    if ratings is None:
        return {}
    if isinstance(ratings, Mapping):
        return checked_ratings(ratings, model)
    return read_ratings(path_of("ratings", ratings), model)


def _loads(model: Model, payload: Payloads) -> tuple[Load, ...]:
    """One wrench for all rows, or several."""
    loads = loads_of(model, payload)
    for load in loads:
        if load.f.ndim + load.n.ndim > 2:
            raise InputError(
                "payload has a batch axis: pass one force and one moment of 3 numbers, or rows of a trajectory"
            )
    return loads


def described(model: Model, loads: Sequence[Load]) -> str:
    """A payload in words."""
    said = [
        f"force {load.f.tolist()} N, moment {load.n.tolist()} N m at {model.link_names[load.link]}, "
        f"{'base' if load.in_base else 'link'} axes"
        for load in loads
    ]
    return "; ".join(said) or "none"
