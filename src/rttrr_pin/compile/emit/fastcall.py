"""A compiled function as a Python function, for calls that may cost no more than a microsecond.

ctypes and the buffer protocol take longer to hand over four arrays than the dynamics of one state take. The compiled
function gets CPython's own argument vector (METH_FASTCALL) instead and reads NumPy's arrays where they lie, as every
compiled extension does.
"""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable, Iterable
from functools import cache
from typing import Any

import numpy as np

from rttrr_pin.compile.emit.layout import NDARRAY

METH_VARARGS, METH_KEYWORDS, METH_FASTCALL = 0x0001, 0x0002, 0x0080

SIGNATURE = b"__call__(q, v=None, a=None, payload=None, out=None, threads=None)\n--\n\nSee Kernel."


Answer = Callable[..., Any]


class _Method(ctypes.Structure):
    """PyMethodDef."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("address", ctypes.c_void_p),
        ("flags", ctypes.c_int),
        ("doc", ctypes.c_char_p),
    )


_alive: list[object] = []
"""CPython keeps pointers to method definitions."""


def python_function(address: int, set_context: int) -> Callable[..., bool | None] | None:
    """The compiled function as a callable, or None where arrays do not lie in memory as it expects."""
    if not arrays_lie_as_expected():
        return None
    _set(set_context, enumerate((np.ndarray, np.dtype(np.float64), None, True)))
    return _made(_Method(b"one", address, METH_FASTCALL, None), None)


def python_call(
    address: int, set_context: int, general: Callable[..., Any], owner: object
) -> Callable[..., Any] | None:
    """The compiled function that answers f(q, v, a, out=out) itself, and hands all other calls to a general one.

    Args:
        address: of the function.
        set_context: of the function that tells it what to know.
        general: takes the calls that it declines; the owner must keep it.
        owner: lives as long as the callable.
    """
    if not arrays_lie_as_expected():
        return None
    _set(set_context, ((4, sys.intern("out")), (5, general)))
    return _made(_Method(b"__call__", address, METH_VARARGS | METH_KEYWORDS, SIGNATURE), owner)


def _set(set_context: int, items: Iterable[tuple[int, object]]) -> None:
    put = ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.py_object)(set_context)
    for place, item in items:
        put(place, item)


def _made(method: _Method, owner: object) -> Callable[..., Any]:
    """A builtin function; it keeps its owner alive."""
    _alive.append(method)
    make = ctypes.pythonapi.PyCFunction_NewEx
    make.restype = ctypes.py_object
    make.argtypes = (ctypes.c_void_p, ctypes.c_void_p if owner is None else ctypes.py_object, ctypes.c_void_p)
    function: Callable[..., Any] = make(ctypes.addressof(method), owner, None)
    return function


@cache
def arrays_lie_as_expected() -> bool:
    """Whether NumPy's arrays have their fields where `NDARRAY` says (they do not in free-threaded Python)."""
    probe = np.zeros((3, 5))[:, ::2]

    def word(at: int) -> int:
        return int(ctypes.c_int64.from_address(at).value)

    if object.__basicsize__ != NDARRAY["data"]:
        return False
    shape, strides = word(id(probe) + NDARRAY["shape"]), word(id(probe) + NDARRAY["strides"])
    return (
        word(id(probe) + NDARRAY["type"]) == id(np.ndarray)
        and word(id(probe) + NDARRAY["data"]) == probe.ctypes.data
        and ctypes.c_int.from_address(id(probe) + NDARRAY["ndim"]).value == 2
        and (word(shape), word(shape + 8)) == probe.shape
        and (word(strides), word(strides + 8)) == probe.strides
        and word(id(probe) + NDARRAY["descr"]) == id(np.dtype(np.float64))
        and bool(ctypes.c_int.from_address(id(probe) + NDARRAY["flags"]).value & 0x0100) == probe.flags.aligned
    )
