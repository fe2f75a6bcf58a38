"""Sine and cosine for code that must run many states at once: numbers and limits.

    q = k pi/2 + r + r_lo,   |r| <= pi/4
    sin r = r + r^3 S(r^2),   cos r = 1 - r^2/2 + r^4 C(r^2)

k pi/2 is subtracted in three parts. The first difference t, by a fused multiply-add, is exact, since it lies on the
grid of q or of the first part. What the second product and the second difference round off goes into r_lo; for the
difference that is second - (r - t), exactly (Dekker's sum), since t is a multiple of the last place of the product.

S and C are interpolated at Chebyshev nodes (`benchmarks/sincos_accuracy.py` makes and measures them: at most 1 unit in
the last place over the whole range, in float32 at every number of it). From `largest` on, and for what is not finite,
the C library's functions of float64 serve.
"""

from __future__ import annotations

from dataclasses import dataclass

from rttrr_pin.compile.float_type import FloatType


@dataclass(frozen=True, slots=True)
class SinCos:
    """The numbers of one type.

    Attributes:
        pio2: pi/2 as the sum of three.
        two_over_pi: 2/pi.
        round: x + round has the nearest integer to x in its last bits; subtracting it again gives that integer.
        largest: up to this |q| [rad] the three parts of pi/2 suffice.
        sine: S, lowest power first; relative error of the sine below 2^-55, of float32 2^-26.
        cosine: C, lowest power first; relative error of the cosine below 2^-59, of float32 2^-29.
    """

    pio2: tuple[float, ...]
    two_over_pi: float
    round: float
    largest: float
    sine: tuple[float, ...]
    cosine: tuple[float, ...]


def _numbers(*texts: str) -> tuple[float, ...]:
    return tuple(map(float.fromhex, texts))


IN_FLOAT64 = SinCos(
    pio2=_numbers("0x1.921fb54442d18p+0", "0x1.1a62633145c07p-54", "-0x1.f1976b7ed8fbcp-110"),
    two_over_pi=float.fromhex("0x1.45f306dc9c883p-1"),
    round=1.5 * 2.0**52,
    largest=2.0**17,
    sine=_numbers(
        "-0x1.5555555555555p-3",
        "0x1.1111111110bb2p-7",
        "-0x1.a01a019e83aa8p-13",
        "0x1.71de3796898c8p-19",
        "-0x1.ae600b022d198p-26",
        "0x1.5e0b19c752b8ep-33",
    ),
    cosine=_numbers(
        "0x1.5555555555555p-5",
        "-0x1.6c16c16c16967p-10",
        "0x1.a01a019f4eafdp-16",
        "-0x1.27e4fa17d9c81p-22",
        "0x1.1eeb68e8f6cdfp-29",
        "-0x1.907da33638fbcp-37",
    ),
)

IN_FLOAT32 = SinCos(
    pio2=_numbers("0x1.921fb6p+0", "-0x1.777a5cp-25", "-0x1.ee59dap-50"),
    two_over_pi=float.fromhex("0x1.45f306p-1"),
    round=1.5 * 2.0**23,
    largest=2.0**17,
    sine=_numbers("-0x1.555552p-3", "0x1.110c02p-7", "-0x1.9ab47cp-13"),
    cosine=_numbers("0x1.555554p-5", "-0x1.6c12b4p-10", "0x1.9bc79cp-16"),
)

LARGEST = IN_FLOAT64.largest
"""Up to this |q| [rad] polynomials serve in float64."""


def sincos_in(float_type: FloatType) -> SinCos:
    """The numbers of a type."""
    return IN_FLOAT64 if float_type.bits == 64 else IN_FLOAT32
