"""What a trajectory does to a robot: loads of joints and bearings, their history, and the states that matter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.payload import Load
from rttrr_pin.loads.parts import BearingLoad, JointLoad
from rttrr_pin.reporting.results import Summarised, counted, finite

if TYPE_CHECKING:
    from rttrr_pin.trajectories import Differentiation, Finding


@dataclass(frozen=True, slots=True, eq=False)
class History:
    """tau over time, in buckets of equally many consecutive rows.

    Attributes:
        time: the middle of each bucket, (B,) [s].
        low: the smallest tau in it, (B, nv).
        high: the largest, (B, nv).
        band_low: the smallest of tau less half its band of 95 percent, (B, nv); None where nothing was derived.
        band_high: the largest of tau and half its band, likewise.
        rows: in each bucket; the last may have fewer.
    """

    time: Array
    low: Array
    high: Array
    band_low: Array | None
    band_high: Array | None
    rows: int


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """Rows spread evenly over the trajectory.

    Attributes:
        row: as messages name them, (S,).
        time: (S,) [s].
        q: (S, nq).
        v: (S, nv).
        tau: (S, nv).
    """

    row: NDArray[np.int64]
    time: Array
    q: Array
    v: Array
    tau: Array


@dataclass(frozen=True, slots=True, eq=False)
class NamedState:
    """A state that matters.

    Attributes:
        name: why, such as "peak tau of joint_2"; several reasons are separated by commas.
        row: as messages name it.
        time: [s].
        q: (nq,).
        v: (nv,).
        a: (nv,).
        payload: what the robot exerts there, with wrenches (3,).
    """

    name: str
    row: int
    time: float
    q: Array
    v: Array
    a: Array
    payload: tuple[Load, ...] = ()


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LoadReport(Summarised):
    """The loads of a robot along a trajectory, made by `compute_loads`.

    Attributes:
        robot: its name.
        trajectory: what messages call it.
        place: what they call its rows, "line" or "row".
        rows: how many.
        start: time of the first row [s].
        seconds: from the first row to the last [s].
        payload: what the robot carried, in words.
        quantities: what was written, row by row.
        convention: of the wrenches that were written; None for f and n of this package.
        differentiation: what was derived, and how; None where all was measured.
        band: whether the outputs have a band of 95 percent.
        notes: what a reader of the verdict must know.
        findings: what is unusual in the trajectory.
        joints: the degrees of freedom.
        bearings: the joints, fixed ones too; empty where they were not asked for.
        history: tau over time.
        samples: rows spread over the trajectory.
        states: those that matter.
        outputs: the files that were written.
        wall_time: by what was done, and in all [s].
    """

    robot: str
    trajectory: str
    place: str
    rows: int
    start: float
    seconds: float
    payload: str
    quantities: tuple[str, ...]
    convention: str | None
    differentiation: Differentiation | None
    band: bool
    notes: tuple[str, ...]
    findings: tuple[Finding, ...]
    joints: tuple[JointLoad, ...]
    bearings: tuple[BearingLoad, ...]
    history: History
    samples: Samples
    states: tuple[NamedState, ...]
    outputs: tuple[str, ...] = ()
    wall_time: Mapping[str, float] = field(default_factory=dict)

    @property
    def passed(self) -> bool:
        """Whether every joint stays within the limits of the file."""
        return not any(joint.exceeded for joint in self.joints)

    def summary(self) -> str:
        """The verdict in one sentence."""
        return f"{'PASS' if self.passed else 'FAIL'} {self.robot} along {self.trajectory}: {self.verdict()}"

    def verdict(self) -> str:
        """Which limits are exceeded, or what comes closest to one."""
        beyond = [f"{name} of {joint.name}" for joint in self.joints for name in joint.exceeded]
        if beyond:
            return f"{counted(len(beyond), 'limit')} exceeded: {', '.join(beyond)}"
        limited = [(joint.effort_margin, "effort", joint.name) for joint in self.joints]
        limited += [(joint.velocity_margin, "velocity", joint.name) for joint in self.joints]
        limited = [one for one in limited if one[0] < 1.0]
        if not limited:
            return "within the limits"
        margin, kind, name = min(limited)
        return f"within the limits; least margin {100 * margin:.0f} percent, {kind} of {name}"

    def to_dict(self) -> dict[str, Any]:
        """Everything as data for JSON."""
        own = (
            "robot",
            "trajectory",
            "rows",
            "start",
            "seconds",
            "payload",
            "quantities",
            "convention",
            "band",
            "wall_time",
        )
        shown = {"schema": 1, "passed": self.passed, **{name: getattr(self, name) for name in own}}
        shown["differentiation"] = None if self.differentiation is None else self.differentiation.summary()
        many = ("wall_time", "notes", "findings", "joints", "bearings", "history", "samples", "states", "outputs")
        return finite(shown | {name: _data(getattr(self, name)) for name in many})


MARGINS = ("effort_margin", "velocity_margin", "exceeded")
"""What a joint's data has besides its fields."""


def _data(x: Any) -> Any:
    """A dataclass, a sequence of them, or an array as data for JSON."""
    if isinstance(x, np.ndarray):
        return x.tolist()
    if isinstance(x, np.generic):
        return x.item()
    if isinstance(x, Mapping):
        return dict(x)
    if isinstance(x, Sequence) and not isinstance(x, str):
        return [_data(item) for item in x]
    if not hasattr(x, "__dataclass_fields__"):
        return x
    data = {own.name: _data(getattr(x, own.name)) for own in fields(x)}
    return data | ({name: _data(getattr(x, name)) for name in MARGINS} if isinstance(x, JointLoad) else {})
