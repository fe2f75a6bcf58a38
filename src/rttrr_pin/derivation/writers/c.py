"""Closed forms as C99: one function for each quantity, and a structure with the robot's numbers."""

from __future__ import annotations

from collections.abc import Iterator
from textwrap import wrap

from rttrr_pin.compile.emit.c import identifier
from rttrr_pin.derivation import QUANTITIES, Derivation
from rttrr_pin.derivation.quantities import Index
from rttrr_pin.derivation.tree import Sum
from rttrr_pin.derivation.writers import wording as words
from rttrr_pin.derivation.writers.glossary import parameters
from rttrr_pin.derivation.writers.routines import WIDTH, Language, Routine, arguments, routine, width

C = Language(
    power=lambda name, power: " * ".join([name] * power),
    sine="sin({})",
    cosine="cos({})",
    sign="(double)(({0} > 0.0) - ({0} < 0.0))",
    parameter="parameters->{}",
)


def c(derivation: Derivation, preface: str = "") -> str:
    """A file that needs nothing but the C library.

    Args:
        derivation: what to write.
        preface: a paragraph to put before all others.
    """
    robot = identifier(derivation.robot.model.name)
    routines = [
        routine(derivation, name) for name in derivation.quantities if 0 not in derivation.quantities[name].shape
    ]
    parts = ["\n".join(_comment(derivation, preface)), "#include <math.h>"]
    if any(True for _ in parameters(derivation)):
        parts.append("\n".join(_parameters(derivation, robot)))
    return "\n\n".join([*parts, *("\n".join(_function(derivation, code, robot)) for code in routines)]) + "\n"


def _comment(derivation: Derivation, preface: str) -> Iterator[str]:
    model = derivation.robot.model
    yield f"/* Dynamic model of {words.plain(model.name)}: {', '.join(derivation.quantities)}."
    meaning = arguments(derivation)
    texts = [*([preface] if preface else []), *words.conventions(derivation)]
    texts.append(f"Links and joints: {words.names_of_links(model)}.")
    texts += [f"{x}: {meaning[x]}." for x in ("q", "v", "a", "payload")]
    texts.append("Results go to out. Nothing is allocated, kept or checked. Compile as C99.")
    for text in texts:
        yield ""
        yield from wrap(text.replace("*/", "* /"), WIDTH, initial_indent="   ", subsequent_indent="   ")
    yield "*/"


def _parameters(derivation: Derivation, robot: str) -> Iterator[str]:
    """The structure, and one with the numbers of the file."""
    entries = list(parameters(derivation))
    yield f"struct {robot}_parameters {{"
    for entry in entries:
        yield f"    double {entry.symbol.name}; /* {entry.meaning} [{entry.unit}] */"
    yield "};"
    yield ""
    yield f"const struct {robot}_parameters {robot}_of_file = {{"
    yield from (f"    {entry.value!r}, /* {entry.symbol.name} */" for entry in entries)
    yield "};"


def _function(derivation: Derivation, code: Routine, robot: str) -> Iterator[str]:
    quantity, shape = QUANTITIES[code.name], derivation.quantities[code.name].shape
    declared = [f"const double {x}[{max(1, width(derivation, x))}]" for x in code.inputs]
    if any(True for _ in parameters(derivation)):
        declared.insert(0, f"const struct {robot}_parameters *parameters")
    out = "double out" + "".join(f"[{length}]" for length in shape)
    yield f"/* {quantity.meaning[0].upper()}{quantity.meaning[1:]} [{quantity.unit}]. */"
    yield from wrap(f"void {robot}_{code.name}({', '.join([*declared, out])})", WIDTH, subsequent_indent="    ")
    yield "{"
    definitions = {name: C.definition(name, derivation) for name in code.symbols}
    for argument in (x.rpartition(" ")[2].partition("[")[0].lstrip("*") for x in declared):
        if not any(f"{argument}[" in text or f"{argument}->" in text for text in definitions.values()):
            yield f"    (void){argument};"
    yield from (f"    const double {name} = {text};" for name, text in definitions.items())
    for name, expression in code.steps:
        yield from _assigned(f"const double {name}", expression)
    for at, entry in code.entries:
        if isinstance(entry, Sum):
            yield from _assigned(_place(at), entry)
        else:
            yield f"    {_place(at)} = {_place(entry)};"
    yield "}"


def _place(at: Index) -> str:
    return "out" + "".join(f"[{k}]" for k in at)


def _assigned(name: str, expression: Sum) -> Iterator[str]:
    first, *others = C.expression(expression, WIDTH - 8)
    if not others and len(name) + len(first) < WIDTH - 8:
        yield f"    {name} = {first};"
        return
    yield f"    {name} ="
    yield from (f"        {line}" for line in [first, *others][:-1])
    yield f"        {[first, *others][-1]};"
