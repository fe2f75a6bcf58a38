"""Sine and cosine on vectors as LLVM assembly: polynomials, and the C library where these do not reach."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from rttrr_pin.compile.expression import Op
from rttrr_pin.compile.sincos import sincos_in

if TYPE_CHECKING:
    from rttrr_pin.compile.emit.llvm_vectors import Layout, Lines, VectorCode

LIBRARY = {Op.SIN: "sin", Op.COS: "cos"}
"""Functions of C."""


def beyond(lines: Lines, q: str) -> str:
    """In which lanes an angle is too large for the polynomials, or NaN."""
    size = lines(f"call {lines.vector} @llvm.fabs.{lines.suffix}({lines.vector} {q})")
    return lines(f"fcmp ugt {lines.vector} {size}, {lines.splat(sincos_in(lines.float_type).largest)}")


def some(lines: Lines, mask: str) -> str:
    """Whether any lane is."""
    bits = lines(f"bitcast <{lines.lanes} x i1> {mask} to i{lines.lanes}")
    return lines(f"icmp ne i{lines.lanes} {bits}, 0")


def library(lines: Lines, name: str, q: str, far: str, near: str) -> str:
    """The C library's function in the lanes that lie beyond, in the others what is known."""
    v, own = lines.vector, lines.float_type.c_name
    new = near
    for lane in range(lines.lanes):
        x = lines(f"extractelement {v} {q}, i32 {lane}")
        x = x if own == "double" else lines(f"fpext {own} {x} to double")
        y = lines(f"call double @{name}(double {x})")
        y = y if own == "double" else lines(f"fptrunc double {y} to {own}")
        new = lines(f"insertelement {v} {new}, {own} {y}, i32 {lane}")
    return lines(f"select <{lines.lanes} x i1> {far}, {v} {new}, {v} {near}")


def mending(layout: Layout) -> Iterator[str]:
    """The functions `void mend_sin(ptr q, ptr s)` and `mend_cos`: a vector done over where its angles lie beyond."""
    for name in LIBRARY.values():
        lines = layout.lines()
        q, near = (lines(f"load {lines.vector}, ptr %{x}") for x in ("q", "s"))
        lines.do(f"store {lines.vector} {library(lines, name, q, beyond(lines, q), near)}, ptr %s")
        text = "\n".join(lines.text)
        yield f"define internal void @mend_{name}(ptr %q, ptr %s) noinline cold {{\n{text}\n  ret void\n}}\n"


def mend(code: VectorCode, nodes: Sequence[int]) -> None:
    """Do over what was passed on of these sines and cosines where an angle lies beyond the polynomials.

    One branch for all, behind all: as for the angles of any robot it is not taken, and nothing is kept for it.
    """
    lines, args, pitch = code.lines, code.program.graph.args, code.layout.pitch
    masks = [beyond(lines, code.get(angle)) for angle in dict.fromkeys(args[x][0] for x in nodes)]
    if not masks:
        return
    far = masks[0]
    for mask in masks[1:]:
        far = lines(f"or <{lines.lanes} x i1> {far}, {mask}")
    lines.do(f"br i1 {some(lines, far)}, label %far, label %near")
    lines.text.append("far:")
    for x in nodes:
        angle = args[x][0]
        read = code.program.graph.op[angle] is Op.INPUT
        column, base = (args[angle][0], "%q") if read else (code.passed[angle], "%b")
        places = (lines.at(*place) for place in ((base, column * pitch), ("%b", code.passed[x] * pitch)))
        lines.do(f"call void @mend_{LIBRARY[code.program.graph.op[x]]}({', '.join(f'ptr {at}' for at in places)})")
    lines.do("br label %near")
    lines.text.append("near:")
    code.label = "near"


def polynomials(lines: Lines, q: str) -> tuple[str, str]:
    """Sine and cosine for |q| up to `largest`; see `rttrr_pin.compile.sincos`."""
    splat, fma, op, bits, numbers = lines.splat, lines.fma, lines.op, lines.bits, sincos_in(lines.float_type)
    # Adding `round` rounds to an integer, whose last bits then are the quadrant: no conversion, and no branch.
    shifted = fma(q, splat(numbers.two_over_pi), splat(numbers.round))
    k = op("fsub", splat(numbers.round), shifted)  # minus the multiple of pi/2
    t = fma(k, splat(numbers.pio2[0]), q)
    second = op("fmul", k, splat(numbers.pio2[1]))
    r = op("fadd", t, second)
    lost = op("fsub", second, op("fsub", r, t))
    rest = fma(k, splat(numbers.pio2[2]), fma(k, splat(numbers.pio2[1]), lines.negated(second)))
    low = op("fadd", lost, rest)
    z = op("fmul", r, r)
    sine, cosine = (_horner(lines, z, terms) for terms in (numbers.sine, numbers.cosine))
    s = op("fadd", r, fma(op("fmul", r, z), sine, low))
    half = op("fmul", z, splat(0.5))
    w = op("fsub", splat(1.0), half)
    over = op("fsub", op("fsub", splat(1.0), w), half)
    tail = fma(op("fmul", z, z), cosine, over)
    c = op("fadd", w, fma(lines.negated(r), low, tail))
    top = lines.whole(lines.float_type.bits - 1)
    quadrant = lines(f"bitcast {lines.vector} {shifted} to {lines.integers}")
    odd = lines(f"icmp slt {lines.integers} {bits('shl', quadrant, top)}, {lines.whole(0)}")
    mask, v = f"<{lines.lanes} x i1>", lines.vector
    # Odd quadrants exchange sine and cosine; the second bit of k, of k + 1 for the cosine, is the sign.
    flips = [
        bits("shl", bits("lshr", n, lines.whole(1)), top) for n in (quadrant, bits("add", quadrant, lines.whole(1)))
    ]
    pair = (f"{v} {c}, {v} {s}", f"{v} {s}, {v} {c}")
    chosen = [lines(f"select {mask} {odd}, {both}") for both in pair]
    s, c = (_sign_flipped(lines, x, flip) for x, flip in zip(chosen, flips, strict=True))
    return s, c


def _sign_flipped(lines: Lines, x: str, flip: str) -> str:
    bits = lines.bits("xor", lines(f"bitcast {lines.vector} {x} to {lines.integers}"), flip)
    return lines(f"bitcast {lines.integers} {bits} to {lines.vector}")


def _horner(lines: Lines, z: str, terms: tuple[float, ...]) -> str:
    value = lines.splat(terms[-1])
    for term in reversed(terms[:-1]):
        value = lines.fma(value, z, lines.splat(term))
    return value
