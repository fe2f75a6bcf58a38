"""Claim: sine and cosine of compiled code are within one unit in the last place, for every angle.

Run: python benchmarks/sincos_accuracy.py [--angles N] [--save]. Measured against mpmath on random angles of all sizes
and on the doubles next to multiples of pi/2, where range reduction is hardest. Also fits the polynomials again, from
Taylor's series at Chebyshev nodes, and compares them with those in `rttrr_pin.compile.sincos`.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import mpmath
import numpy as np
from numpy.typing import NDArray

from common import arguments, finish
from rttrr_pin.compile.emit import emitter
from rttrr_pin.compile.expression import Graph, Op
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.program import Program
from rttrr_pin.compile.sincos import COSINE, LARGEST, SINE

Array = NDArray[np.float64]


def compiled(angles: Array) -> Array:
    """Sines and cosines by machine code, (N, 2)."""
    graph = Graph()
    q = graph.input(0)
    results = (graph.function(Op.SIN, q), graph.function(Op.COS, q))
    program = Program(graph, (Field("q", (1,)),), (Field("sincos", (2,)),), results)
    machine = emitter("llvm")
    executable = machine.load(machine.emit(program), program.inputs, program.outputs)
    out = np.empty((len(angles), 2))
    executable.bind([angles[:, None]], [out])(0, len(angles))
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


def fitted(function: Callable[[mpmath.mpf], mpmath.mpf], count: int) -> list[float]:
    """The polynomial through a function of r^2 at Chebyshev nodes of [0, (pi/4)^2]."""
    top = (mpmath.pi / 4) ** 2 * (1 + mpmath.mpf(2) ** -20)
    nodes = [top / 2 * (1 + mpmath.cos(mpmath.pi * (2 * k + 1) / (2 * count))) for k in range(count)]
    powers = mpmath.matrix([[x**j for j in range(count)] for x in nodes])
    return [float(c) for c in mpmath.lu_solve(powers, mpmath.matrix([function(x) for x in nodes]))]


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
        "same polynomials": fitted(sine_rest, len(SINE)) == list(SINE)
        and fitted(cosine_rest, len(COSINE)) == list(COSINE),
    }
    finish("sincos_accuracy", figures, options.save)


if __name__ == "__main__":
    main()
