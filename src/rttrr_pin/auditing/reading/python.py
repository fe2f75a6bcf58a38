"""From an expression of Python code to its terms, as the LaTeX reader gives them; nothing is executed."""

from __future__ import annotations

import ast
import warnings
from collections.abc import Iterator, Mapping
from decimal import Decimal
from fractions import Fraction
from itertools import accumulate

from rttrr_pin.auditing.printed import PrintedComponent
from rttrr_pin.auditing.reading.grammar import UnreadableError
from rttrr_pin.auditing.reading.multiply import constant, terms_of
from rttrr_pin.auditing.reading.nodes import LARGEST_POWER, Factor, Group, Named, Product
from rttrr_pin.auditing.reading.vocabulary import angle_of, index_of, unclashing
from rttrr_pin.errors import InputError

FUNCTIONS = {"cos": "c", "sin": "s"}
"""Functions of an angle, and what the names of their values begin with."""

SymbolNode = ast.Name | ast.Attribute | ast.Subscript


def read_python(text: str, names: Mapping[str, str]) -> PrintedComponent:
    """Reads an expression such as `-m2*l1*l2*sin(q2)*qd1**2 + m2*g*l2*cos(q1 + q2)`.

    Args:
        text: sums of products of variables, numbers, brackets, whole powers and sines and cosines (`sin`, `np.sin`,
            `math.sin`, ...) of coordinates and sums of coordinates; numbers may divide. One assignment may hold it.
        names: of symbols, by variable: `{"q2": "q_2", "qd[0]": "v_1", "self.m2": "M_2"}`. A variable that it lacks is
            kept under a name of its own and stands in `Reading.unknown`.

    Returns:
        The terms, brackets expanded, each with one reading; decimals are exact. Where it cannot be read,
        `PrintedComponent.unparsed` says where and why.

    Raises:
        InputError: a key of `names` is no variable.
    """
    printed = " ".join(text.split())
    source = _Source(text, {_variable(key): name for key, name in names.items()})
    try:
        return PrintedComponent(printed, terms_of(source.products(source.expression()), text, _one_way))
    except UnreadableError as error:
        return PrintedComponent(printed, (), error.placed(text))
    except (RecursionError, MemoryError):
        fault = UnreadableError("too many brackets in each other, or terms, for Python's parser; split the sum", 0)
        return PrintedComponent(printed, (), fault.placed(text))


def _variable(key: str) -> str:
    try:
        node = ast.parse(key, mode="eval").body
    except (SyntaxError, ValueError) as error:
        raise InputError(
            f"{key!r} is no variable of Python; wanted a name such as 'm2', 'q[0]' or 'self.m2'"
        ) from error
    if not isinstance(node, SymbolNode):
        raise InputError(f"{key!r} is an expression; wanted one variable such as 'm2', 'q[0]' or 'self.m2'")
    return ast.unparse(node)


def _one_way(factors: tuple[Factor, ...]) -> list[tuple[tuple[Factor, ...], str]]:
    """Code leaves nothing open."""
    return [(factors, "")]


class _Source:
    """Reads one text: `ast` counts its places in lines and bytes, messages in characters of the text."""

    def __init__(self, text: str, known: Mapping[str, str]) -> None:
        self.text, self.known = text, known
        self.offset = len(text) - len(text.lstrip())
        self.code = text[self.offset :]
        if "#" not in self.code:  # a comment ends with its line; without one, a sum may be broken anywhere
            self.code = self.code.replace("\\\n", "  ").replace("\n", " ").replace("\r", " ").replace("\f", " ")
        lines = self.code.splitlines(keepends=True) or [""]
        self.starts = list(accumulate(map(len, lines[:-1]), initial=self.offset))
        self.lines = [line.encode() for line in lines]

    def _character(self, line: int, column: int) -> int:
        return self.starts[line - 1] + len(self.lines[line - 1][:column].decode(errors="ignore"))

    def _start(self, node: ast.expr) -> int:
        return self._character(node.lineno, node.col_offset)

    def _end(self, node: ast.expr) -> int:
        return self._character(node.end_lineno or 1, node.end_col_offset or 0)

    def _fault(self, message: str, node: ast.expr) -> UnreadableError:
        return UnreadableError(message, self._start(node))

    def expression(self) -> ast.expr:
        """The tree of the expression, or of the right-hand side of one assignment."""
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                body = ast.parse(self.code).body
        except SyntaxError as error:
            line = min(max(error.lineno or 1, 1), len(self.starts))
            start = min(self.starts[line - 1] + max((error.offset or 1) - 1, 0), len(self.text))
            raise UnreadableError(f"Python cannot parse this ({error.msg}); wanted one expression", start) from error
        except ValueError as error:
            raise UnreadableError(f"Python cannot parse this ({error}); wanted one expression", 0) from error
        statement = body[0] if len(body) == 1 else None
        value = statement.value if isinstance(statement, ast.Expr | ast.Assign | ast.AnnAssign) else None
        if value is None:
            raise UnreadableError("wanted one expression, or one assignment of it", self.offset)
        return value

    def products(self, node: ast.expr) -> tuple[Product, ...]:
        """The products of a sum. Sums and products nest to the left, so that a long one is no deep recursion."""
        parts: list[tuple[int, ast.expr, int]] = []
        while isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
            operator = self._end(node.left)
            while self.text[operator : operator + 1] not in ("+", "-"):  # brackets and blanks may stand before it
                operator += 1
            parts.append((1 if isinstance(node.op, ast.Add) else -1, node.right, operator))
            node = node.left
        parts.append((1, node, self._start(node)))
        return tuple(self._product(*part) for part in reversed(parts))

    def _product(self, sign: int, node: ast.expr, start: int) -> Product:
        end = self._end(node)
        while self.text.count("(", start, end) > self.text.count(")", start, end) and end < len(self.text):
            end += 1
        return Product(((sign,),), tuple(self._factors(node, 1)), start, end)

    def _factors(self, node: ast.expr, power: int) -> Iterator[Factor]:
        """The factors of a product that stands to a power."""
        divided: list[tuple[ast.expr, bool]] = []
        while isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div):
            divided.append((node.right, isinstance(node.op, ast.Div)))
            node = node.left
        yield from self._factor(node, power)
        for factor, divides in reversed(divided):
            if divides:
                start, end = self._start(factor), self._end(factor)
                yield Factor(Group(self.products(factor), start, end), start, power, operator="/")
            else:
                yield from self._factors(factor, power)

    def _factor(self, node: ast.expr, power: int) -> Iterator[Factor]:
        start = self._start(node)
        match node:
            case ast.UnaryOp(op=ast.USub() | ast.UAdd() as op, operand=operand):
                yield Factor(Fraction(-1 if isinstance(op, ast.USub) else 1), start, power)
                yield from self._factors(operand, power)
            case ast.Constant():
                yield Factor(self._number(node), start, power)
            case ast.BinOp(op=ast.Add() | ast.Sub()):
                yield Factor(Group(self.products(node), start, self._end(node)), start, power)
            case ast.BinOp(op=ast.Pow(), left=base, right=exponent):
                yield from self._factors(base, self._power(exponent, power))
            case ast.Call():
                yield Factor(Named(self._angle(node)), start, power)
            case ast.Name() | ast.Attribute() | ast.Subscript():
                yield Factor(self._symbol(ast.unparse(node)), start, power)
            case _:
                message = "this is no sum of products of variables, numbers, sines and cosines; write it out"
                raise self._fault(message, node)

    def _number(self, node: ast.Constant) -> Fraction:
        if type(node.value) is int:
            return Fraction(node.value)
        if type(node.value) is not float:
            raise self._fault(f"wanted a real number, got {node.value!r}", node)
        decimal = Decimal(self.text[self._start(node) : self._end(node)])  # as written: 0.1 is a tenth
        if abs(decimal.adjusted()) > LARGEST_POWER:
            raise self._fault("this is no number that can be meant", node)
        return Fraction(decimal)

    def _power(self, exponent: ast.expr, outer: int) -> int:
        terms = terms_of(self.products(exponent), self.text, _one_way)
        power = outer * constant(terms, "only numbers may be powers", self._start(exponent))
        if power.denominator != 1 or not 0 <= power <= LARGEST_POWER:
            raise self._fault(f"wanted a whole power from 0 to {LARGEST_POWER}, got {power}", exponent)
        return int(power)

    def _angle(self, node: ast.Call) -> str:
        called = node.func.attr if isinstance(node.func, ast.Attribute) else ast.unparse(node.func)
        if called not in FUNCTIONS or len(node.args) != 1 or node.keywords:
            raise self._fault("the only functions are sin and cos of one angle; write it out", node)
        argument = node.args[0]
        indices: list[int | None] = []
        while isinstance(argument, ast.BinOp) and isinstance(argument.op, ast.Add):
            indices.append(self._coordinate(argument.right))
            argument = argument.left
        indices.append(self._coordinate(argument))
        return angle_of(FUNCTIONS[called], indices, self._start(node.args[0]))

    def _coordinate(self, node: ast.expr) -> int | None:
        return index_of(self.known.get(ast.unparse(node), "")) if isinstance(node, SymbolNode) else None

    def _symbol(self, variable: str) -> Named:
        if variable in self.known:
            return Named(self.known[variable])
        plain = "".join(character if character.isalnum() else "_" for character in variable).strip("_") or "_"
        return Named(unclashing(plain, set(self.known.values())), variable)
