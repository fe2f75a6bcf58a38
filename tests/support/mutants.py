"""Errors planted in the reference recursion, made from its syntax tree, so that the list follows the code.

Each operator is an error that people make: a term dropped, a sign flipped, a rotation for its transpose, the operands
of a cross product exchanged, r_C for p, the 2 of Coriolis forgotten; and a few that only break linearity or scaling. It
rewrites one node of one function. `planted` swaps the compiled code of that function, in this process.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import lru_cache
from types import CodeType, FunctionType
from typing import Any

import pytest

from rttrr_pin.core import dynamics, newton_euler
from rttrr_pin.core.algebra import quaternion_rotation, rotation
from rttrr_pin.core.joints import JOINT_TYPES

STEPS = (newton_euler.outwards, newton_euler.inwards)
"""Those run once for each link, on its body."""

EQUIVALENT = {
    "outwards: transpose body.I in body.I @ w_dot": "an inertia tensor is symmetric",
    "outwards: transpose body.I in body.I @ w": "an inertia tensor is symmetric",
    "joint_effects: drop force": "armature is the first term, to which nothing was added before",
    "joint_effects: negate force": "armature is the first term, to which nothing was added before",
}
"""Errors that change no number, and why."""

DETUNED = "2**-30"
"""Relative size of the error that the operator `detune` makes of a term."""


@dataclass(frozen=True)
class Mutant:
    """One error in one function.

    Attributes:
        id: the function, the operator and the expression that it was applied to.
        description: the statement as it reads with the error.
        function: the function that has it.
        code: compiled, with the error.
        link: index of the only link whose step has the error; None for all.
    """

    id: str
    description: str
    function: FunctionType
    code: CodeType
    link: int | None = None


@lru_cache
def mutants(link: int | None = None) -> list[Mutant]:
    """Every error, at all links; or those of the steps on a link, at this link alone."""
    functions = _functions() if link is None else STEPS
    return [replace(mutant, link=link) for function in functions for mutant in _of(function)]


def mutant(identity: str) -> Mutant:
    """The error of that id."""
    return next(one for one in mutants() if one.id == identity)


@contextmanager
def planted(mutant: Mutant) -> Iterator[None]:
    """Run the reference recursion with the error."""
    if mutant.link is None:
        original, mutant.function.__code__ = mutant.function.__code__, mutant.code
        try:
            yield
        finally:
            mutant.function.__code__ = original
        return
    wrong = FunctionType(mutant.code, mutant.function.__globals__)
    target: list[Any] = [None]

    def step(body: Any, *rest: Any) -> Any:
        return (wrong if body is target[0] else mutant.function)(body, *rest)

    def recursion(bodies: Any, *rest: Any) -> Any:
        target[0] = bodies[mutant.link]
        return newton_euler.newton_euler(bodies, *rest)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(newton_euler, mutant.function.__name__, step)
        patch.setattr(dynamics, "newton_euler", recursion)
        yield


def _functions() -> Iterator[Any]:
    """The mechanics of the core: the recursion, mimic joints, friction, and how joints move."""
    yield from (rotation, quaternion_rotation)
    for module in (newton_euler, dynamics):
        yield from (x for x in vars(module).values() if inspect.isfunction(x) and x.__module__ == module.__name__)
    methods = (getattr(type(kind), name) for kind in JOINT_TYPES.values() for name in ("motion", "driving_force"))
    yield from dict.fromkeys(methods)


def _of(function: Any) -> Iterator[Mutant]:
    """All errors of one function."""
    source = textwrap.dedent(inspect.getsource(function))
    nodes = list(ast.walk(ast.parse(source)))
    seen: dict[str, int] = {}
    sources: set[str] = set()
    for k, node in enumerate(nodes):
        for operator, where, text in _errors(node, nodes, function.__name__):
            tree = ast.parse(source)
            statement = _Replacing(list(ast.walk(tree))[k], text).apply(tree)
            if (mutated := ast.unparse(tree)) in sources:
                continue
            sources.add(mutated)
            name = f"{function.__qualname__}: {operator} {where}"
            seen[name] = seen.get(name, 0) + 1
            name += f" ({seen[name]})" if seen[name] > 1 else ""
            yield Mutant(name, statement, function, _compiled(tree, function))


def _errors(node: ast.AST, nodes: list[ast.AST], function: str) -> Iterator[tuple[str, str, str]]:
    """Errors at a node: operator, the expression it is applied to, and what stands there then."""
    if isinstance(node, ast.BinOp):
        yield from _of_operation(node, nodes, function)
    elif isinstance(node, ast.AugAssign) and isinstance(node.op, ast.Add):
        yield "drop", ast.unparse(node), "pass"
        yield "negate", ast.unparse(node), f"{ast.unparse(node.target)} -= {ast.unparse(node.value)}"
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "cross":
        a, b = f"({ast.unparse(node.func.value)})", f"({ast.unparse(node.args[0])})"
        yield "exchange operands of", ast.unparse(node), f"{b}.cross{a}"
        yield "repeat", ast.unparse(node), f"{a}.cross({a}.cross{b})"
        yield "keep the last of", ast.unparse(node), b
    elif isinstance(node, ast.keyword) and node.arg in ("w", "w_dot", "v", "v_dot"):
        yield "negate", f"{node.arg}={ast.unparse(node.value)}", f"-({ast.unparse(node.value)})"
        yield "drop", f"{node.arg}={ast.unparse(node.value)}", "Vector(0, 0, 0)"
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        x = ast.unparse(node.operand)
        yield "drop the sign of", ast.unparse(node), x
        if x == "gravity":
            yield "square", x, f"{x} * -{x}.dot({x})"
            yield "take z alone of", x, f"Vector(0, 0, -{x}.z)"
    elif isinstance(node, ast.Name | ast.Attribute) and isinstance(node.ctx, ast.Load):
        yield from _of_name(ast.unparse(node), function)


def _of_operation(node: ast.BinOp, nodes: list[ast.AST], function: str) -> Iterator[tuple[str, str, str]]:
    """Errors in a sum, once for the whole of it, in a product, or in a factor."""
    if isinstance(node.op, ast.MatMult):
        yield from _of_product(ast.unparse(node.left), ast.unparse(node.right), ast.unparse(node))
    elif isinstance(node.op, ast.Mult) and isinstance(node.right, ast.Constant):
        yield "forget the factor of", ast.unparse(node), ast.unparse(node.left)
    elif _is_sum(node) and not any(_is_sum(x) and x.left is node for x in nodes):  # type: ignore[attr-defined]
        yield from _of_sum(_terms(node), detune=function in ("outwards", "inwards"))


def _of_sum(terms: list[tuple[str, ast.expr]], detune: bool) -> Iterator[tuple[str, str, str]]:
    """Each term dropped, negated, or changed in the tenth digit."""

    def text(parts: list[tuple[str, str]]) -> str:
        (sign, first), *others = parts
        return f"({first})" + " * -1" * (sign == "-") + "".join(f" {sign} ({part})" for sign, part in others)

    parts = [(sign, ast.unparse(term)) for sign, term in terms]
    for k, (sign, term) in enumerate(parts):
        yield "drop", term, text(parts[:k] + parts[k + 1 :])
        yield "negate", term, text([*parts[:k], ("+" if sign == "-" else "-", term), *parts[k + 1 :]])
        if detune:
            yield "detune", term, text([*parts[:k], (sign, f"({term}) * (1 + {DETUNED})"), *parts[k + 1 :]])


def _of_product(left: str, right: str, whole: str) -> Iterator[tuple[str, str, str]]:
    """A matrix for its transpose; a tensor without its products of inertia."""
    yield (
        "transpose",
        f"{left} in {whole}",
        f"({left.removesuffix('.T') if left.endswith('.T') else f'{left}.T'}) @ ({right})",
    )
    if left.endswith(".I"):
        terms = ", ".join(f"{left}.rows[{k}].{x} * ({right}).{x}" for k, x in enumerate("xyz"))
        yield "keep the diagonal of", f"{left} in {whole}", f"Vector({terms})"


LEVERS = {"p": "r_C", "r_C": "p", "joint.p": "body.r_C", "body.p": "body.r_C", "body.r_C": "joint.p"}


def _of_name(name: str, function: str) -> Iterator[tuple[str, str, str]]:
    """The lever of the joint for that of the centre of mass, a mass squared, a force for a moment."""
    if name in LEVERS and function in ("outwards", "inwards", "motion"):
        yield f"take {LEVERS[name]} for", name, LEVERS[name]
    elif name == "body.M":
        yield "square", name, "(body.M * body.M)"
    elif function == "driving_force" and name in ("f", "n"):
        yield f"take {'n' if name == 'f' else 'f'} for", name, "n" if name == "f" else "f"


def _is_sum(node: ast.AST) -> bool:
    return isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub)


def _terms(node: ast.expr) -> list[tuple[str, ast.expr]]:
    """The terms of a sum with their signs."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        return [*_terms(node.left), ("+" if isinstance(node.op, ast.Add) else "-", node.right)]
    return [("+", node)]


class _Replacing(ast.NodeTransformer):
    """Puts the text in the place of a node."""

    def __init__(self, target: ast.AST, text: str) -> None:
        self.target, self.text, self.statement = target, text, ""

    def apply(self, tree: ast.AST) -> str:
        """Rewrite the tree; return the simple statement that was changed."""
        self.visit(tree)
        ast.fix_missing_locations(tree)
        return self.statement

    def visit(self, node: ast.AST) -> Any:
        if node is self.target:
            parsed = ast.parse(self.text).body[0]
            if isinstance(node, ast.stmt):
                self.statement = self.text
                return parsed
            assert isinstance(parsed, ast.Expr)
            return ast.keyword(node.arg, parsed.value) if isinstance(node, ast.keyword) else parsed.value
        inside = any(x is self.target for x in ast.walk(node))
        changed = self.generic_visit(node) if inside else node
        if inside and isinstance(node, ast.stmt) and not self.statement:
            self.statement = ast.unparse(node)
        return changed


def _compiled(tree: ast.AST, function: Callable[..., Any]) -> CodeType:
    """The code of the function in a tree."""
    import __future__

    code = compile(tree, f"<mutant of {function.__qualname__}>", "exec", __future__.annotations.compiler_flag)  # type: ignore[call-overload]
    return next(x for x in code.co_consts if isinstance(x, CodeType) and x.co_name == function.__name__)
