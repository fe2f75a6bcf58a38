"""Trajectories of arrays that are there already."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from rttrr_pin.core.arguments import text
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.batch import blocks
from rttrr_pin.core.inputs import Coordinates, coordinates, finite, real
from rttrr_pin.core.payload import Load, Payloads, loads_of
from rttrr_pin.errors import InputError, ShapeError
from rttrr_pin.implementations.text_results import PAYLOAD
from rttrr_pin.robot import Robot
from rttrr_pin.robot.robot import model_of
from rttrr_pin.trajectories.rows import AT_ONCE, Rows, Source, documented, numbered
from rttrr_pin.trajectories.stream import Trajectory


def trajectory(
    robot: Robot,
    time: ArrayLike,
    q: Coordinates,
    v: Coordinates | None = None,
    a: Coordinates | None = None,
    *,
    name: str = "trajectory",
    payload: Payloads = None,
    cutoff: float | None = None,
) -> Trajectory:
    """A trajectory of arrays.

    Args:
        robot: whose trajectory it is.
        time: of each row, increasing, (N,) [s].
        q: coordinates, (N, nq), or a dict by joint name.
        v: rates, (N, nv); derived from q where they are None.
        a: accelerations, (N, nv); derived where they are None.
        name: as messages call it.
        payload: what the robot exerts on its surroundings, the same in all rows or one for each.
        cutoff: frequency up to which derived rates and accelerations follow the rows [Hz]; None: chosen by the noise.

    Raises:
        ShapeError, NumberError, UnknownNameError, MissingJointError: an array or a dict cannot be used.
        InputError: time goes back, or rates that cannot be derived are not there.
    """
    model, name = model_of(robot), text("name", name)
    t = finite("time", real("time", time))
    if t.ndim != 1:
        raise ShapeError(
            f"time has shape {t.shape}, expected (N,): one time for each row", name="time", got=t.shape, wanted="(N,)"
        )
    given: dict[str, Coordinates] = {"q": q} | {key: x for key, x in (("v", v), ("a", a)) if x is not None}
    values = {key: coordinates(key, x, model.moving) for key, x in given.items()}
    for key, x in values.items():
        if x.ndim != 2 or len(x) != len(t):
            wanted = f"({len(t)}, {x.shape[-1]})"
            raise ShapeError(
                f"{key} has shape {x.shape}, expected {wanted}: one row for each time",
                name=key,
                got=x.shape,
                wanted=wanted,
            )
    loads = loads_of(model, payload)
    labels = {key: own for key, own in documented(model).items() if key in values}
    if loads:
        values[PAYLOAD] = np.hstack([_wrench(load, len(t)) for load in loads])
        labels[PAYLOAD] = tuple(f"payload of {model.link_names[load.link]}" for load in loads for _ in range(6))
    source = Source(
        name,
        lambda findings: _rows(t, values),
        labels,
        tuple((load.link, load.in_base) for load in loads),
        unit=1.0,
        n_rows=len(t),
    )
    return Trajectory(source, model, cutoff)


def _wrench(load: Load, count: int) -> Array:
    """Force and moment in each row."""
    try:
        return np.hstack([np.broadcast_to(x, (count, 3)) for x in (load.f, load.n)])
    except ValueError:
        raise InputError(
            f"payload has force {load.f.shape} and moment {load.n.shape}: expected (3,) or ({count}, 3)"
        ) from None


def _rows(t: Array, values: dict[str, Array]) -> Iterator[Rows]:
    for part in blocks(len(t), AT_ONCE):
        yield Rows(numbered(part.start, part.stop - part.start), t[part], {key: x[part] for key, x in values.items()})
