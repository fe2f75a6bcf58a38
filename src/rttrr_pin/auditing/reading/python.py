"""From an expression of Python code to its terms, as the LaTeX reader gives them; nothing is executed."""

from __future__ import annotations

import ast
import warnings
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction

from rttrr_pin.auditing.printed import PrintedComponent, Reading
from rttrr_pin.auditing.reading.expansion import Bracket, Terms, expanded
from rttrr_pin.auditing.reading.grammar import UnreadableError
from rttrr_pin.auditing.reading.products import LARGEST_POWER
from rttrr_pin.auditing.reading.vocabulary import angle_name, index_of, unclashing
from rttrr_pin.derivation.symbols import factors_of
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
    known = {_variable(key): name for key, name in names.items()}
    try:
        tree, places = _parsed(text)
        expression = _Expression(text, places, known)
        return PrintedComponent(printed, expression.terms(tree))
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


@dataclass(frozen=True, slots=True)
class _Places:
    """Characters of the text by the lines and bytes that `ast` counts in."""

    lines: tuple[bytes, ...]
    starts: tuple[int, ...]

    @classmethod
    def of(cls, source: str, offset: int) -> _Places:
        lines = source.splitlines(keepends=True) or [""]
        starts = [offset]
        for line in lines[:-1]:
            starts.append(starts[-1] + len(line))
        return cls(tuple(line.encode() for line in lines), tuple(starts))

    def character(self, line: int, column: int) -> int:
        return self.starts[line - 1] + len(self.lines[line - 1][:column].decode(errors="ignore"))

    def start(self, node: ast.expr) -> int:
        return self.character(node.lineno, node.col_offset)

    def end(self, node: ast.expr) -> int:
        return self.character(node.end_lineno or 1, node.end_col_offset or 0)


def _parsed(text: str) -> tuple[ast.expr, _Places]:
    """The tree of the expression, or of the right-hand side of one assignment."""
    offset = len(text) - len(text.lstrip())
    source = text[offset:]
    if "#" not in source:
        source = source.replace("\\\n", "  ").replace("\n", " ").replace("\r", " ").replace("\f", " ")
    places = _Places.of(source, offset)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            body = ast.parse(source).body
    except SyntaxError as error:
        line = min(max(error.lineno or 1, 1), len(places.starts))
        message = f"Python cannot parse this ({error.msg}); wanted one expression"
        raise UnreadableError(
            message, min(places.starts[line - 1] + max((error.offset or 1) - 1, 0), len(text))
        ) from error
    except ValueError as error:
        raise UnreadableError(f"Python cannot parse this ({error}); wanted one expression", 0) from error
    statement = body[0] if len(body) == 1 else None
    value = statement.value if isinstance(statement, ast.Expr | ast.Assign | ast.AnnAssign) else None
    if value is None:
        raise UnreadableError("wanted one expression, or one assignment of it", offset)
    return value, places


@dataclass(frozen=True, slots=True)
class _Expression:
    """Reads the nodes of one text."""

    text: str
    places: _Places
    known: Mapping[str, str]

    def terms(self, node: ast.expr) -> Terms:
        """The terms of a sum."""
        parts: list[tuple[int, ast.expr, int]] = []
        while isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
            sign = 1 if isinstance(node.op, ast.Add) else -1
            parts.append((sign, node.right, self._operator(node)))
            node = node.left
        parts.append((1, node, self.places.start(node)))
        return tuple(term for sign, part, start in reversed(parts) for term in self._product(sign, part, start))

    def _operator(self, node: ast.BinOp) -> int:
        """Where the + or - of a sum stands: only brackets and blanks are beside it."""
        place = self.places.end(node.left)
        while self.text[place : place + 1] not in ("+", "-"):
            place += 1
        return place

    def _product(self, sign: int, node: ast.expr, start: int) -> Terms:
        product = _Product(self, Fraction(sign))
        product.multiply(node, 1)
        end = self.places.end(node)
        shown = self.text[start:end]
        while shown.count("(") > shown.count(")") and end < len(self.text):
            end += 1
            shown = self.text[start:end]
        reading = Reading(
            product.coefficient, factors_of(product.exponents), unknown=tuple(dict.fromkeys(product.unknown))
        )
        return expanded(self.text, start, end, [[reading]], product.brackets)

    def fault(self, message: str, node: ast.expr) -> UnreadableError:
        """An error at a node."""
        return UnreadableError(message, self.places.start(node))

    def constant(self, node: ast.expr, what: str) -> Fraction:
        """The value of an expression of numbers."""
        terms = self.terms(node)
        if any(term.readings[0].factors for term in terms):
            raise self.fault(f"only numbers may {what}", node)
        return sum((term.readings[0].coefficient for term in terms), Fraction(0))

    def index(self, node: ast.expr) -> int | None:
        """The index of the coordinate that a variable is."""
        return index_of(self.known.get(ast.unparse(node), "")) if isinstance(node, SymbolNode) else None

    def angle(self, node: ast.Call) -> str:
        """The name of a sine or cosine."""
        called = node.func.attr if isinstance(node.func, ast.Attribute) else ast.unparse(node.func)
        if called not in FUNCTIONS or len(node.args) != 1 or node.keywords:
            raise self.fault("the only functions are sin and cos of one angle; write it out", node)
        argument = node.args[0]
        indices: list[int | None] = []
        while isinstance(argument, ast.BinOp) and isinstance(argument.op, ast.Add):
            indices.append(self.index(argument.right))
            argument = argument.left
        indices.append(self.index(argument))
        known = {index for index in indices if index is not None}
        if len(known) < len(indices):
            raise self.fault("the angle is wanted as a coordinate or a sum of coordinates", node.args[0])
        return angle_name(FUNCTIONS[called], known)


@dataclass(slots=True)
class _Product:
    """A product as far as it has been read."""

    expression: _Expression
    coefficient: Fraction
    exponents: Counter[str] = field(default_factory=Counter)
    unknown: list[str] = field(default_factory=list)
    brackets: list[Bracket] = field(default_factory=list)

    def multiply(self, node: ast.expr, power: int) -> None:
        """Takes a node in as a factor, to a power."""
        factors: list[tuple[ast.expr, bool]] = []
        while isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div):
            factors.append((node.right, isinstance(node.op, ast.Div)))
            node = node.left
        self._factor(node, power)
        for factor, divides in reversed(factors):
            if divides:
                self._number(self.expression.constant(factor, "divide"), -power, factor)
            else:
                self.multiply(factor, power)

    def _factor(self, node: ast.expr, power: int) -> None:
        match node:
            case ast.UnaryOp(op=ast.USub() | ast.UAdd() as op, operand=operand):
                self.coefficient *= (-1) ** power if isinstance(op, ast.USub) else 1
                self.multiply(operand, power)
            case ast.Constant():
                self._number(self._value(node), power, node)
            case ast.BinOp(op=ast.Add() | ast.Sub()):
                places = self.expression.places
                bracket = Bracket(self.expression.terms(node), places.start(node), places.end(node))
                self.brackets += [bracket] * power
            case ast.BinOp(op=ast.Pow(), left=base, right=exponent):
                self.multiply(base, self._checked(power * self._power(exponent), exponent))
            case ast.Call():
                self.exponents[self.expression.angle(node)] += power
            case ast.Name() | ast.Attribute() | ast.Subscript():
                self._symbol(ast.unparse(node), power)
            case _:
                message = "this is no sum of products of variables, numbers, sines and cosines; write it out"
                raise self.expression.fault(message, node)

    def _number(self, value: Fraction, power: int, node: ast.expr) -> None:
        if abs(power) > LARGEST_POWER or (value == 0 and power < 0):
            raise self.expression.fault(f"this is no number that can be meant: {value} to the power {power}", node)
        self.coefficient *= value**power

    def _value(self, node: ast.Constant) -> Fraction:
        if type(node.value) is int:
            return Fraction(node.value)
        if type(node.value) is not float:
            raise self.expression.fault(f"wanted a real number, got {node.value!r}", node)
        places = self.expression.places
        decimal = Decimal(self.expression.text[places.start(node) : places.end(node)])
        if abs(decimal.adjusted()) > LARGEST_POWER:
            raise self.expression.fault("this is no number that can be meant", node)
        return Fraction(decimal)

    def _power(self, node: ast.expr) -> int:
        return self._checked(self.expression.constant(node, "be powers"), node)

    def _checked(self, power: Fraction | int, node: ast.expr) -> int:
        if power.denominator != 1 or not 0 <= power <= LARGEST_POWER:
            raise self.expression.fault(f"wanted a whole power from 0 to {LARGEST_POWER}, got {power}", node)
        return int(power)

    def _symbol(self, variable: str, power: int) -> None:
        name = self.expression.known.get(variable)
        if name is None:
            self.unknown.append(variable)
            plain = "".join(character if character.isalnum() else "_" for character in variable).strip("_") or "_"
            name = unclashing(plain, set(self.expression.known.values()))
        self.exponents[name] += power
