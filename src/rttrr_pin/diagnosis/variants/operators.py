"""Errors that people make when they write a recursion down, as operators on the nodes of its syntax tree.

A term dropped, a sign flipped, a rotation for its transpose, the operands of a cross product exchanged, r_C for p, the
2 of Coriolis forgotten, a force for a moment. `rewritten` makes any number of them in one function.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeGuard

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


def is_sum(node: ast.AST | None) -> TypeGuard[ast.BinOp]:
    """Whether two terms are added or subtracted there."""
    return isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub)


def terms(node: ast.expr) -> list[tuple[str, ast.expr]]:
    """The terms of a sum with their signs."""
    if is_sum(node):
        return [*terms(node.left), ("+" if isinstance(node.op, ast.Add) else "-", node.right)]
    return [("+", node)]


def summed(parts: Sequence[tuple[str, str]]) -> str:
    """The sum of terms with their signs."""
    (sign, first), *others = parts
    return f"({first})" + " * -1" * (sign == "-") + "".join(f" {sign} ({part})" for sign, part in others)


@dataclass(frozen=True, eq=False)
class Syntax:
    """The syntax tree of one function; it is never changed.

    Attributes:
        name: of the function.
        first: the line of its file where it begins.
        tree: a module with the function alone.
        nodes: in the order of `ast.walk`.
        parents: by the `id` of each node; none for the tree.
    """

    name: str
    first: int
    tree: ast.Module
    nodes: tuple[ast.AST, ...]
    parents: Mapping[int, ast.AST]

    @classmethod
    def of(cls, source: str, name: str, first: int = 1) -> Syntax:
        """That of a function's source."""
        tree = ast.parse(source)
        nodes = tuple(ast.walk(tree))
        return cls(name, first, tree, nodes, {id(x): node for node in nodes for x in ast.iter_child_nodes(node)})

    def inner(self, node: ast.AST) -> bool:
        """Whether a node is the beginning of a longer sum."""
        above = self.parents.get(id(node))
        return is_sum(above) and above.left is node

    def statement(self, node: ast.AST) -> ast.AST:
        """The innermost statement that a node is in."""
        return next(x for x in self.around(node) if isinstance(x, ast.stmt | ast.Module))

    def around(self, node: ast.AST) -> Iterator[ast.AST]:
        """The node and those that it is in, the tree last."""
        above: ast.AST | None = node
        while above is not None:
            yield above
            above = self.parents.get(id(above))


def rewritten(syntax: Syntax, edits: Sequence[Edit], errors: Errors = errors, of: ast.AST | None = None) -> ast.AST:
    """The syntax tree of a function with all of these errors; of one node of it, where one is given.

    Where two are about one place and do not go together, such as a term that is dropped and negated, the first counts.
    The link of an edit counts in statements that go through all links; elsewhere it does not.
    """
    result: ast.AST = _Rewriting(syntax, edits, errors).rewritten(of or syntax.tree, tuple(edits))
    return result


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
        if is_sum(node.right):
            yield from _partly(node, left)
    elif isinstance(node.op, ast.Mult) and isinstance(node.right, ast.Constant):
        yield Error("forget the factor of", whole, left, node.lineno)
    elif is_sum(node) and not inner:
        parts = [(sign, ast.unparse(term)) for sign, term in terms(node)]
        for k, (_, term) in enumerate(terms(node)):
            for operator in ("drop", "negate"):
                yield Error(operator, parts[k][1], _sum_with(parts, {k: operator}), term.lineno, k)


def _partly(node: ast.BinOp, matrix: str) -> Iterator[Error]:
    """A product with a sum whose parentheses are forgotten, or that misses a term."""
    parts = [(sign, ast.unparse(term)) for sign, term in terms(node.right)]
    products = [(sign, f"({matrix}) @ ({part})") for sign, part in parts]
    first = summed([products[0], *parts[1:]])
    yield Error("turn the first term alone of", ast.unparse(node), f"({first})", node.lineno)
    for k, (sign, part) in enumerate(parts):
        some = summed([*products[:k], (sign, part), *products[k + 1 :]])
        yield Error("do not turn", part, f"({some})", node.lineno)


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


class _Rewriting:
    """Copies what has an error inside, and shares the rest."""

    def __init__(self, syntax: Syntax, edits: Sequence[Edit], errors: Errors) -> None:
        self.syntax, self.errors = syntax, errors
        self.touched: dict[int, list[Edit]] = {}
        """Of each node with errors in it, which."""
        for edit in edits:
            for node in syntax.around(syntax.nodes[edit.node]):
                self.touched.setdefault(id(node), []).append(edit)

    def rewritten(self, node: ast.AST, active: tuple[Edit, ...]) -> Any:
        """A node with those of the errors that are active."""
        inside = [edit for edit in self.touched.get(id(node), ()) if edit in active]
        if not inside:
            return node
        links = {edit.link for edit in inside} - {None}
        if links and isinstance(node, ast.stmt) and not hasattr(node, "body") and (guard := guard_of(node)):
            return self._at_links(node, inside, guard)
        return self._edited(node, tuple(inside))

    def _at_links(self, statement: ast.stmt, edits: Sequence[Edit], guard: str) -> ast.stmt:
        """The statement; at the links that have errors of their own, another."""

        def at(link: int | None) -> Any:
            return self._edited(statement, tuple(edit for edit in edits if edit.link in (None, link)))

        result: ast.stmt = at(None)
        for link in {edit.link for edit in edits} - {None}:
            test = ast.parse(f"{guard} == {link}", mode="eval").body
            result = ast.If(test=test, body=[at(link)], orelse=[result])
        return ast.fix_missing_locations(ast.copy_location(result, statement))

    def _edited(self, node: ast.AST, active: tuple[Edit, ...]) -> Any:
        """The node with errors inside, those of its parts first."""
        edits = [edit for edit in active if self.syntax.nodes[edit.node] is node]
        if not edits:
            return self._copied(node, active)
        inner = self.syntax.inner(node)
        options = list(self.errors(node, self.syntax.name, inner))
        chosen = [options[edit.choice] for edit in edits]
        changed = {error.term: error.operator for error in chosen[::-1] if error.term is not None}
        if changed and isinstance(node, ast.expr):
            parts = [(sign, ast.unparse(self.rewritten(term, active))) for sign, term in terms(node)]
            return _placed(_sum_with(parts, changed), node)
        result = self._copied(node, active)
        for option in list(self.errors(result, self.syntax.name, inner))[edits[0].choice :][:1]:
            if option.operator == chosen[0].operator:
                return _placed(option.text, node)
        return result

    def _copied(self, node: ast.AST, active: tuple[Edit, ...]) -> ast.AST:
        """A copy of a node with errors in its parts."""
        result = copy.copy(node)
        for name, value in ast.iter_fields(node):
            if isinstance(value, list):
                setattr(result, name, [self.rewritten(x, active) if isinstance(x, ast.AST) else x for x in value])
            elif isinstance(value, ast.AST):
                setattr(result, name, self.rewritten(value, active))
        return result


def _placed(text: str, node: ast.AST) -> ast.AST:
    """The text as what stands in the place of a node."""
    statement: ast.AST = ast.parse(text).body[0]
    if not isinstance(node, ast.stmt):
        assert isinstance(statement, ast.Expr)
        statement = ast.keyword(node.arg, statement.value) if isinstance(node, ast.keyword) else statement.value
    return ast.fix_missing_locations(ast.copy_location(statement, node))
