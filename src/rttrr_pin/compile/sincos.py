"""Sine and cosine for code that must run many states at once: numbers and limits.

    q = k pi/2 + r + r_lo,   |r| <= pi/4
    sin r = r + r^3 S(r^2),   cos r = 1 - r^2/2 + r^4 C(r^2)

k pi/2 is subtracted in three parts. The first difference t, by a fused multiply-add, is exact, since it lies on the
grid of q or of the first part. What the second product and the second difference round off goes into r_lo; for the
difference that is second - (r - t), exactly (Dekker's sum), since t is a multiple of the last place of the product.

S and C are interpolated at Chebyshev nodes (`benchmarks/sincos_accuracy.py` makes and measures them: at most 1 unit in
the last place over the whole range). From `LARGEST` on, and for what is not finite, the C library's functions serve.
"""

from __future__ import annotations

PIO2 = (
    float.fromhex("0x1.921fb54442d18p+0"),
    float.fromhex("0x1.1a62633145c07p-54"),
    float.fromhex("-0x1.f1976b7ed8fbcp-110"),
)
"""pi/2 as the sum of three float64."""

TWO_OVER_PI = float.fromhex("0x1.45f306dc9c883p-1")

ROUND = 1.5 * 2.0**52
"""x + ROUND has the nearest integer to x in its last bits; subtracting ROUND again gives that integer."""

LARGEST = 2.0**17
"""Up to this |q| [rad] the three parts of pi/2 suffice."""

SINE = tuple(
    float.fromhex(x)
    for x in (
        "-0x1.5555555555555p-3",
        "0x1.1111111110bb2p-7",
        "-0x1.a01a019e83aa8p-13",
        "0x1.71de3796898c8p-19",
        "-0x1.ae600b022d198p-26",
        "0x1.5e0b19c752b8ep-33",
    )
)
"""S, lowest power first; relative error of the sine below 2^-55."""

COSINE = tuple(
    float.fromhex(x)
    for x in (
        "0x1.5555555555555p-5",
        "-0x1.6c16c16c16967p-10",
        "0x1.a01a019f4eafdp-16",
        "-0x1.27e4fa17d9c81p-22",
        "0x1.1eeb68e8f6cdfp-29",
        "-0x1.907da33638fbcp-37",
    )
)
"""C, lowest power first; relative error of the cosine below 2^-59."""
