"""One robot, one compiled program.

The reference recursion runs once on scalars that record (`trace`), its sums are ordered (`summation`), and an
emitter turns it into machine code (`emit`), which is kept on disk (`cache`). Robots too large for that (`build`) have
each kind of step of the recursion recorded once (`outlining`), and become a table of calls (`call_program`).
"""

from rttrr_pin.compile.kernel import Kernel
from rttrr_pin.compile.quantities import QUANTITIES

__all__ = ["QUANTITIES", "Kernel"]
