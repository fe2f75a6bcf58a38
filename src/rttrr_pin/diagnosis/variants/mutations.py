"""Errors in the reference recursion, made from its syntax tree, so that the list follows the code.

`mutations` lists them; `mutated` is the dynamics with some of them. It runs copies of the functions of the core over
namespaces of their own: nothing is changed in place, and other runs, also of other threads, never see an error.
"""

from __future__ import annotations

import ast
import copy
import inspect
import linecache
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any, TypeAlias

from rttrr_pin.core import algebra, dynamics, newton_euler
from rttrr_pin.core.joints import JOINT_TYPES, JointType
from rttrr_pin.core.joints.base import Body
from rttrr_pin.diagnosis.variants.operators import Errors, Syntax, errors, guard_of, rewritten

Dynamics: TypeAlias = Callable[..., dynamics.Result]
"""Has the signature of `core.dynamics.dynamics`."""

EQUIVALENT = {
    "outwards: transpose body.I in body.I @ w_dot": "an inertia tensor is symmetric",
    "outwards: transpose body.I in body.I @ w": "an inertia tensor is symmetric",
    "joint_effects: drop force": "armature is the first term, to which nothing was added before",
    "joint_effects: negate force": "armature is the first term, to which nothing was added before",
}
"""Errors that change no number, and why."""

STEPS = ("outwards", "inwards")
"""Those run once for each link, on its body."""

ALGEBRA = ("rotation", "quaternion_rotation")
"""What joint types turn by."""

METHODS = ("motion", "driving_force")
"""The mechanics of a joint type."""


@dataclass(frozen=True, slots=True)
class Mutation:
    """One error in one function of the core.

    Attributes:
        id: the function, the operator and the expression that it was applied to; the same at each link.
        function: the function that has it, as Python names it.
        operator: what was done, in words: "drop", "negate", "transpose", ...
        expression: what it was done to.
        original: the statement as it is.
        statement: the statement with the error.
        file: of the function, from the folder of the package.
        line: of the expression in it.
        node: index of the node in the function's syntax tree.
        choice: which of the errors there.
        link: index of the only link that has it; None for all.
    """

    id: str
    function: str
    operator: str
    expression: str
    original: str
    statement: str
    file: str
    line: int
    node: int
    choice: int
    link: int | None = None


def mutations() -> list[Mutation]:
    """Every error that changes a number, at all links."""
    return [one for name in functions() for one in mutations_of(name)]


@cache
def mutations_of(function: str) -> tuple[Mutation, ...]:
    """Those of one function, at all links."""
    return tuple(one for one in generated(functions()[function]) if one.id not in EQUIVALENT)


def mutation(identity: str) -> Mutation:
    """The error of that id, at all links.

    Raises:
        StopIteration: there is none.
    """
    return next(one for one in mutations() if one.id == identity)


def at(mutation: Mutation, link: int | None) -> Mutation:
    """The same error at one link alone, or at all of them.

    Raises:
        ValueError: it is in a place that all links share, such as the sign of gravity.
    """
    if link is not None and not is_local(mutation):
        raise ValueError(f"{mutation.id}: no link has this error alone")
    return replace(mutation, link=link)


def is_local(mutation: Mutation) -> bool:
    """Whether one link, or its joint, may have the error alone."""
    if mutation.function in (*STEPS, *ALGEBRA) or "." in mutation.function:
        return True
    return bool(guard_of(ast.parse(mutation.original)))


def place_of(mutation: Mutation) -> tuple[Syntax, ast.AST]:
    """The syntax tree of the function that has the error, and the node there."""
    syntax = _syntax(functions()[mutation.function])
    return syntax, syntax.nodes[mutation.node]


def source_line(mutation: Mutation, line: int) -> str:
    """A line of the file that has the error, with its comment."""
    return linecache.getline(inspect.getfile(functions()[mutation.function]), line)


def generated(function: FunctionType, errors: Errors = errors) -> Iterator[Mutation]:
    """All errors of one function, also those that change no number."""
    syntax = _syntax(function)
    file = Path(inspect.getfile(function)).relative_to(Path(algebra.__file__).parents[1]).as_posix()
    originals = {id(x): ast.unparse(x) for x in syntax.nodes if isinstance(x, ast.stmt)}
    seen: dict[str, int] = {}
    changed: set[tuple[int, str]] = set()
    for k, node in enumerate(syntax.nodes):
        for choice, error in enumerate(errors(node, syntax.name, syntax.inner(node))):
            statement = syntax.statement(node)
            name = f"{function.__qualname__}: {error.operator} {error.expression}"
            what = (function.__qualname__, error.operator, error.expression, originals[id(statement)])
            one = Mutation(name, *what, "", file, syntax.first + error.line - 1, k, choice)
            text = ast.unparse(rewritten(syntax, [one], errors, statement))
            if (id(statement), text) in changed:
                continue
            changed.add((id(statement), text))
            seen[name] = seen.get(name, 0) + 1
            yield replace(one, id=name + f" ({seen[name]})" * (seen[name] > 1), statement=text)


@cache
def functions() -> dict[str, FunctionType]:
    """The mechanics of the core by name: rotations, the recursion, mimic joints, friction, and how joints move."""
    found: list[Any] = [getattr(algebra, name) for name in ALGEBRA]
    for module in (newton_euler, dynamics):
        found += [x for x in vars(module).values() if inspect.isfunction(x) and x.__module__ == module.__name__]
    found += [getattr(type(kind), name) for kind in JOINT_TYPES.values() for name in METHODS]
    return {function.__qualname__: function for function in found}


def compiled(function: str, mutations: Sequence[Mutation], errors: Errors = errors) -> CodeType:
    """The code of a function with all of these errors; see `rewritten` for what becomes of their links."""
    syntax = _syntax(functions()[function])
    tree: Any = rewritten(syntax, mutations, errors)
    code = compile(tree, f"<{function} with an error>", "exec", annotations.compiler_flag, dont_inherit=True)
    return next(x for x in code.co_consts if isinstance(x, CodeType) and x.co_name == syntax.name)


def mutated(mutations: Sequence[Mutation]) -> Dynamics:
    """The dynamics with all of these errors at once; `core.dynamics.dynamics` for none."""
    return _mutated(tuple(mutations)) if mutations else dynamics.dynamics


@lru_cache(maxsize=1024)
def _mutated(mutations: tuple[Mutation, ...]) -> Dynamics:
    """Kept, since a program under a hypothesis runs on many batches."""
    everywhere = [one for one in mutations if one.link is None]
    own = {one.link: [x for x in mutations if x.link in (None, one.link)] for one in mutations if one.link is not None}
    inner = _namespace(newton_euler, [one for one in mutations if one.link is None or one.function not in STEPS])
    outer = _namespace(dynamics, mutations)
    steps = {
        link: {
            inner[name]: copied(functions()[name], some, inner)
            for name in STEPS
            if any(one.function == name and one.link == link for one in some)
        }
        for link, some in own.items()
    }
    types = {link: JointTypes(some) for link, some in own.items()}
    outer["newton_euler"] = _with_errors(inner["newton_euler"], steps, types, JointTypes(everywhere))
    return outer["dynamics"]  # type: ignore[no-any-return]


def _with_errors(
    recursion: Callable[..., newton_euler.Wrenches],
    steps: Mapping[int, Mapping[Any, Any]],
    types: Mapping[int, JointTypes],
    others: JointTypes,
) -> Callable[..., newton_euler.Wrenches]:
    """The recursion with joint types that have errors, and with steps that have them at some links alone."""

    def run(bodies: Sequence[Body], *arguments: Any) -> newton_euler.Wrenches:
        *rest, call = arguments
        own = [body_with(body, types.get(k, others), k in steps) for k, body in enumerate(bodies)]
        wrong = {
            (step, id(own[k])): other for k, pairs in steps.items() if k < len(own) for step, other in pairs.items()
        }

        def at_link(step: Any, first: Any, *inputs: Any) -> Any:
            return call(wrong.get((step, id(first)), step), first, *inputs)

        return recursion(own, *rest, at_link if wrong else call)

    return run


def body_with(body: Body, types: JointTypes, unique: bool = False) -> Body:
    """The link on a joint whose type has errors; if need be one that no other link is."""
    kind = types.of(body.type)
    return replace(body, type=kind) if unique or kind is not body.type else body


class JointTypes:
    """Joint types with errors."""

    def __init__(self, mutations: Sequence[Mutation]) -> None:
        self.mutations = [one for one in mutations if "." in one.function]
        names = {one.function for one in mutations}.intersection(ALGEBRA)
        namespace = vars(algebra)
        self.rotations = {namespace[x]: copied(namespace[x], mutations, namespace) for x in names}
        self.known: dict[JointType, JointType] = {}

    def of(self, kind: JointType) -> JointType:
        """The type with errors; the type itself where it has none."""
        if not self.mutations and not self.rotations:
            return kind
        if kind not in self.known:
            self.known[kind] = self._altered(kind)
        return self.known[kind]

    def _altered(self, kind: JointType) -> JointType:
        """An instance of a class of its own, whose methods are copies."""
        methods = {}
        for name in METHODS:
            method: Any = getattr(type(kind), name)
            used = {key: self.rotations[x] for key, x in method.__globals__.items() if _in(x, self.rotations)}
            if used or any(one.function == method.__qualname__ for one in self.mutations):
                methods[name] = copied(method, self.mutations, {**method.__globals__, **used})
        if not methods:
            return kind
        altered = copy.copy(kind)
        object.__setattr__(altered, "__class__", type(type(kind).__name__, (type(kind),), methods))
        return altered


def _in(value: Any, functions: Mapping[Any, Any]) -> bool:
    return isinstance(value, FunctionType) and value in functions


def _namespace(module: ModuleType, mutations: Sequence[Mutation]) -> dict[str, Any]:
    """The names of a module, with copies of its functions that see each other."""
    namespace = dict(vars(module))
    for name, function in vars(module).items():
        if inspect.isfunction(function) and function.__module__ == module.__name__:
            namespace[name] = copied(function, mutations, namespace)
    return namespace


def copied(function: FunctionType, mutations: Sequence[Mutation], namespace: dict[str, Any]) -> FunctionType:
    """The function with its errors over a namespace."""
    own = [one for one in mutations if one.function == function.__qualname__]
    code = compiled(function.__qualname__, own) if own else function.__code__
    result = FunctionType(code, namespace, function.__name__, function.__defaults__, function.__closure__)
    result.__kwdefaults__ = function.__kwdefaults__
    return result


@cache
def _syntax(function: FunctionType) -> Syntax:
    lines, first = inspect.getsourcelines(function)
    return Syntax.of(textwrap.dedent("".join(lines)), function.__name__, first)
