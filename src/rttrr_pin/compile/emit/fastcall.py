"""A compiled function as a Python function (METH_FASTCALL), for calls that may cost no more than a microsecond.

ctypes takes longer to hand over four arrays than the dynamics of one state take.
"""

from __future__ import annotations

import ctypes
from functools import cache
from importlib import import_module

import llvmlite.binding as llvm

from rttrr_pin.compile.emit import One

METH_FASTCALL = 0x0080

NUMPY_API = {"PyArray_Type": 2, "PyArray_New": 93, "PyArray_GetPtr": 160}
"""Places in NumPy's table of its C API, as in its header `__multiarray_api.h`: they never change."""


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


@cache
def link_numpy() -> None:
    """Let compiled code find what it uses of NumPy, as `import_array()` does for extensions in C."""
    get = ctypes.PYFUNCTYPE(ctypes.POINTER(ctypes.c_void_p), ctypes.py_object, ctypes.c_char_p)(
        ("PyCapsule_GetPointer", ctypes.pythonapi)
    )
    table = get(import_module("numpy._core._multiarray_umath")._ARRAY_API, None)
    for name, place in NUMPY_API.items():
        llvm.add_symbol(name, table[place])


def python_function(address: int) -> One | None:
    """The compiled function at an address as a callable; None where pointers have not the 64 bits that it expects."""
    if ctypes.sizeof(ctypes.c_void_p) != 8:
        return None
    method = _Method(b"one", address, METH_FASTCALL, None)
    _alive.append(method)
    make = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)(
        ("PyCFunction_NewEx", ctypes.pythonapi)
    )
    function: One = make(ctypes.addressof(method), None, None)
    return function
