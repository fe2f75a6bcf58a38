"""A compiled function as a Python function (METH_FASTCALL), for calls that may cost no more than a microsecond.

ctypes takes longer to hand over four arrays than the dynamics of one state take.
"""

from __future__ import annotations

import ctypes

import numpy as np

from rttrr_pin.compile.emit import One

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


def python_function(address: int, set_context: int) -> One | None:
    """The compiled function at an address as a callable; None where pointers have not the 64 bits that it expects."""
    if ctypes.sizeof(ctypes.c_void_p) != 8:
        return None
    tell = ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.py_object)(set_context)
    for place, item in enumerate((np.ndarray, None)):
        tell(place, item)
    method = _Method(b"one", address, METH_FASTCALL, None)
    _alive.append(method)
    make = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)(
        ("PyCFunction_NewEx", ctypes.pythonapi)
    )
    function: One = make(ctypes.addressof(method), None, None)
    return function
