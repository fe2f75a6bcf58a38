"""`view`: a robot with its forces and moments, in the browser or as a file."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import closing

from rttrr_pin.core.payload import Payloads, loads_of
from rttrr_pin.errors import InputError
from rttrr_pin.implementations.registry import Source
from rttrr_pin.reporting.output import write_text
from rttrr_pin.robot import Robot
from rttrr_pin.robot import model_of as robot_model
from rttrr_pin.trajectories import Trajectory
from rttrr_pin.validation.comparison import Run
from rttrr_pin.viewing.evaluation import Evaluator
from rttrr_pin.viewing.looks import Looks, looks_of
from rttrr_pin.viewing.recording import Recording, by_difference, by_torque, record, sampled
from rttrr_pin.viewing.states import State
from rttrr_pin.viewing.viewer import Subject, Viewer

MOST_NAMED = 3
"""Meshes that are named where they are not found."""


def view(
    robot: Robot,
    trajectory: Trajectory | None = None,
    *,
    subject: Source | None = None,
    reference: Source = "kernel",
    state: State | None = None,
    worst: bool = False,
    meshes: bool = True,
    port: int = 0,
    html: str | os.PathLike[str] | None = None,
    started: Callable[[Viewer], object] | None = None,
) -> None:
    """Show a robot, its bodies, and the forces and moments of a state, in a browser on this machine.

    It serves until a signal ends it (Ctrl-C raises KeyboardInterrupt), at 127.0.0.1 alone, and prints its address.

    Args:
        robot: the robot.
        trajectory: what can be played (`rttrr_pin.trajectories`).
        subject: a program, as in `validate`: numbers and arrows are then its difference to the reference.
        reference: what it is compared with.
        state: what is shown at first; None is at rest, or the first row of the trajectory.
        worst: whether the worst row is shown at first: that with the largest |tau| of its limit, or with the largest
            difference.
        meshes: whether meshes are drawn.
        port: of this machine; 0 is any that is free.
        html: a file to write instead of serving, "-" for stdout; a trajectory plays in it, unless a state or the worst
            is asked for.
        started: called once it serves, in place of printing the address.

    Raises:
        InputError: an argument cannot be used, the port is taken, or viser is not installed (extra `view`).
        ImplementationError: as in `validate`.
    """
    shown = prepared(robot, trajectory, subject, reference, state, meshes)
    if worst and shown.recording is None:
        raise InputError("the worst state is one of a trajectory, or of two programs: pass either")
    viewer = Viewer(shown, port)
    if worst:
        viewer.jump_to_worst()
        viewer.show()
    if html is not None:
        from rttrr_pin.viewing.page import html_page

        with closing(viewer):
            write_text(os.fspath(html), lambda: html_page(viewer, playing=state is None and not worst))
        return
    (started or _announce)(viewer)
    viewer.run()


def _announce(viewer: Viewer) -> None:
    print(f"{viewer.model.name}: {viewer.address} (this machine alone; Ctrl-C ends)", flush=True)


def prepared(
    robot: Robot,
    trajectory: Trajectory | None = None,
    subject: Source | None = None,
    reference: Source = "kernel",
    state: State | None = None,
    meshes: bool = True,
) -> Subject:
    """What a viewer shows; see `view`."""
    model = robot_model(robot)
    run = None if subject is None else Run.of(robot, subject, reference, 0, "uniform", None)
    recording: Recording | None = None
    if trajectory is not None:
        recording = record(trajectory, by_torque(robot) if run is None else by_difference(run))
    elif run is not None:
        recording = sampled(run)
    looks = looks_of(model, meshes)
    return Subject(Evaluator(robot, run), looks, recording, state, _notes(looks, robot, run))


def _notes(looks: Looks, robot: Robot, run: Run | None) -> tuple[str, ...]:
    """What a viewer should know."""
    notes = [note.text for note in robot.model.notes if note.left_out] if run is None else list(run.notes)
    if looks.missing:
        named = ", ".join(looks.missing[:MOST_NAMED]) + (", ..." if len(looks.missing) > MOST_NAMED else "")
        notes.append(f"{len(looks.missing)} meshes cannot be read: {named}; --package NAME=FOLDER says where they are")
    if looks.parts and looks.role == "collision":
        notes.append("nothing that the file draws can be shown: these are its collision shapes")
    from rttrr_pin.viewing.ellipsoids import ellipsoids

    bad = [robot.link_names[body.link] for body in ellipsoids(robot.model) if body.impossible]
    if bad:
        notes.append(f"no body has the inertia of {', '.join(bad)}: marked red among the inertia ellipsoids")
    return tuple(notes)


def state_of(robot: Robot, q: object = None, v: object = None, a: object = None, payload: Payloads = None) -> State:
    """A state to show at first: coordinates, or dicts by joint name; what is left out is zero, or within the limits.

    Raises:
        InputError, ShapeError, NumberError, MissingJointError, UnknownNameError: as in `Robot.inverse_dynamics`.
    """
    from rttrr_pin.core.inputs import coordinates
    from rttrr_pin.viewing.states import at_rest

    model = robot_model(robot)
    rest = at_rest(model)
    given = {"q": q, "v": v, "a": a}
    numbers = {
        name: getattr(rest, name) if x is None else coordinates(name, x, model.moving)  # type: ignore[arg-type]
        for name, x in given.items()
    }
    if any(x.ndim != 1 for x in numbers.values()):
        raise InputError("a state to show has no batch axis: pass one number for each joint")
    return State(**numbers, loads=loads_of(model, payload))
