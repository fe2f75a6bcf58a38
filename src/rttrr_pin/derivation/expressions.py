"""Expressions of files of symbols, such as `-J_1xy` or `m*l**2/3`, read as polynomials; nothing is executed."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Collection, Mapping

from rttrr_pin.derivation.numbers import MOST_BITS, exact_number
from rttrr_pin.derivation.ring import Polynomial, Ring, bits
from rttrr_pin.derivation.symbols import Expression, Role, Symbol
from rttrr_pin.errors import InputError, shortened

MOST_TERMS, LARGEST_POWER, LARGEST_DEGREE = 1000, 40, 200
"""Terms of one expression, a power in it, and powers of all symbols: a number of a robot needs fewer."""


def read_expression(text: str, names: Collection[str]) -> Expression:
    """Read a sum of products of symbols and numbers.

    Args:
        text: names, numbers, + - * / ** and brackets; only numbers may divide.
        names: of the symbols.

    Raises:
        InputError: the text is no such expression, or has a name that is no symbol.
    """
    ring = Ring(Symbol(name, name, Role.UNKNOWN) for name in names)
    try:
        return ring.terms(_read(ast.parse(text.strip(), mode="eval").body, text.strip(), ring))
    except InputError:  # a ValueError, and says more
        raise
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise InputError(
            f"{shortened(text)!r} cannot be read: expected a sum of products of symbols and numbers"
        ) from error


def _read(node: ast.expr, text: str, ring: Ring) -> Polynomial:
    match node:
        case ast.Name(id=name):
            if name not in ring:
                raise InputError(
                    f"{shortened(text)!r} has {shortened(name)!r}, which is no symbol: declare it in [[symbol]]"
                )
            return ring[name]
        case ast.Constant(value=int() | float()) if not isinstance(node.value, bool):
            return ring.lift(exact_number(ast.get_source_segment(text, node) or ""))
        case ast.UnaryOp(op=ast.USub() | ast.UAdd() as sign, operand=operand):
            x = _read(operand, text, ring)
            return -x if isinstance(sign, ast.USub) else x
        case ast.BinOp(op=sign, left=left, right=right) if type(sign) in OPERATIONS:
            return OPERATIONS[type(sign)](_read(left, text, ring), _read(right, text, ring))
        case ast.BinOp(op=ast.Pow(), left=left, right=ast.Constant(value=int(power))) if 0 <= power <= LARGEST_POWER:
            base, total = _read(left, text, ring), ring.lift(1)
            for _ in range(power):
                total = _product(total, base)
            return total
    raise ValueError("this is no sum of products")


def _product(x: Polynomial, y: Polynomial) -> Polynomial:
    if len(x) * len(y) > MOST_TERMS:
        raise ValueError("too many terms")
    if sum(x.degrees()) + sum(y.degrees()) > LARGEST_DEGREE or bits(x) + bits(y) > MOST_BITS:
        raise ValueError("too large a power or number")
    return x * y


def _quotient(x: Polynomial, y: Polynomial) -> Polynomial:
    if not y or not y.is_constant():
        raise ValueError("only numbers other than 0 may divide")
    return x / y


OPERATIONS: Mapping[type[ast.operator], Callable[[Polynomial, Polynomial], Polynomial]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: _product,
    ast.Div: _quotient,
}
