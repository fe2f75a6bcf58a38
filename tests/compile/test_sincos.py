"""Sine and cosine of compiled code against their true values, to the unit in the last place."""

from __future__ import annotations

import math
from collections.abc import Callable

import mpmath
import numpy as np
import pytest

from rttrr_pin.compile.emit import emitter
from rttrr_pin.compile.expression import Graph, Op
from rttrr_pin.compile.fields import Field
from rttrr_pin.compile.program import Program
from rttrr_pin.compile.sincos import LARGEST
from support.tolerances import SINCOS_ULPS

SinCos = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
DIGITS = 400
"""Enough for the greatest float64, of 309 digits, and a cosine that is nearly 0."""

TINY = float(np.finfo(float).tiny)


@pytest.fixture(scope="module")
def sincos() -> SinCos:
    """A program of one angle, compiled as those of robots are."""
    graph = Graph()
    q = graph.input(0)
    results = (graph.function(Op.SIN, q), graph.function(Op.COS, q))
    program = Program(graph, (Field("q", (1,)),), (Field("sincos", (2,)),), results)
    made = emitter("llvm")
    executable = made.load(made.emit(program), program.inputs, program.outputs)

    def run(angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        out = np.full((len(angles), 2), np.nan)
        unsound = executable.bind([angles[:, None]], [out])(0, len(angles))
        assert unsound == (not np.isfinite(out).all())
        return out[:, 0], out[:, 1]

    return run


def worst(sincos: SinCos, angles: np.ndarray) -> float:
    """The largest error of both, in units in the last place of the true value."""
    errors = []
    with mpmath.workdps(DIGITS):
        for function, values in zip((mpmath.sin, mpmath.cos), sincos(angles), strict=True):
            for q, x in zip(angles.tolist(), values.tolist(), strict=True):
                true = function(mpmath.mpf(q))
                errors.append(float(abs(x - true) / math.ulp(float(true))))
    return max(errors)


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize(
    "size", [1e-300, 1e-20, 1e-9, 1e-4, 0.1, math.pi / 4, 1.0, math.pi, 100.0, 1e4, LARGEST, 1e6, 1e22, 1e300], ids=str
)
def test_angles_of_every_size(sincos: SinCos, size: float, seed: int) -> None:
    assert worst(sincos, np.random.default_rng(seed).uniform(-size, size, 60)) <= SINCOS_ULPS


@pytest.mark.parametrize("seed", [0, 1])
def test_angles_of_any_bits(sincos: SinCos, seed: int) -> None:
    """Every exponent, denormal to greatest."""
    bits = np.random.default_rng(seed).integers(0, 2**63, 150, dtype=np.int64)
    angles = bits.view(np.float64)
    assert worst(sincos, angles[np.isfinite(angles)]) <= SINCOS_ULPS


@pytest.mark.parametrize("seed", [0])
def test_a_turn(sincos: SinCos, seed: int) -> None:
    """The angles of robots."""
    assert worst(sincos, np.random.default_rng(seed).uniform(-2 * math.pi, 2 * math.pi, 2000)) <= SINCOS_ULPS


def multiples_of_pi_half(bits: int) -> tuple[np.ndarray, np.ndarray]:
    """The doubles nearest to the multiples of pi/2 up to the limit, and what they lack, from integers of many bits."""
    with mpmath.workprec(bits + 8):
        half_pi = int(mpmath.floor(mpmath.pi * mpmath.mpf(2) ** (bits - 1)))
    count = int(LARGEST / (math.pi / 2))
    nearest, lacking = np.empty(count), np.empty(count)
    for k in range(1, count + 1):
        exact = k * half_pi
        nearest[k - 1] = exact / 2**bits
        numerator, denominator = nearest[k - 1].as_integer_ratio()
        lacking[k - 1] = (numerator * (2**bits // denominator) - exact) / 2**bits
    return nearest, lacking


def test_the_nearest_doubles_to_all_multiples_of_pi_half(sincos: SinCos) -> None:
    """There one of both is the distance d to the multiple itself (d^3 is far below its last place), the other +-1."""
    nearest, d = multiples_of_pi_half(320)
    k = np.arange(1, len(d) + 1)
    assert len(k) > 80_000 and np.abs(d).min() > 0 and np.abs(d).max() < 1e-11
    for sign in (1, -1):
        sine, cosine = sincos(sign * nearest)
        odd = k % 2 == 1
        turned = np.where(k // 2 % 2, -1.0, 1.0)
        small = np.where(odd, cosine, sign * sine)
        expected = np.where(odd, -turned * d, turned * d)
        assert (np.abs(small - expected) <= SINCOS_ULPS * np.spacing(np.abs(expected))).all()
        np.testing.assert_array_equal(np.where(odd, sign * sine, cosine), turned)


@pytest.mark.parametrize("step", [-2, -1, 1, 2])
def test_doubles_beside_multiples_of_pi_quarter(sincos: SinCos, step: int) -> None:
    """Where the polynomials' interval ends, and beside those of pi/2."""
    k = np.r_[1:120, np.random.default_rng(0).integers(120, 2 * 83_000, 60)]
    angles = k * (math.pi / 4)
    for _ in range(abs(step)):
        angles = np.nextafter(angles, np.inf * step)
    assert worst(sincos, np.r_[angles, -angles]) <= SINCOS_ULPS


def test_around_the_limit_of_the_polynomials(sincos: SinCos) -> None:
    beside = [LARGEST]
    for towards in (0.0, np.inf):
        x = LARGEST
        for _ in range(40):
            x = float(np.nextafter(x, towards))
            beside.append(x)
    angles = np.array(beside)
    assert worst(sincos, np.r_[angles, -angles]) <= SINCOS_ULPS


HARD = (5e-324, 1e-310, TINY, 2 * TINY, 1e-200, 2.0**-27, 2.0**-26, 1e22, 1.7e308)
"""Denormals, 1e22, and the greatest. (At 6381956970095103 * 2^797, nearest of all to a multiple of pi/2, glibc's own cosine
is 8 units off.)"""


@pytest.mark.parametrize("x", HARD, ids=repr)
def test_hard_angles(sincos: SinCos, x: float) -> None:
    assert worst(sincos, np.array([x, -x])) <= SINCOS_ULPS


def test_zero(sincos: SinCos) -> None:
    sine, cosine = sincos(np.array([0.0, -0.0]))
    assert not sine.any()
    assert (cosine == 1.0).all()


def test_tiny_angles_are_their_own_sine(sincos: SinCos) -> None:
    angles = 2.0 ** -np.arange(27.0, 1075.0)
    sine, cosine = sincos(angles)
    np.testing.assert_array_equal(sine, angles)
    np.testing.assert_array_equal(cosine, np.ones_like(angles))


@pytest.mark.parametrize("x", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_gives_nan(sincos: SinCos, x: float) -> None:
    sine, cosine = sincos(np.array([x, 1.0, x]))
    assert np.isnan([sine[0], cosine[0], sine[2], cosine[2]]).all()
    assert (sine[1], cosine[1]) == tuple(x[0] for x in sincos(np.array([1.0])))


def test_sine_is_odd_and_cosine_even_to_the_last_bit(sincos: SinCos) -> None:
    rng = np.random.default_rng(0)
    angles = rng.uniform(-1, 1, 20_000) * 10.0 ** rng.uniform(-10, 7, 20_000)
    (sine, cosine), (other_sine, other_cosine) = sincos(angles), sincos(-angles)
    np.testing.assert_array_equal(sine, -other_sine)
    np.testing.assert_array_equal(cosine, other_cosine)
    assert np.abs([sine, cosine]).max() <= 1.0


def test_an_angle_that_the_library_does_leaves_its_neighbours_alone(sincos: SinCos) -> None:
    angles = np.random.default_rng(0).uniform(-9, 9, 131)
    expected = sincos(angles)
    for k in (0, 1, 63, 64, 128, 130):
        mixed = angles.copy()
        mixed[k] = 1e10
        for x, y in zip(sincos(mixed), expected, strict=True):
            np.testing.assert_array_equal(np.delete(x, k), np.delete(y, k))
