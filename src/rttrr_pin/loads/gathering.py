"""Everything of a report that is gathered while rows go by."""

from __future__ import annotations

from dataclasses import dataclass

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.loads.envelope import BearingEnvelope, JointEnvelope
from rttrr_pin.loads.evaluation import Evaluator, Values
from rttrr_pin.loads.history import Buckets, Sampling
from rttrr_pin.loads.parts import BearingLoad, JointLoad
from rttrr_pin.loads.ratings import Ratings
from rttrr_pin.loads.states import States
from rttrr_pin.trajectories import Block


@dataclass(frozen=True, slots=True, eq=False)
class Envelope:
    """What it comes to: joints, bearings, and the states that their peaks are at."""

    joints: tuple[JointLoad, ...]
    bearings: tuple[BearingLoad, ...]
    states: States


class Gathered:
    """What was seen so far.

    Attributes:
        rows: how many.
        start: time of the first one [s].
        seconds: from there to the last one [s].
        buckets: tau over time.
        sampling: rows spread over the trajectory.
    """

    def __init__(self, model: Model, bearings: bool) -> None:
        self._joints = JointEnvelope(model)
        self._bearings = BearingEnvelope(model) if bearings else None
        self.buckets, self.sampling = Buckets(), Sampling()
        self.rows, self.start, self.seconds = 0, 0.0, 0.0

    def add(self, rows: Block, weights: Array, values: Values, half_widths: Values | None) -> None:
        """Rows more, with their loads and half the widths of their bands."""
        self.start = self.start if self.rows else float(rows.time[0])
        self.seconds = float(rows.time[-1]) - self.start
        self.rows += len(rows)
        self._joints.add(rows, weights, values)
        if self._bearings is not None:
            self._bearings.add(rows, weights, values)
        self.buckets.add(rows, values["tau"], None if half_widths is None else half_widths["tau"])
        self.sampling.add(rows, values["tau"])

    def envelope(self, evaluator: Evaluator, ratings: Ratings) -> Envelope:
        """What it comes to; the evaluator computes what is to be known of the states."""
        marked = [*self._joints.marked(), *(self._bearings.marked() if self._bearings is not None else ())]
        states = States(marked, evaluator)
        bearings = () if self._bearings is None else tuple(self._bearings.loads(states))
        return Envelope(tuple(self._joints.loads(states, ratings)), bearings, states)
