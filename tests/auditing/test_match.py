"""Errors of terms, forms of sums, and the pairing of printed with derived terms."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction

import numpy as np
import pytest

from rttrr_pin.auditing import Kind
from rttrr_pin.auditing.differences import LIMIT, WEIGHT, between_factors, between_numbers
from rttrr_pin.auditing.match import match
from rttrr_pin.auditing.normalise import Normalised, folded, in_printed_form
from rttrr_pin.auditing.printed import PrintedComponent, PrintedTerm, Reading
from rttrr_pin.derivation.symbols import Role, Symbol, expression_of, factors_of

SYMBOLS = {
    name: Symbol(name, name, role, index=index)
    for name, role, index in (
        *((f"{letter}_{k}", role, k) for letter, role in zip("qva", (Role.COORDINATE, Role.RATE, Role.ACCELERATION), strict=True) for k in (1, 2)),
        *((f"{letter}_{k}", role, k) for letter, role in zip("cs", (Role.COSINE, Role.SINE), strict=True) for k in (1, 2)),
        *((name, Role.PARAMETER, 0) for name in "mlrxyz"),
    )
}  # fmt: skip


def product(text: str):
    powers = Counter(text.split())
    return factors_of(dict(powers))


def printed(*terms) -> list[PrintedTerm]:
    return [PrintedTerm("", (Reading(Fraction(x), product(text)),)) for x, text in terms]


def terms(*terms):
    return expression_of((Fraction(x), product(text)) for x, text in terms)


def paired(text, derived):
    return match(Normalised(PrintedComponent("", tuple(text)), derived, SYMBOLS), {}).pairs


@pytest.mark.parametrize(
    ("wrong", "right", "kinds"),
    [
        ("m l v_1", "m l a_1", (Kind.RATE,)),
        ("m l q_1", "m l v_1", (Kind.RATE,)),
        ("m r a_2 a_2", "m r v_2 v_2", (Kind.RATE,)),
        ("m r v_1", "m r v_1 v_1", (Kind.RATE,)),
        ("m r v_1 v_1", "m r v_1 v_2", (Kind.SYMBOL,)),
        ("m r v_1 v_1", "m r v_2 v_2", (Kind.SYMBOL,)),
        ("m r s_1 s_1", "m r c_1 c_1", (Kind.SYMBOL,)),
        ("m l a_1", "m r a_1", (Kind.SYMBOL,)),
        ("m l v_1", "m r a_1", (Kind.RATE, Kind.SYMBOL)),
        ("m l", "m l c_1", (Kind.SYMBOL,)),
        ("m l", "m l", ()),
    ],
)
def test_one_error_in_a_product(wrong, right, kinds) -> None:
    found = between_factors(product(wrong), product(right), SYMBOLS)
    assert found is not None and found[0] == kinds
    assert (found[1] == 0) == (not kinds)


def test_products_with_nothing_in_common_are_no_error() -> None:
    assert between_factors(product("m l a_1"), product("r x y z v_2"), SYMBOLS) is None


@pytest.mark.parametrize(
    ("wrong", "right", "kinds"),
    [(1, 1, ()), (-1, 1, ("sign",)), (2, 1, ("coefficient",)), (-2, 1, ("sign", "coefficient"))],
)
def test_errors_in_a_number(wrong, right, kinds) -> None:
    assert between_numbers(Fraction(wrong), Fraction(right))[0] == kinds


def test_a_pairing_never_weighs_more_than_all_in_excess_and_all_missing() -> None:
    rng = np.random.default_rng(0)
    names = list(SYMBOLS)
    for _ in range(100):
        some = lambda: [
            (int(rng.integers(1, 4)), " ".join(rng.choice(names, 3))) for _ in range(int(rng.integers(1, 6)))
        ]
        text, right = printed(*some()), terms(*some())
        pairs = paired(text, right)
        assert sorted(pair.position for pair in pairs if pair.position is not None) == list(range(len(text)))
        assert sum(pair.weight for pair in pairs) <= LIMIT / 2 * (len(text) + len(right)) + 1e-9
        assert expression_of(pair.derived for pair in pairs if pair.derived) == right


def test_a_copy_is_a_duplicate_and_the_second_one_is_too_many() -> None:
    pairs = paired(printed((1, "m l"), (2, "r x"), (1, "m l")), terms((1, "m l"), (2, "r x")))
    assert [(pair.position, pair.kinds) for pair in pairs] == [(0, ()), (1, ()), (2, (Kind.DUPLICATE,))]


def test_parts_of_a_coefficient_add_up() -> None:
    pairs = paired(printed((1, "m l"), (1, "m l")), terms((2, "m l")))
    assert all(not pair.kinds for pair in pairs)


def test_a_part_of_a_coefficient_may_be_printed_wrongly() -> None:
    pairs = paired(printed((1, "m l v_1"), (1, "m l q_1")), terms((2, "m l v_1")))
    assert [pair.kinds for pair in pairs] == [(), (Kind.RATE,)]


def test_of_two_readings_the_nearer_one_is_taken() -> None:
    two = PrintedTerm(
        "", (Reading(Fraction(1), product("m v_1 v_1 v_1")), Reading(Fraction(1), product("m r v_1"), "note"))
    )
    (pair,) = paired([two], terms((1, "m r v_1")))
    assert pair.kinds == () and pair.reading is not None and pair.reading.note == "note"


def test_weights_say_how_errors_happen() -> None:
    """One error is likelier than a term in excess and another missing; a copy likelier than two errors in one term."""
    assert max(WEIGHT[kind] for kind in (Kind.RATE, Kind.SIGN, Kind.COEFFICIENT, Kind.SYMBOL)) < LIMIT / 2
    assert WEIGHT[Kind.DUPLICATE] + WEIGHT[Kind.MISSING] < 2 * WEIGHT[Kind.RATE]


@pytest.mark.parametrize("text", [((-1, "m s_1 s_1"),), ((1, "m c_1 c_1"), (-1, "m c_1 c_1"), (-1, "m s_1 s_1"))])
def test_the_form_of_squares_is_the_text_s(text) -> None:
    right = terms((1, "m c_1 c_1"), (-1, "m"))
    form = in_printed_form(right, printed(*text), ["1", "2"])
    assert all(not pair.kinds for pair in paired(printed(*text), form)[:1])
    assert form == terms((-1, "m s_1 s_1"))


def test_sums_of_angles_are_folded() -> None:
    right = terms((2, "m c_1 c_2"), (-2, "m s_1 s_2"), (1, "l s_1 c_2"), (1, "l c_1 s_2"), (1, "r c_1 c_2"))
    assert folded(right, ["1_2"]) == terms((2, "m c_1_2"), (1, "l s_1_2"), (1, "r c_1 c_2"))
