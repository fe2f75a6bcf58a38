"""The floating-point types that a program can compute in."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class FloatType:
    """A type of numbers.

    Attributes:
        name: NumPy's.
        c_name: that in C, and in LLVM's assembly.
        bits: of a number.
    """

    name: str
    c_name: str
    bits: int

    @property
    def size(self) -> int:
        """Bytes of a number."""
        return self.bits // 8


FLOAT64 = FloatType("float64", "double", 64)
