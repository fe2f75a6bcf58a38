"""Our side of a comparison: the five quantities, each with a bound on what rounding did to it."""

from __future__ import annotations

import numpy as np

from rttrr_pin.compile import Kernel
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import QUANTITIES, LinkWrenches, Wrench
from rttrr_pin.errors import NumberError
from rttrr_pin.exact import bounded_dynamics
from rttrr_pin.robot import KERNEL_FROM, Robot
from rttrr_pin.validation.states import States

COMPUTED = (*QUANTITIES, "tau_joint")

SMALL = 12
"""Links up to which a kernel with bounds compiles in a second or two, and is taken for as many states as
`Robot.inverse_dynamics` takes one for."""

MANY = 150_000
"""States from which compiling costs less than it saves for robots of any size."""

LARGEST = 60
"""Links beyond which straight lines with bounds take minutes to compile."""


class Ours:
    """Inverse dynamics of a robot with bounds: by the compiled kernel, or by the readable recursion.

    Attributes:
        robot: the robot.
        kernel: with bounds on its own rounding; None where the readable recursion is run, on (value, bound) pairs.
    """

    def __init__(self, robot: Robot, states: int) -> None:
        """Choose by the size of the robot and the number of states to come."""
        links = len(robot.model.links)
        pays = states >= (KERNEL_FROM if links <= SMALL else MANY) and links <= LARGEST
        outputs = (*COMPUTED, *(f"{name}_bound" for name in COMPUTED))
        self.robot = robot
        self.kernel: Kernel | None = robot.compile(outputs) if pays else None

    @property
    def name(self) -> str:
        """Which of the two, in words."""
        return "compiled kernel" if self.kernel is not None else "readable recursion"

    def __call__(self, drawn: States) -> tuple[LinkWrenches, LinkWrenches]:
        """The values at some states, and a bound for each; what overflows is not finite."""
        if self.kernel is not None:
            try:
                return self._compiled(self.kernel, drawn)
            except NumberError:  # shown below, state by state
                pass
        return bounded_dynamics(self.robot.model, drawn.q, drawn.v, drawn.a, drawn.loads)

    def _compiled(self, kernel: Kernel, drawn: States) -> tuple[LinkWrenches, LinkWrenches]:
        payload = [self._wrench(load, len(drawn.q)) for load in drawn.loads]
        result = kernel(drawn.q, drawn.v, drawn.a, payload=payload or None)
        links, joints = self.robot.link_names, self.robot.model.v_names
        values, bounds = ({name: result[name + end] for name in COMPUTED} for end in ("", "_bound"))
        return LinkWrenches.of(values, links, joints), LinkWrenches.of(bounds, links, joints)

    def _wrench(self, load: Load, rows: int) -> Wrench:
        force, moment = (np.broadcast_to(x, (rows, 3)) for x in (load.f, load.n))
        axes = "base" if load.in_base else "link"
        return Wrench(force, moment, self.robot.link_names[load.link], axes)  # type: ignore[arg-type]
