"""Claim: sine and cosine of compiled code are within one unit in the last place, for every angle.

Run: python benchmarks/sincos_accuracy.py [--angles N] [--save]. Measured against mpmath on random angles of all sizes
and on the doubles next to multiples of pi/2, where range reduction is hardest. In float32: at every number up to the
limit of the polynomials, and at every 64th beyond, against those of float64, whose error is 2^-29 of a unit there. Also
fits the polynomials again, at Chebyshev nodes, and compares them with those in `rttrr_pin.compile.sincos`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

from common import arguments, finish
from rttrr_pin.compile.emit import Executable, emitter
from rttrr_pin.compile.expression import Graph, Op
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.float_type import FLOAT32, FLOAT64, FloatType
from rttrr_pin.compile.program import Program
from rttrr_pin.compile.sincos import LARGEST, sincos_in

Array = NDArray[np.float64]

MARGINS = {"float64": 2.0**-20, "float32": 2.0**-6 + 2.0**-14}
"""By how much, relatively, r^2 may be beyond (pi/4)^2, since the multiple of pi/2 to subtract is rounded."""

EXPONENTS = (-30, 128)
"""Of float32; smaller angles are their own sine."""

STEP = 64
"""Of the numbers beyond the polynomials one in so many."""


@cache
def machine_code(float_type: FloatType) -> Executable:
    """A program of one angle."""
    graph = Graph()
    q = graph.input(0)
    results = (graph.function(Op.SIN, q), graph.function(Op.COS, q))
    program = Program(graph, (Field("q", (1,)),), (Field("sincos", (2,)),), results, float_type)
    machine = emitter("llvm")
    return machine.load(machine.emit(program), program.inputs, program.outputs)


def compiled(angles: NDArray[Any]) -> NDArray[Any]:
    """Sines and cosines by machine code, (N, 2), in the type of the angles."""
    out = np.empty((2, len(angles)), angles.dtype).T
    machine_code(FLOAT32 if angles.dtype == np.float32 else FLOAT64).bind([angles[:, None]], [out])(0, len(angles))
    return out


def worst(angles: Array) -> dict[str, float]:
    """The largest error in units in the last place of the true value, and where."""
    got = compiled(angles)
    figures: dict[str, float] = {"angles": len(angles)}
    for column, (name, function) in enumerate((("sine", mpmath.sin), ("cosine", mpmath.cos))):
        errors = [_ulps(float(x), function(mpmath.mpf(float(q)))) for x, q in zip(got[:, column], angles, strict=True)]
        at = int(np.argmax(errors))
        figures |= {name: errors[at], f"{name} at": float(angles[at])}
    return figures


def _ulps(x: float, true: mpmath.mpf) -> float:
    nearest = float(true)
    return float(abs(mpmath.mpf(x) - true) / mpmath.mpf(math.ulp(nearest)))


def worst_of_float32() -> dict[str, dict[str, float]]:
    """The largest errors in units in the last place of float32, up to the limit and beyond, and where."""
    figures: dict[str, dict[str, float]] = {"float32 up to the limit": {"angles": 0}, "float32 beyond": {"angles": 0}}
    for exponent in range(*EXPONENTS):
        far = 2.0**exponent >= sincos_in(FLOAT32).largest
        own = figures["float32 beyond" if far else "float32 up to the limit"]
        first = np.uint32((exponent + 127) << 23)
        for start in range(0, 2**23, 2**21):
            bits = first + np.arange(start, start + 2**21, STEP if far else 1, dtype=np.uint32)
            angles = bits.view(np.float32)
            found, true = compiled(angles), compiled(angles.astype(float))
            errors = np.abs(found - true) / np.spacing(np.abs(true).astype(np.float32))
            own["angles"] += len(angles)
            for name, column in (("sine", errors[:, 0]), ("cosine", errors[:, 1])):
                at = int(np.argmax(column))
                if column[at] > own.get(name, 0.0):
                    own |= {name: float(column[at]), f"{name} at": float(angles[at])}
    return figures


def fitted(function: Callable[[mpmath.mpf], mpmath.mpf], count: int, float_type: FloatType) -> tuple[float, ...]:
    """The polynomial through a function of r^2 at Chebyshev nodes of [0, (pi/4)^2], in numbers of a type."""
    top = (mpmath.pi / 4) ** 2 * (1 + mpmath.mpf(MARGINS[float_type.name]))
    nodes = [top / 2 * (1 + mpmath.cos(mpmath.pi * (2 * k + 1) / (2 * count))) for k in range(count)]
    powers = mpmath.matrix([[x**j for j in range(count)] for x in nodes])
    solution = mpmath.lu_solve(powers, mpmath.matrix([function(x) for x in nodes]))
    return tuple(float_type.rounded(float(c)) for c in solution)


def sine_rest(z: mpmath.mpf) -> mpmath.mpf:
    """S with sin r = r + r^3 S(r^2)."""
    r = mpmath.sqrt(z)
    return (mpmath.sin(r) / r - 1) / z


def cosine_rest(z: mpmath.mpf) -> mpmath.mpf:
    """C with cos r = 1 - r^2/2 + r^4 C(r^2)."""
    return (mpmath.cos(mpmath.sqrt(z)) - 1 + z / 2) / z**2


def hard(limit: float) -> Array:
    """The doubles next to multiples of pi/2, and their neighbours."""
    multiples = np.arange(1, int(limit / (math.pi / 2)), 7, dtype=float)
    near = np.array([float(mpmath.mpf(k) * mpmath.pi / 2) for k in multiples])
    return np.concatenate([near, np.nextafter(near, 0.0), np.nextafter(near, np.inf), -near])


def main() -> None:
    parser = arguments(__doc__ or "")
    parser.add_argument("--angles", type=int, default=100_000)
    options = parser.parse_args()
    mpmath.mp.prec = 200
    rng = np.random.default_rng(0)
    signs = rng.choice([-1.0, 1.0], options.angles)
    figures = {
        "one turn": worst(rng.uniform(-math.pi, math.pi, options.angles)),
        "up to the fallback": worst(rng.uniform(-LARGEST, LARGEST, options.angles)),
        "all sizes": worst(signs * 2.0 ** rng.uniform(-1000, 1000, options.angles)),
        "next to multiples of pi/2": worst(hard(LARGEST)),
        **worst_of_float32(),
        "same polynomials": all(
            fitted(sine_rest, len(numbers.sine), own) == numbers.sine
            and fitted(cosine_rest, len(numbers.cosine), own) == numbers.cosine
            for own, numbers in ((own, sincos_in(own)) for own in (FLOAT64, FLOAT32))
        ),
    }
    finish("sincos_accuracy", figures, options.save)


if __name__ == "__main__":
    main()
