"""Errors that people make when they write a recursion down, as operators on the nodes of its syntax tree.

A term dropped, a sign flipped, a rotation for its transpose, the operands of a cross product exchanged, r_C for p, the
2 of Coriolis forgotten, a force for a moment. `rewritten` makes any number of them in one function.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

LEVERS = {"p": "r_C", "r_C": "p", "joint.p": "body.r_C", "body.p": "body.r_C", "body.r_C": "joint.p"}
"""The lever of the joint, and that of the centre of mass: one is taken for the other."""

GUARDS = ("payload.link", "i")
"""What tells the link in a function that goes through all of them, in the order in which a statement is asked."""


@dataclass(frozen=True, slots=True)
class Error:
    """One error at a node.

    Attributes:
        operator: what was done, in words.
        expression: what it was done to.
        text: what stands in the place of the node then.
        line: of the expression, from the first one of the function.
        term: of a sum, which term it is about.
    """

    operator: str
    expression: str
    text: str
    line: int
    term: int | None = None


Errors = Callable[[ast.AST, str, bool], Iterator[Error]]
"""All errors at a node, of a function of that name; a sum inside of a longer sum has none of its own."""


class Edit(Protocol):
    """An error, by the place it has in a function and among the errors there.

    Attributes:
        node: index of the node, as `ast.walk` goes.
        choice: which of the errors there.
        link: index of the only link that has it; None for all.
    """

    @property
    def node(self) -> int: ...  # noqa: D102
    @property
    def choice(self) -> int: ...  # noqa: D102
    @property
    def link(self) -> int | None: ...  # noqa: D102


def errors(node: ast.AST, function: str, inner: bool) -> Iterator[Error]:
    """The errors that people make at a node."""
    if isinstance(node, ast.BinOp):
        yield from _of_operation(node, inner)
        return
    line = getattr(node, "lineno", 0)
    if isinstance(node, ast.AugAssign) and isinstance(node.op, ast.Add):
        yield Error("drop", ast.unparse(node), "pass", line)
        yield Error("negate", ast.unparse(node), f"{ast.unparse(node.target)} -= {ast.unparse(node.value)}", line)
    elif (operands := cross_product(node)) is not None:
        a, b = operands
        yield Error("exchange operands of", ast.unparse(node), f"({ast.unparse(b)}).cross({ast.unparse(a)})", line)
        if cross_product(b) is not None:
            yield Error("keep the last of", ast.unparse(node), f"({ast.unparse(b)})", line)
    elif isinstance(node, ast.keyword) and node.arg in ("w", "w_dot", "v", "v_dot"):
        value = ast.unparse(node.value)
        yield Error("negate", f"{node.arg}={value}", f"-({value})", line)
        yield Error("drop", f"{node.arg}={value}", "Vector(0, 0, 0)", line)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        x = ast.unparse(node.operand)
        yield Error("drop the sign of", ast.unparse(node), x, line)
        if x == "gravity":
            yield Error("take z alone of", x, f"Vector(0, 0, -{x}.z)", line)
    elif isinstance(node, ast.Name | ast.Attribute) and isinstance(node.ctx, ast.Load):
        yield from _of_name(ast.unparse(node), function, line)


def cross_product(node: ast.AST) -> tuple[ast.expr, ast.expr] | None:
    """The operands of a cross product."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "cross":
        return node.func.value, node.args[0]
    return None


def is_sum(node: ast.AST) -> bool:
    """Whether two terms are added or subtracted there."""
    return isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub)


def terms(node: ast.expr) -> list[tuple[str, ast.expr]]:
    """The terms of a sum with their signs."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        return [*terms(node.left), ("+" if isinstance(node.op, ast.Add) else "-", node.right)]
    return [("+", node)]


def summed(parts: Sequence[tuple[str, str]]) -> str:
    """The sum of terms with their signs."""
    (sign, first), *others = parts
    return f"({first})" + " * -1" * (sign == "-") + "".join(f" {sign} ({part})" for sign, part in others)


def inner_sums(nodes: Sequence[ast.AST]) -> set[int]:
    """The `id` of each sum that is the beginning of a longer one."""
    return {id(x.left) for x in nodes if isinstance(x, ast.BinOp) and is_sum(x) and is_sum(x.left)}


def rewritten(source: str, function: str, edits: Sequence[Edit], errors: Errors = errors) -> ast.Module:
    """The syntax tree of a function with all of these errors.

    Where two are about one place and do not go together, such as a term that is dropped and negated, the first counts.
    The link of an edit counts in statements that go through all links; elsewhere it does not.
    """
    tree = ast.parse(source)
    nodes = list(ast.walk(tree))
    rewriting = _Rewriting(function, errors, inner_sums(nodes))
    for edit in edits:
        rewriting.edits.setdefault(id(nodes[edit.node]), []).append(edit)
    return ast.fix_missing_locations(rewriting.visit(tree))  # type: ignore[no-any-return]


def statement_with(edit: Edit, node: ast.AST, statement: ast.stmt, function: str, errors: Errors = errors) -> str:
    """How a statement reads with an error at a node of it."""
    inside = list(ast.walk(statement))
    rewriting = _Rewriting(function, errors, inner_sums(inside))
    rewriting.edits = {id(node): [edit]}
    return ast.unparse(rewriting.at(statement, None))


def guard_of(statement: ast.AST) -> str:
    """What tells the link in a statement that goes through all of them; empty where nothing does."""
    names = {ast.unparse(x) for x in ast.walk(statement) if isinstance(x, ast.Name | ast.Attribute)}
    return next((guard for guard in GUARDS if guard in names), "")


def _of_operation(node: ast.BinOp, inner: bool) -> Iterator[Error]:
    """Errors in a sum, once for the whole of it, in a product, or in a factor."""
    whole, left, right = ast.unparse(node), ast.unparse(node.left), ast.unparse(node.right)
    if isinstance(node.op, ast.MatMult):
        turned = left.removesuffix(".T") if left.endswith(".T") else f"{left}.T"
        yield Error("transpose", f"{left} in {whole}", f"({turned}) @ ({right})", node.lineno)
        if left.endswith(".I"):
            entries = ", ".join(f"{left}.rows[{k}].{x} * ({right}).{x}" for k, x in enumerate("xyz"))
            yield Error("keep the diagonal of", f"{left} in {whole}", f"Vector({entries})", node.lineno)
    elif isinstance(node.op, ast.Mult) and isinstance(node.right, ast.Constant):
        yield Error("forget the factor of", whole, left, node.lineno)
    elif is_sum(node) and not inner:
        parts = [(sign, ast.unparse(term)) for sign, term in terms(node)]
        for k, (_, term) in enumerate(terms(node)):
            for operator in ("drop", "negate"):
                yield Error(operator, parts[k][1], _sum_with(parts, {k: operator}), term.lineno, k)


def _sum_with(parts: Sequence[tuple[str, str]], changed: Mapping[int, str]) -> str:
    """A sum of which some terms are dropped or negated."""
    other = {"+": "-", "-": "+"}
    kept = [
        (other[sign] if changed.get(k) == "negate" else sign, part)
        for k, (sign, part) in enumerate(parts)
        if changed.get(k) != "drop"
    ]
    return summed(kept) if kept else f"({parts[0][1]}) * 0"


def _of_name(name: str, function: str, line: int) -> Iterator[Error]:
    """The lever of the joint for that of the centre of mass, a force for a moment."""
    if name in LEVERS and function in ("outwards", "inwards", "motion"):
        yield Error(f"take {LEVERS[name]} for", name, LEVERS[name], line)
    elif function == "driving_force" and name in ("f", "n"):
        other = "n" if name == "f" else "f"
        yield Error(f"take {other} for", name, other, line)


class _Rewriting(ast.NodeTransformer):
    """Makes the errors, those inside of an expression first."""

    def __init__(self, function: str, errors: Errors, inner: set[int]) -> None:
        self.function, self.errors, self.inner = function, errors, inner
        self.edits: dict[int, list[Edit]] = {}

    def visit(self, node: ast.AST) -> Any:
        if isinstance(node, ast.stmt) and not hasattr(node, "body") and (guard := guard_of(node)):
            return self._at_links(node, guard)
        return self._rewritten(node)

    def _at_links(self, statement: ast.stmt, guard: str) -> ast.stmt:
        """The statement; at the links that have errors of their own, another."""
        inside = list(ast.walk(statement))
        links = {edit.link for x in inside for edit in self.edits.get(id(x), ())} - {None}
        if not links:
            return self._rewritten(statement)  # type: ignore[no-any-return]
        result = self.at(statement, None)
        for link in links:
            test = ast.parse(f"{guard} == {link}", mode="eval").body
            result = ast.If(test=test, body=[self.at(statement, link)], orelse=[result])
        return result

    def at(self, statement: ast.stmt, link: int | None) -> ast.stmt:
        """A copy of the statement as it reads at one link; at any other for None."""
        own = copy.deepcopy(statement)
        pairs = list(zip(ast.walk(statement), ast.walk(own), strict=True))
        rewriting = _Rewriting(self.function, self.errors, {id(y) for x, y in pairs if id(x) in self.inner})
        for x, y in pairs:
            rewriting.edits[id(y)] = [edit for edit in self.edits.get(id(x), ()) if edit.link in (None, link)]
        return rewriting._rewritten(own)  # type: ignore[no-any-return]

    def _rewritten(self, node: ast.AST) -> Any:
        inner, edits = id(node) in self.inner, self.edits.get(id(node), [])
        if not edits:
            return self.generic_visit(node)
        options = list(self.errors(node, self.function, inner))
        chosen = [options[edit.choice] for edit in edits]
        changed = {error.term: error.operator for error in chosen[::-1] if error.term is not None}
        if changed and isinstance(node, ast.expr):
            parts = [(sign, ast.unparse(self.visit(term))) for sign, term in terms(node)]
            return _placed(_sum_with(parts, changed), node)
        node = self.generic_visit(node)
        for option in list(self.errors(node, self.function, inner))[edits[0].choice :][:1]:
            if option.operator == chosen[0].operator:
                return _placed(option.text, node)
        return node


def _placed(text: str, node: ast.AST) -> ast.AST:
    """The text as what stands in the place of a node."""
    statement = ast.parse(text).body[0]
    if isinstance(node, ast.stmt):
        return statement
    assert isinstance(statement, ast.Expr)
    return ast.keyword(node.arg, statement.value) if isinstance(node, ast.keyword) else statement.value
