"""The catalogue of errors in the mechanics: every mutation of the recursion, at all links and at each alone."""

from __future__ import annotations

import ast
import re
from functools import lru_cache

from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.catalogue.relevance import concerned, runs
from rttrr_pin.diagnosis.catalogue.terms import LETTERS, SENTENCES, UNKNOWN, named
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.mutations import (
    Mutation,
    at,
    functions,
    is_local,
    mutations_of,
    place_of,
    source_line,
)

EQUATION = re.compile(r"#.*?(?<!before )(\(\d+\)(?:-\(\d+\))?)")
"""The equations of the paper that a line of the code states in its comment."""

TAKEN = re.compile(r"take (\S+) for")
"""The operator that takes one thing for another."""

PLACES = {
    **dict.fromkeys(("newton_euler", "outwards", "inwards"), "every link"),
    **dict.fromkeys(("dynamics", "joint_effects"), "every joint"),
    **dict.fromkeys(("mimicked", "generalised_forces"), "every mimic joint"),
    "rotation": "every joint that turns about an axis",
    "quaternion_rotation": "every floating joint",
}
"""Where a function is at work; one of a joint type, at the joints of that type."""


def mechanics(model: Model) -> list[Hypothesis]:
    """Every error in the recursion that may show in this robot.

    An error that one link alone can have in this robot is named with that link, and stands there once.
    """
    found = []
    for error in (one for name in functions() if runs(name, model) for one in mutations_of(name)):
        links = concerned(error, model)
        if links is None:
            found.append(hypothesis(error, model))
        elif len(links) == 1:
            found.append(hypothesis(error, model, links[0]))
        elif links:
            found.append(hypothesis(error, model))
            found += [hypothesis(at(error, i), model, i) for i in links if is_local(error)]
    return found


def hypothesis(error: Mutation, model: Model, link: int | None = None) -> Hypothesis:
    """That a program has this error; it is told at one link, or at all."""
    sentence, repair = sentences(error, model, link)
    equations = (EQUATION.search(source_line(error, line)) for line in _lines(error))
    code = source_line(error, error.line).partition("#")[0].strip()
    return Hypothesis(
        id=error.id,
        kind="mechanics",
        sentence=sentence,
        repair=repair,
        apply=lambda variant, x: variant.with_mutation(error),
        link=None if link is None else model.links[link].name,
        joint=None if link is None else model.joints[link].name,
        equation=next((found[1] for found in equations if found), ""),
        line=f"{error.file}:{error.line}  {code}",
        mutation=error,
    )


def sentences(error: Mutation, model: Model, link: int | None) -> tuple[str, str]:
    """What a program with the error does, and what to do about it."""
    term, around = term_of(at(error, None))
    operator, wrong, right = error.operator, "", ""
    if swapped := TAKEN.fullmatch(operator):
        operator, term = "take", around
        wrong, right = letters(swapped[1]), letters(error.expression)
    elif operator == "transpose":
        right = letters(error.expression.partition(" in ")[0])
        wrong = right.removesuffix("^T") if right.endswith("^T") else f"{right}^T"
    words = {"term": term, "wrong": wrong, "right": right, "place": _place(error, model, link)}
    words |= {"original": error.original, "statement": error.statement}
    does, repair = (text.format(**words).removesuffix(",") for text in SENTENCES.get(operator, UNKNOWN))
    return does, f"{repair}: `{error.original}`"


@lru_cache(maxsize=4096)
def term_of(error: Mutation) -> tuple[str, str]:
    """What the expression is called, and what the named expression around it is."""
    expression = error.expression.partition(" in ")[2] or error.expression
    syntax, node = place_of(error)
    around = [ast.unparse(x) for x in syntax.around(node) if isinstance(x, ast.expr | ast.keyword)]
    name = named(error.function, [expression, *around])
    if name is None:
        return f"{letters(expression)} in `{error.original}`", f"`{error.original}`"
    return name[1] if name[0] == expression else f"{letters(expression)} in {name[1]}", name[1]


def letters(expression: str) -> str:
    """An expression as a sentence has it."""
    return LETTERS.get(expression, f"`{expression}`")


def _lines(error: Mutation) -> list[int]:
    """Where an equation may be stated: beside the expression, its statement, or the loop around it."""
    syntax, node = place_of(error)
    statement, *around = (x for x in syntax.around(node) if isinstance(x, ast.stmt))
    loops = [x.lineno for x in around if isinstance(x, ast.For)]
    return [error.line, *(syntax.first + line - 1 for line in (statement.end_lineno or 0, *loops))]


def _place(error: Mutation, model: Model, link: int | None) -> str:
    """Where, as the end of a sentence; empty for what is in no link or joint."""
    if error.function == "newton_euler" and "parents[i]" not in error.original:
        return ""
    places = PLACES.get(error.function, f"every {error.function.partition('.')[0].lower()} joint")
    if link is None:
        return f" at {places}"
    return f" at {(model.links if places == 'every link' else model.joints)[link].name}"
