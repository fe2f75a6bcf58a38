"""The numbers of a state: by the robot itself, or by two programs and as their difference."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.implementations import Batch, label
from rttrr_pin.robot import Robot
from rttrr_pin.validation.comparison import Run
from rttrr_pin.viewing.states import State

DIFFERENCE = "difference"


@dataclass(frozen=True, slots=True, eq=False)
class Numbers:
    """What programs say of a state.

    Attributes:
        values: by program and quantity: tau (nv,), F, N, f, n (links, 3), each in its link's axes. With two programs
            the third entry is `DIFFERENCE`: subject minus reference, of the quantities that both give.
        worst: the place where they differ most, and how: a sentence; empty with one program.
    """

    values: Mapping[str, Mapping[str, Array]]
    worst: str = ""

    @property
    def finite(self) -> bool:
        """Whether every number is."""
        return all(np.isfinite(x).all() for own in self.values.values() for x in own.values())


@dataclass(frozen=True, slots=True, eq=False)
class Evaluator:
    """Computes the numbers of states.

    Attributes:
        robot: the robot.
        run: two programs to compare; None where the robot itself is asked.
    """

    robot: Robot
    run: Run | None = None
    names: tuple[str, ...] = field(init=False)

    def __post_init__(self) -> None:
        own = () if self.run is None else tuple(label(program) for program in self.run.programs[:2])
        if own and own[0] == own[1]:
            own = (f"subject {own[0]}", f"reference {own[1]}")
        object.__setattr__(self, "names", (*own, DIFFERENCE) if own else ("rttrr-pin",))

    @property
    def model(self) -> Model:
        """The robot's."""
        return self.robot.model

    def __call__(self, state: State) -> Numbers:
        """The numbers of one state.

        Raises:
            RttrrError: a program gives none.
        """
        if self.run is None:
            result = self.robot.inverse_dynamics(state.q, state.v, state.a, list(state.loads) or None)
            return Numbers({self.names[0]: dict(result.items())})
        batch = Batch(self.model, state.q[None], state.v[None], state.a[None], state.loads)
        results = self.run.evaluate(batch)
        subject, reference = ({key: x[0] for key, x in one.values.items() if key in QUANTITIES} for one in results[:2])
        with np.errstate(invalid="ignore"):
            difference = {key: subject[key] - reference[key] for key in subject if key in reference}
        rows, apart = self.run.comparisons[0].rows, self.run.differences(batch, results)[0].at((slice(None), 0))
        k = int(np.argmax(apart.of_tolerance))
        off = f"{float(apart.error[k]):.3g} {rows[k].unit} in {rows[k].quantity} of {rows[k].at}"
        worst = f"largest difference: {off}, {float(apart.of_tolerance[k]):.3g} of what rounding explains"
        return Numbers(dict(zip(self.names, (subject, reference, difference), strict=True)), worst)
