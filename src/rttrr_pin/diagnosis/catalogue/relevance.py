"""Where an error in the recursion can show in a robot: in a term that can be other than zero there."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from functools import cache

import numpy as np

from rttrr_pin.core.joint import EFFECTS
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.variants.mutations import ALGEBRA, Mutation, place_of
from rttrr_pin.diagnosis.variants.operators import cross_product, guard_of, is_sum, terms

Possible = Callable[[Model, int], bool]
"""Whether something can be other than zero at a link, or at its joint."""


def concerned(error: Mutation, model: Model) -> tuple[int, ...] | None:
    """The links in which the error can show; None where it is in no link more than in another."""
    guard = _guard(error)
    if error.function == "newton_euler" and guard != "i":
        gravity = model.gravity[:2] if error.operator.startswith("take z") else model.gravity
        return None if guard or np.any(gravity) else ()
    if error.function == "dynamics" and error.expression == "x":
        return None
    shows = _shows(error)
    return tuple(i for i in range(len(model.links)) if _runs(error.function, model, i) and shows(model, i))


@cache
def _guard(error: Mutation) -> str:
    syntax, node = place_of(error)
    return guard_of(syntax.statement(node))


def runs(function: str, model: Model) -> bool:
    """Whether a function is at work anywhere in a robot."""
    return any(_runs(function, model, i) for i in range(len(model.links)))


def _runs(function: str, model: Model, i: int) -> bool:
    """Whether a function is at work at a link."""
    joint = model.joints[i]
    kind = type(joint.type)
    if function in ALGEBRA:
        return function in kind.motion.__code__.co_names
    if "." in function:
        return function in (kind.motion.__qualname__, kind.driving_force.__qualname__)
    return joint.mimic is not None or function not in ("mimicked", "generalised_forces")


@cache
def _shows(error: Mutation) -> Possible:
    """Whether the term with the error, and all that it is multiplied with, can be other than zero, and is changed."""
    syntax, node = place_of(error)
    levers = error.operator.startswith("take ") and error.expression in LEVERS
    part = node
    whole = node.right if isinstance(node, ast.BinOp) and error.operator == "do not turn" else node
    if is_sum(whole):
        part = next(term for _, term in terms(whole) if ast.unparse(term) == error.expression)
    products = (part, *_factors(syntax.around(node)))
    conditions = {condition for x in products for condition in _conditions(x, levers)}
    if levers:
        conditions.add(_levers_differ)
    elif error.operator == "transpose":
        conditions.add(_is_turned)
    elif error.operator in ("turn the first term alone of", "do not turn"):
        conditions.add(_differs_in_axes)
    elif error.operator == "keep the diagonal of":
        conditions.add(_has_products)
    return lambda model, i: all(condition(model, i) for condition in conditions)


def _factors(around: Iterator[ast.AST]) -> Iterator[ast.AST]:
    """The node, and the products that it is a factor of."""
    yield next(around)
    for node in around:
        product = isinstance(node, ast.BinOp | ast.UnaryOp | ast.Attribute) or cross_product(node) is not None
        if not product or is_sum(node):
            return
        yield node


def _conditions(node: ast.AST, levers: bool) -> set[Possible]:
    """What must be so that an expression is not zero: a product where all factors are, a sum where one term is."""
    if is_sum(node):
        alternatives = [_conditions(term, levers) for _, term in terms(node)]
        return {lambda model, i: any(all(one(model, i) for one in some) for some in alternatives)}
    text = ast.unparse(node) if isinstance(node, ast.Name | ast.Attribute) else ""
    if text in FACTORS:
        return set() if levers and text in LEVERS else {FACTORS[text]}
    return {one for x in ast.iter_child_nodes(node) for one in _conditions(x, levers)}


def turns(model: Model, i: int) -> bool:
    """Whether the joint of a link turns it."""
    return any(model.joints[i].type.rotations)


def slides(model: Model, i: int) -> bool:
    """Whether the joint of a link displaces its origin."""
    return not all(model.joints[i].type.rotations)


def carrier_turns(model: Model, i: int) -> bool:
    """Whether something turns what carries a link's joint."""
    return any(turns(model, k) for k in model.path(i) if k != i)


def _levers_differ(model: Model, i: int) -> bool:
    return slides(model, i) or not np.array_equal(model.joints[i].p, model.links[i].com)


def _is_turned(model: Model, i: int) -> bool:
    R = model.joints[i].R
    return turns(model, i) or not np.array_equal(R, R.T)


def _differs_in_axes(model: Model, i: int) -> bool:
    return turns(model, i) or not np.array_equal(model.joints[i].R, np.eye(3))


def _has_products(model: Model, i: int) -> bool:
    I = model.links[i].inertia
    return bool(np.any(I - np.diag(np.diag(I))))


def _has_lever(model: Model, i: int) -> bool:
    return bool(np.any(model.joints[i].p)) or slides(model, i)


def _has_com(model: Model, i: int) -> bool:
    return bool(np.any(model.links[i].com))


def _has_effect(name: str) -> Possible:
    return lambda model, i: bool(getattr(model.joints[i].effects, name))


def _takes_something(model: Model, i: int) -> bool:
    return any(_has_effect(name)(model, i) for name in EFFECTS)


def _takes_two(model: Model, i: int) -> bool:
    return sum(_has_effect(name)(model, i) for name in EFFECTS) > 1


def _has_offset(model: Model, i: int) -> bool:
    mimic = model.joints[i].mimic
    return mimic is not None and bool(mimic.offset)


def _has_parent(model: Model, i: int) -> bool:
    return model.joints[i].parent >= 0


LEVERS: dict[str, Possible] = {
    "p": _has_lever,
    "joint.p": _has_lever,
    "r_C": _has_com,
    "body.r_C": _has_com,
    "body.p": lambda model, i: bool(np.any(model.joints[i].p)),
}
"""Vectors to the origin and to the centre of mass of a link."""

FACTORS: dict[str, Possible] = {
    **LEVERS,
    "joint.w": turns,
    "joint.w_dot": turns,
    "joint.v": slides,
    "joint.v_dot": slides,
    "carried": carrier_turns,
    "w_p": carrier_turns,
    "w_dot_p": carrier_turns,
    "body.I": lambda model, i: bool(np.any(model.links[i].inertia)),
    "joint.R": _has_parent,
    "R_f": _has_parent,
    "R_n": _has_parent,
    "effects.armature": _has_effect("armature"),
    "effects.damping": _has_effect("damping"),
    "effects.friction": _has_effect("friction"),
    "force": _takes_two,
    "y": _takes_something,
    "offset": _has_offset,
}
"""What can be zero in a robot at all times; all else cannot."""
