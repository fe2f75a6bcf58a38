"""Our side of a comparison: the five quantities, each with a bound on what rounding did to it."""

from __future__ import annotations

from rttrr_pin.compile import Kernel
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.wrench import QUANTITIES, LinkWrenches
from rttrr_pin.errors import NumberError
from rttrr_pin.exact import bounded_dynamics
from rttrr_pin.robot import Robot
from rttrr_pin.validation.states import States

COMPUTED = (*QUANTITIES, "tau_joint")

KERNEL_FROM = 8192
"""States from which a kernel with bounds is compiled for a robot of at most `SMALL` links."""

SMALL = 12
"""Links up to which it compiles in a second or two."""

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
        self.kernel: Kernel[dict[str, Array]] | None = robot.compile(outputs) if pays else None

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

    def _compiled(self, kernel: Kernel[dict[str, Array]], drawn: States) -> tuple[LinkWrenches, LinkWrenches]:
        result = kernel(drawn.q, drawn.v, drawn.a, payload=drawn.loads or None)
        links, joints = self.robot.link_names, self.robot.model.v_names
        values, bounds = ({name: result[name + end] for name in COMPUTED} for end in ("", "_bound"))
        return LinkWrenches.of(values, links, joints), LinkWrenches.of(bounds, links, joints)
