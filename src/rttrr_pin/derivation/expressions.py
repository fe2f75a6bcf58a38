"""Expressions of files of symbols, such as `-J_1xy` or `m*l**2/3`, read as polynomials; nothing is executed."""

from __future__ import annotations

import ast
from collections.abc import Collection
from decimal import Decimal
from fractions import Fraction

from rttrr_pin.derivation.symbols import Expression, factors_of
from rttrr_pin.errors import InputError

MOST_TERMS, LARGEST_POWER = 1000, 40
"""Terms of one expression, and a power in it: a number of a robot needs fewer."""


def read_expression(text: str, names: Collection[str]) -> Expression:
    """Read a sum of products of symbols and numbers.

    Args:
        text: names, numbers, + - * / ** and brackets; only numbers may divide.
        names: of the symbols.

    Raises:
        InputError: the text is no such expression, or has a name that is no symbol.
    """
    try:
        return _read(ast.parse(text.strip(), mode="eval").body, text.strip(), names)
    except InputError:  # a ValueError, and says more
        raise
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise InputError(f"{text!r} cannot be read: expected a sum of products of symbols and numbers") from error


def _read(node: ast.expr, text: str, names: Collection[str]) -> Expression:
    match node:
        case ast.Name(id=name):
            if name not in names:
                raise InputError(f"{text!r} has {name!r}, which is no symbol: declare it in [[symbol]]")
            return {((name, 1),): Fraction(1)}
        case ast.Constant(value=int() | float()) if not isinstance(node.value, bool):
            number = Fraction(Decimal(ast.get_source_segment(text, node) or ""))
            return {(): number} if number else {}
        case ast.UnaryOp(op=ast.USub() | ast.UAdd() as sign, operand=operand):
            return _scaled(_read(operand, text, names), Fraction(-1 if isinstance(sign, ast.USub) else 1))
        case ast.BinOp(op=ast.Add() | ast.Sub() as sign, left=left, right=right):
            other = _scaled(_read(right, text, names), Fraction(-1 if isinstance(sign, ast.Sub) else 1))
            return _sum(_read(left, text, names), other)
        case ast.BinOp(op=ast.Mult(), left=left, right=right):
            return _product(_read(left, text, names), _read(right, text, names))
        case ast.BinOp(op=ast.Div(), left=left, right=right):
            return _scaled(_read(left, text, names), 1 / _number(_read(right, text, names)))
        case ast.BinOp(op=ast.Pow(), left=left, right=ast.Constant(value=int(power))) if 0 <= power <= LARGEST_POWER:
            total: Expression = {(): Fraction(1)}
            for _ in range(power):
                total = _product(total, _read(left, text, names))
            return total
    raise ValueError("this is no sum of products")


def _number(x: Expression) -> Fraction:
    if set(x) != {()}:
        raise ValueError("only numbers other than 0 may divide")
    return x[()]


def _scaled(x: Expression, by: Fraction) -> Expression:
    return {factors: by * coefficient for factors, coefficient in x.items()}


def _sum(x: Expression, y: Expression) -> Expression:
    total = {factors: x.get(factors, Fraction(0)) + y.get(factors, Fraction(0)) for factors in (*x, *y)}
    return {factors: coefficient for factors, coefficient in total.items() if coefficient}


def _product(x: Expression, y: Expression) -> Expression:
    if len(x) * len(y) > MOST_TERMS:
        raise ValueError("too many terms")
    total: Expression = {}
    for one, a in x.items():
        for other, b in y.items():
            powers = dict(one)
            for name, power in other:
                powers[name] = powers.get(name, 0) + power
            total = _sum(total, {factors_of(powers): a * b})
    return total
