"""From an expression of Python code to its terms, as the LaTeX reader gives them; nothing is executed."""

from __future__ import annotations

import ast
import warnings
from collections.abc import Iterator, Mapping
from fractions import Fraction
from itertools import accumulate

from rttrr_pin.auditing.printed import PrintedComponent
from rttrr_pin.auditing.reading.angles import PI, angle_in, angle_of
from rttrr_pin.auditing.reading.component import check_length, printed_component
from rttrr_pin.auditing.reading.grammar import UnreadableError
from rttrr_pin.auditing.reading.multiply import constant, terms_of
from rttrr_pin.auditing.reading.nodes import LARGEST_POWER, Factor, Group, Named, Product
from rttrr_pin.auditing.reading.vocabulary import index_of, unclashing
from rttrr_pin.derivation.numbers import exact_number
from rttrr_pin.derivation.ring import nearest
from rttrr_pin.errors import InputError, shortened

Abbreviations = Mapping[str, Group]
"""By variable."""

FUNCTIONS = {"cos": "c", "sin": "s"}
"""Functions of an angle, and what the names of their values begin with."""

CIRCLES = ("pi", "PI", "M_PI")
"""Variables, also of a module, that are pi where they are no symbols of the text."""

RADIANS = ("radians", "deg2rad")
"""Functions of an angle in degrees."""

SymbolNode = ast.Name | ast.Attribute | ast.Subscript


def read_python(text: str, names: Mapping[str, str], abbreviations: Abbreviations | None = None) -> PrintedComponent:
    """Reads an expression such as `-m2*l1*l2*sin(q2)*qd1**2 + m2*g*l2*cos(q1 + q2)`.

    Args:
        text: sums of products of variables, numbers, brackets, whole powers and sines and cosines (`sin`, `np.sin`,
            `math.sin`, ...) of coordinates and sums of coordinates; numbers may divide. One assignment may hold it.
        names: of symbols, by variable: `{"q2": "q_2", "qd[0]": "v_1", "self.m2": "M_2"}`. A variable that it lacks is
            kept under a name of its own and stands in `Reading.unknown`.
        abbreviations: what variables stand for that other equations define.

    Returns:
        The terms, brackets expanded, each with one reading; decimals are exact. Where it cannot be read,
        `PrintedComponent.unparsed` says where and why.

    Raises:
        InputError: a key of `names` is no variable.
    """
    source = _Source(text, {_variable(key): name for key, name in names.items()}, abbreviations or {})
    return printed_component(lambda: source.products(source.expression()), text, text, _one_way)


def defined_in_python(text: str, abbreviations: Abbreviations, names: Mapping[str, str]) -> tuple[str, Group] | None:
    """The variable that an assignment defines, with what it stands for; None where it is no such assignment."""
    source = _Source(text, {_variable(key): name for key, name in names.items()}, abbreviations)
    try:
        check_length(text)
        match ast.parse(source.code).body:
            case [ast.Assign(targets=[ast.Name() | ast.Attribute() | ast.Subscript() as target], value=value)]:
                variable = ast.unparse(target)
                group = Group(source.products(value), 0, 0, abbreviated=variable, text=text)
                return None if variable in source.known else (variable, group)
    except (UnreadableError, SyntaxError, ValueError, RecursionError, MemoryError):
        pass
    return None


def _variable(key: str) -> str:
    try:
        node = ast.parse(key, mode="eval").body
        if isinstance(node, SymbolNode):
            return ast.unparse(node)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise InputError(
            f"{shortened(key)!r} is no variable of Python; wanted a name such as 'm2', 'q[0]' or 'self.m2'"
        ) from error
    raise InputError(f"{shortened(key)!r} is an expression; wanted one variable such as 'm2', 'q[0]' or 'self.m2'")


def _one_way(factors: tuple[Factor, ...]) -> list[tuple[tuple[Factor, ...], str]]:
    """Code leaves nothing open."""
    return [(factors, "")]


def _coordinate(factor: Factor) -> int | None:
    """Of a variable that is one its index, or what stands for pi."""
    if not isinstance(factor.body, Named):
        return None
    return PI if factor.body.unknown.rpartition(".")[2] in CIRCLES else index_of(factor.body.name)


def _called(node: ast.Call) -> str:
    """The name of a function without its module."""
    return node.func.attr if isinstance(node.func, ast.Attribute) else ast.unparse(node.func)


class _Source:
    """Reads one text: `ast` counts its places in lines and bytes, messages in characters of the text."""

    def __init__(self, text: str, known: Mapping[str, str], abbreviations: Abbreviations) -> None:
        self.text, self.known, self.abbreviations = text, known, abbreviations
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
            case ast.Call(func=called, args=[ast.Name("t")], keywords=[]) if ast.unparse(called) in self.known:
                yield Factor(self._symbol(ast.unparse(called)), start, power)  # q1(t)
            case ast.Call(args=[degrees], keywords=[]) if _called(node) in RADIANS:
                yield Factor(Fraction(1, 180), start, power)
                yield Factor(Named("pi", "pi"), start, power)
                yield Factor(Group(self.products(degrees), start, self._end(node)), start, power)
            case ast.Call():
                yield Factor(self._angle(node), start, power)
            case ast.Name() | ast.Attribute() | ast.Subscript():
                variable = ast.unparse(node)
                yield Factor(self.abbreviations.get(variable) or self._symbol(variable), start, power)
            case _:
                message = "this is no sum of products of variables, numbers, sines and cosines; write it out"
                raise self._fault(message, node)

    def _number(self, node: ast.Constant) -> Fraction:
        if type(node.value) not in (int, float):
            raise self._fault(f"wanted a real number, got {type(node.value).__name__}", node)
        try:
            return exact_number(self.text[self._start(node) : self._end(node)])
        except ValueError as error:
            raise self._fault(f"this is no number that can be meant: {error}", node) from error

    def _power(self, exponent: ast.expr, outer: int) -> int:
        terms = terms_of(self.products(exponent), self.text, _one_way)
        number = constant(terms)
        if number is None:
            raise self._fault("only numbers may be powers", exponent)
        power = outer * number
        if power.denominator != 1 or not 0 <= power <= LARGEST_POWER:
            raise self._fault(f"wanted a whole power from 0 to {LARGEST_POWER}, got {nearest(power):g}", exponent)
        return int(power)

    def _angle(self, node: ast.Call) -> Named | Fraction:
        called = _called(node)
        if called not in FUNCTIONS or len(node.args) != 1 or node.keywords:
            raise self._fault("the only functions are sin and cos of one angle; write it out", node)
        angle = angle_in(self.products(node.args[0]), _coordinate)
        return angle_of(FUNCTIONS[called], angle, self._start(node.args[0]))

    def _symbol(self, variable: str) -> Named:
        if variable in self.known:
            return Named(self.known[variable])
        plain = "".join(character if character.isalnum() else "_" for character in variable).strip("_") or "_"
        return Named(unclashing(plain, set(self.known.values())), variable)
