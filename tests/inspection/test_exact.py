"""The verdict on an inertia is exact: at the boundary, at every scale, in any axes."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pinocchio
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rttrr_pin
from rttrr_pin.inspection import Inspection, inspect
from rttrr_pin.inspection.exact import (
    Matrix,
    Shape,
    nearest_possible,
    rank_if_positive,
    second_moments,
    shape_of,
)
from rttrr_pin.urdf.decimals import Number, text_of
from rttrr_pin.urdf.inertial import Placement, UrdfInertial, symmetric
from support.inspected import ENTRIES, arm, diagonal, inertial
from support.serial_chains import EXAMPLES
from support.tolerances import MODEL

SCALES = range(-18, 7)
"""Powers of ten, kg m^2."""

NO_TIES = Fraction(1_000_003, 999_983)
"""Times this, a number with few digits has many, and none lies halfway between two of its roundings."""

coordinates = st.integers(-9, 9)
points = st.tuples(coordinates, coordinates, coordinates)


def look(text: str, select: str = "P") -> Inspection:
    return inspect(rttrr_pin.load(text), select=[select])


def ids(text: str, select: str = "P") -> list[str]:
    return [found.id for found in look(text, select).findings]


def of_points(cloud: list[tuple[int, int, int]]) -> tuple[Fraction, Matrix]:
    """Mass and inertia about the centre of mass of unit masses, exact."""
    n = Fraction(len(cloud))
    com = [sum(p[k] for p in cloud) / n for k in range(3)]
    sigma = [[sum((p[i] - com[i]) * (p[j] - com[j]) for p in cloud) for j in range(3)] for i in range(3)]
    trace = sigma[0][0] + sigma[1][1] + sigma[2][2]
    return n, tuple(tuple(trace * (i == j) - sigma[i][j] for j in range(3)) for i in range(3))


def pseudo_inertia(mass: Fraction, com: list[Fraction], inertia: Matrix) -> Matrix:
    """[[Sigma + m c c^T, m c], [m c^T, m]], 4x4, of a body with inertia I about its centre of mass c."""
    sigma = second_moments(inertia)
    rows = [(*(sigma[i][j] + mass * com[i] * com[j] for j in range(3)), mass * com[i]) for i in range(3)]
    return (*rows, (*(mass * c for c in com), mass))


@given(st.lists(points, min_size=1, max_size=6))
def test_what_is_made_of_masses_is_possible_and_its_rank_is_that_of_the_points(
    cloud: list[tuple[int, int, int]],
) -> None:
    """A point has rank 0, points on a line 1, in a plane 2, else 3; NumPy's rank of small integers is exact."""
    mass, inertia = of_points(cloud)
    rank = np.linalg.matrix_rank(np.array(cloud) - np.array(cloud[0]))
    assert (
        shape_of(mass, rank_if_positive(second_moments(inertia)))
        == (Shape.POINT, Shape.ROD, Shape.PLATE, Shape.SOLID)[rank]
    )


@given(st.lists(points, min_size=1, max_size=6), st.tuples(*[st.integers(-9, 9)] * 6), points, st.integers(1, 9))
def test_the_pseudo_inertia_is_positive_where_the_second_moments_are(
    cloud: list[tuple[int, int, int]], moves: tuple[int, ...], com: tuple[int, int, int], mass: int
) -> None:
    """Wherever the centre of mass lies (Schur complement); and its rank is one higher."""
    _, possible = of_points(cloud)
    moved = symmetric({name: Fraction(x) for name, x in zip(ENTRIES, moves, strict=True)})
    near = tuple(tuple(x + y for x, y in zip(*rows, strict=True)) for rows in zip(possible, moved, strict=True))
    for inertia in (possible, near):
        whole = rank_if_positive(pseudo_inertia(Fraction(mass), [Fraction(c) for c in com], inertia))
        inner = rank_if_positive(second_moments(inertia))
        assert whole == (None if inner is None else inner + 1)
        assert (shape_of(Fraction(mass), inner) is Shape.IMPOSSIBLE) == (whole is None)


@pytest.mark.parametrize(
    ("mass", "tensor", "shape"),
    [(1, (2, 2, 2), "solid"), (-1, (2, 2, 2), "impossible"), (0, (2, 2, 2), "impossible"), (0, (0, 0, 0), "frame")],
)
def test_mass_and_inertia_belong_together(mass: int, tensor: tuple[int, ...], shape: str) -> None:
    assert look(arm(inertial(mass, diagonal(*tensor)))).links[1].shape == shape


@given(st.tuples(*[st.integers(-20, 20)] * 6))
def test_semidefinite_is_what_eigenvalues_say_away_from_the_boundary(entries: tuple[int, ...]) -> None:
    inertia = symmetric({name: Fraction(x) for name, x in zip(ENTRIES, entries, strict=True)})
    smallest = float(np.linalg.eigvalsh(np.array(inertia, dtype=float))[0])
    if abs(smallest) > MODEL * 60:
        assert (rank_if_positive(inertia) is not None) == (smallest > 0)


@pytest.mark.one_in(4)
@pytest.mark.parametrize("power", SCALES)
@pytest.mark.parametrize(
    ("tensor", "expected"),
    [
        ("2 0 0 3 0 4", []),
        ("1 0 0 2 0 3", ["P107"]),
        ("1 0 0 1 0 0", ["P107"]),
        ("1 0 0 1 0 2.00000000000000000000001", ["P106"]),
        ("1.000 0 0 1.000 0 2.0004", ["P106"]),
        ("1.000 0 0 1.000 0 2.01", ["P105"]),
        ("1 0 0 1 0 2.5", ["P105"]),
        ("1 2 0 1 0 1.5", ["P104"]),
        ("-1 0 0 1 0 1", ["P104"]),
        ("5 -0.1 0.2 4 -0.2 3", []),
    ],
)
def test_the_verdict_is_the_same_at_every_scale(tensor: str, expected: list[str], power: int) -> None:
    words = [word if word == "0" else f"{word}e{power}" for word in tensor.split()]
    assert ids(arm(inertial(1, words))) == expected


@pytest.mark.parametrize(
    "moments",
    [("0.1", "0.2", "0.3"), ("0.1", "0.7", "0.8"), ("1e-18", "2e-18", "3e-18"), ("123456.1", "0.2", "123456.3")],
)
def test_a_flat_plate_is_possible_whatever_floats_make_of_it(moments: tuple[str, str, str]) -> None:
    """0.1 + 0.7 < 0.8 in floating point; a digit far beyond floating point decides, on either side."""
    low, mid, high = (Fraction(moment) for moment in moments)
    bit = Fraction(1, 10**60)

    def shape(last: Fraction) -> Shape:
        text = arm(inertial(1, diagonal(text_of(low), text_of(mid), text_of(last))))
        return look(text).links[1].shape

    assert [shape(high - bit), shape(high), shape(high + bit)] == [Shape.SOLID, Shape.PLATE, Shape.IMPOSSIBLE]
    found = look(arm(inertial(1, diagonal(*moments)))).findings
    assert [(f.id, f.severity) for f in found] == [("P107", "note")]


def test_the_axes_of_the_inertial_frame_do_not_matter() -> None:
    plate, rod = diagonal("0.1", "0.2", "0.3"), diagonal("1", "1", "0")
    for tensor, shape in ((plate, Shape.PLATE), (rod, Shape.ROD)):
        result = look(arm(inertial(1, tensor, rpy="0.3 -1.2 2.9", xyz="1 -2 3")))
        assert result.links[1].shape is shape
        assert [found.id for found in result.findings] == ["P107"]


@given(st.lists(points, min_size=2, max_size=5), st.tuples(*[st.integers(-3, 3)] * 2), st.integers(5, 12))
@settings(max_examples=300)
def test_rounding_never_makes_a_plate_impossible(
    cloud: list[tuple[int, int, int]], slope: tuple[int, int], digits: int
) -> None:
    """A plate whose tensor was rounded is possible, or says that rounding is to blame and gives a tensor that is not."""
    flat = [(3 * x, 7 * y, slope[0] * x + slope[1] * y) for x, y, _ in cloud]
    inertia = tuple(tuple(entry * NO_TIES for entry in row) for row in of_points(flat)[1])
    if not any(any(row) for row in inertia):
        return
    at = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
    size = max(float(abs(inertia[i][i])) for i in range(3))
    places = digits - 1 - int(np.floor(np.log10(size)))
    exact = {name: inertia[i][j] for name, (i, j) in zip(ENTRIES, at, strict=True)}
    entries = {name: Number(f"{round(value * 10**places)}e{-places}") for name, value in exact.items()}
    written = symmetric({name: number.exact for name, number in entries.items()})
    if rank_if_positive(second_moments(written)) is None:
        mended = nearest_possible(UrdfInertial(Placement(), Number("1"), entries))
        assert mended is not None
        assert rank_if_positive(second_moments(symmetric(mended))) is not None
        trace = sum(abs(entries[name].exact) for name in ("ixx", "iyy", "izz"))
        assert all(
            abs(mended[name] - number.exact) <= max(number.half, trace / 10**15) for name, number in entries.items()
        )


def test_few_digits_are_no_excuse() -> None:
    """0.1, 0.1, 0.3 could be 0.14, 0.14, 0.26; nobody rounds so."""
    assert ids(arm(inertial(1, diagonal("0.1", "0.1", "0.3")))) == ["P105"]


@pytest.mark.parametrize("text", ["1", "-2.50", "1e-18", ".5", "12e3", "0.000", "1234567.125"])
def test_decimal_texts_are_exact(text: str) -> None:
    number = Number(text)
    assert float(number) == float(text)
    assert Fraction(text_of(number.exact)) == number.exact


@pytest.mark.parametrize(
    ("text", "half"),
    [
        ("1", "1/2"),
        ("-2.50", "1/200"),
        ("12e3", "500"),
        ("1e-3", "1/2000"),
        ("0.000", "1/2000"),
        ("0", "0"),
        ("0e3", "0"),
    ],
)
def test_half_a_unit_of_the_last_digit(text: str, half: str) -> None:
    assert Number(text).half == Fraction(half)


def test_a_zero_with_a_huge_exponent_is_a_zero() -> None:
    assert (Number("0e-999999999").exact, Number("0e-999999999").half) == (0, 0)
    assert ids(arm(inertial(1, ("1", "0e999999999", "0e-999999999", "1", "0", "1")))) == []


@pytest.mark.parametrize("rpy", ["0 0 0", "0.4 0.1 -0.7", "-2 1.2 0.3", "3 0.5 2", "1.5707963267948966 0 0"])
def test_ellipsoid_and_principal_axes_are_those_of_a_homogeneous_ellipsoid(rpy: str) -> None:
    """I_1 = m (b^2 + c^2) / 5, in the axes of a turned inertial frame; the axes are a rotation."""
    a, b, c, mass = 0.3, 0.2, 0.1, 2.0
    moments = [mass / 5 * (x * x + y * y) for x, y in ((b, c), (a, c), (a, b))]
    robot = rttrr_pin.load(arm(inertial(mass, diagonal(*moments), rpy=rpy)))
    row = inspect(robot).links[1]
    assert np.allclose(row.semi_axes, (a, b, c), rtol=MODEL)
    assert np.allclose(row.gyration**2 * mass, moments, rtol=MODEL)
    assert np.isclose(np.linalg.det(row.axes), 1.0)
    tensor = row.axes @ np.diag(row.moments) @ row.axes.T
    assert np.allclose(tensor, robot.model.links[0].inertia, rtol=0, atol=MODEL * moments[2])


@pytest.mark.parametrize("name", ["rttrr", "any-axes", "fixed-between"])
def test_mass_and_centre_of_mass_are_those_of_the_whole_robot(name: str) -> None:
    """Pinocchio adds up the same; it leaves the root out, which here has no mass."""
    robot = rttrr_pin.load(EXAMPLES.get(name, name))
    model = pinocchio.buildModelFromXML(robot.model.urdf)
    data = model.createData()
    com = pinocchio.centerOfMass(model, data, pinocchio.neutral(model))
    result = inspect(robot)
    assert np.linalg.norm(result.com - com) <= MODEL * np.linalg.norm(com)
    assert np.isclose(result.mass, data.mass[0])
