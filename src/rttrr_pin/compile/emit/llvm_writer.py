"""Functions of LLVM written by a builder: what the code around a program is made of."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from llvmlite import ir

from rttrr_pin.compile.emit.llvm_vectors import LINE

I64, F64, F32, PTR, I1 = ir.IntType(64), ir.DoubleType(), ir.FloatType(), ir.PointerType(), ir.IntType(1)
I32 = ir.IntType(32)

SCALAR = {64: F64, 32: F32}
"""The type of numbers of so many bits."""


def number(x: int) -> ir.Constant:
    """An int64."""
    return ir.Constant(I64, x)


def untyped(address: ir.NamedValue) -> ir.NamedValue:
    """The address as LLVM sees it, of nothing in particular."""
    address.type = PTR
    return address


@dataclass
class Writer:
    """Writes one function."""

    builder: ir.IRBuilder

    def times(self, x: ir.Value, factor: int) -> ir.Value:
        """A multiple; a constant of a constant, which spares LLVM the folding."""
        return number(x.constant * factor) if isinstance(x, ir.Constant) else self.builder.mul(x, number(factor))

    def plus(self, x: ir.Value, term: int) -> ir.Value:
        """A sum, likewise."""
        return number(x.constant + term) if isinstance(x, ir.Constant) else self.builder.add(x, number(term))

    def offset(self, base: ir.Value, bytes_: ir.Value | int) -> ir.Value:
        """The address so many bytes further."""
        by = number(bytes_) if isinstance(bytes_, int) else bytes_
        if isinstance(by, ir.Constant) and by.constant == 0:
            return base
        return self.builder.gep(base, [by], source_etype=ir.IntType(8))

    def load(self, ir_type: ir.Type, address: ir.Value, align: int | None = None) -> ir.Value:
        """What stands at an address."""
        return self.builder.load(address, typ=ir_type, align=align)

    def store(self, value: ir.Value, address: ir.Value, align: int | None = None) -> None:
        """Write to an address."""
        self.builder.store(value, address, align=align)

    def prefetch(self, address: ir.Value, write: bool = False) -> None:
        """Fetch a line into the first level of the cache, if there is one at this address."""
        module, arguments = self.builder.module, [PTR, I32, I32, I32]
        name = "llvm.prefetch.p0"
        fetch = module.globals.get(name) or ir.Function(module, ir.FunctionType(ir.VoidType(), arguments), name)
        self.builder.call(fetch, [address, *(ir.Constant(I32, x) for x in (int(write), 3, 1))])

    @contextmanager
    def loop(self, stop: ir.Value, step: int = 1, start: ir.Value | None = None) -> Iterator[ir.Value]:
        """From start (0) to stop by step."""
        b = self.builder
        first, body_, after = (b.append_basic_block(name) for name in ("head", "body", "after"))
        before = b.block
        b.branch(first)
        b.position_at_end(first)
        i = b.phi(I64)
        i.add_incoming(start or number(0), before)
        b.cbranch(b.icmp_signed("<", i, stop), body_, after)
        b.position_at_end(body_)
        yield i
        i.add_incoming(b.add(i, number(step)), b.block)
        b.branch(first)
        b.position_at_end(after)

    def memory(self, ir_type: ir.Type, count: int = 1) -> ir.Value:
        """Memory of this function's own, on a cache line."""
        memory = self.builder.alloca(ir_type, count)
        memory.align = LINE
        return untyped(memory)

    def aligned(self, address: ir.Value) -> ir.Value:
        """The next address on a cache line."""
        b = self.builder
        return b.inttoptr(b.and_(b.add(b.ptrtoint(address, I64), number(LINE - 1)), number(-LINE)), PTR)

    def require(self, condition: ir.Value, otherwise: ir.Block) -> None:
        """Go on where the condition holds."""
        on = self.builder.append_basic_block("on")
        self.builder.cbranch(condition, on, otherwise)
        self.builder.position_at_end(on)

    def least(self, x: ir.Value, y: ir.Value) -> ir.Value:
        """The smaller of two."""
        return self.builder.select(self.builder.icmp_signed("<", x, y), x, y)


def function(
    module: ir.Module, name: str, result: ir.Type, arguments: Sequence[ir.Type], internal: bool = True
) -> tuple[ir.Function, Writer]:
    """A new function and what writes it; an internal one keeps its code to itself, and is not copied into others."""
    function = ir.Function(module, ir.FunctionType(result, arguments), name)
    if internal:
        function.linkage = "internal"
        function.attributes.add("noinline")
    return function, Writer(ir.IRBuilder(function.append_basic_block("start")))
