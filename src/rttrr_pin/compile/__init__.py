"""One robot, one compiled program.

The specification runs once on scalars that record (`trace`), what they recorded is made shorter (`simplify`), and an
emitter turns it into machine code (`emit`), which is kept on disk (`cache`). Robots too large for that (`build`) have
each kind of step of the specification recorded once (`outliner`), and become a table of calls (`schedule`, `columns`).
"""

from rttrr_pin.compile.kernel import Kernel
from rttrr_pin.compile.quantities import QUANTITIES

__all__ = ["QUANTITIES", "Kernel"]
