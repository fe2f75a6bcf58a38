"""Closed forms as a Python module over NumPy: one function for each quantity, for one state or any batch."""

from __future__ import annotations

from collections.abc import Iterator
from textwrap import wrap

from rttrr_pin.derivation import QUANTITIES, Derivation
from rttrr_pin.derivation.tree import Sum
from rttrr_pin.derivation.writers import wording as words
from rttrr_pin.derivation.writers.glossary import parameters
from rttrr_pin.derivation.writers.routines import WIDTH, Language, Routine, arguments, routine, width

PYTHON = Language(
    power=lambda name, power: name if power == 1 else f"{name}**{power}",
    sine="np.sin({})",
    cosine="np.cos({})",
    sign="np.sign({})",
    parameter='parameters["{}"]',
)

HELPERS = '''
def _columns(name, values, count):
    """The last axis in front, after a look at its length."""
    values = np.asarray(values, dtype=float)
    if values.ndim == 0 or values.shape[-1] != count:
        raise ValueError(f"{name} has shape {values.shape}, expected (..., {count})")
    return np.moveaxis(values, -1, 0)


def _array(entries, shape, *inputs):
    """The entries as one array, the batch in front."""
    batch = np.broadcast_shapes(*(x.shape[1:] for x in inputs))
    entries = [np.broadcast_to(entry, batch) for entry in entries]
    return np.stack(entries, axis=-1).reshape(*batch, *shape) if entries else np.zeros((*batch, *shape))
'''


def python(derivation: Derivation, preface: str = "") -> str:
    """A module that needs nothing but NumPy.

    Args:
        derivation: what to write.
        preface: a paragraph to put before all others.
    """
    model = derivation.robot.model
    names = ", ".join(derivation.quantities)
    texts = [f"Dynamic model of {words.plain(model.name)}: {names}."]
    texts += [*([preface] if preface else []), *words.conventions(derivation)]
    texts.append(f"Links and joints: {words.names_of_links(model)}.")
    head = "\n\n".join("\n".join(wrap(text, WIDTH)) for text in texts)
    parts = [f'"""{head}\n"""\n\nimport numpy as np\n', "\n".join(_parameters(derivation)), HELPERS]
    parts += ["\n".join(["", *_function(derivation, routine(derivation, name)), ""]) for name in derivation.quantities]
    return "\n".join(parts)


def _parameters(derivation: Derivation) -> Iterator[str]:
    yield "PARAMETERS = {"
    for entry in parameters(derivation):
        yield f'    "{entry.symbol.name}": {entry.value!r},  # {entry.meaning} [{entry.unit}]'
    yield "}"
    yield '"""The numbers of the robot\'s file."""'


def _function(derivation: Derivation, code: Routine) -> Iterator[str]:
    inputs = [f"{x}=(0.0,) * 6" if x == "payload" else x for x in code.inputs]
    yield f"def {code.name}({', '.join([*inputs, 'parameters=PARAMETERS'])}):"
    yield from _docstring(derivation, code)
    for x in code.inputs:
        yield f'    {x} = _columns("{x}", {x}, {width(derivation, x)})'
    for name in code.symbols:
        yield f"    {name} = {PYTHON.definition(name, derivation)}"
    for name, expression in code.steps:
        yield from _assigned(name, expression)
    names = {at: f"entry_{k}" for k, (at, _) in enumerate(code.entries)}
    for at, entry in code.entries:
        if isinstance(entry, Sum):
            yield from _assigned(names[at], entry)
        else:
            yield f"    {names[at]} = {names[entry]}"
    yield f"    entries = [{', '.join(names.values())}]"
    yield f"    return _array(entries, {derivation.quantities[code.name].shape}, {', '.join(code.inputs)})"


def _assigned(name: str, expression: Sum) -> Iterator[str]:
    first, *others = PYTHON.expression(expression, WIDTH - 8)
    if not others and len(name) + len(first) < WIDTH - 8:
        yield f"    {name} = {first}"
        return
    yield f"    {name} = ("
    yield from (f"        {line}" for line in (first, *others))
    yield "    )"


def _docstring(derivation: Derivation, code: Routine) -> Iterator[str]:
    quantity, meaning = QUANTITIES[code.name], arguments(derivation)
    shape = ", ".join(map(str, derivation.quantities[code.name].shape))
    yield f'    """{quantity.meaning[0].upper()}{quantity.meaning[1:]}.'
    yield ""
    yield "    Args:"
    for x in code.inputs:
        text = f"{x}: (..., {width(derivation, x)}), {meaning[x]}."
        yield from wrap(text, WIDTH, initial_indent=" " * 8, subsequent_indent=" " * 12)
    yield "        parameters: the robot's numbers."
    yield ""
    yield "    Returns:"
    yield f"        (..., {shape}) [{quantity.unit}]."
    yield '    """'
