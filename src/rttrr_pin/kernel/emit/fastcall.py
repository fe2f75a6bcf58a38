"""A compiled function as a Python function, for calls that may cost no more than a microsecond.

ctypes and the buffer protocol take longer to hand over four arrays than the dynamics of one state take. The compiled
function gets CPython's own argument vector (METH_FASTCALL) instead and reads NumPy's arrays where they lie, as every
compiled extension does.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache

import numpy as np

from rttrr_pin.kernel.emit.layout import NDARRAY

METH_FASTCALL = 0x0080


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
    put = ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.py_object)(set_context)
    for place, item in enumerate((np.ndarray, np.dtype(np.float64), None, True)):
        put(place, item)
    method = _Method(b"one", address, METH_FASTCALL, None)
    _alive.append(method)
    make = ctypes.pythonapi.PyCFunction_NewEx
    make.restype, make.argtypes = ctypes.py_object, (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)
    function: Callable[..., bool | None] = make(ctypes.addressof(method), None, None)
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
