"""Where NumPy's arrays keep what compiled code reads: the layout behind NumPy's C API (PyArrayObject_fields)."""

NDARRAY = {"type": 8, "data": 16, "ndim": 24, "shape": 32, "strides": 40, "descr": 56, "flags": 64}
"""Offsets in bytes."""

TUPLE = {"size": 16, "items": 24}
"""Of a tuple (PyTupleObject)."""

C_CONTIGUOUS, ALIGNED, WRITEABLE = 0x0001, 0x0100, 0x0400
"""Bits of the flags."""
