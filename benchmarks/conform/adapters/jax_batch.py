"""A JAX function of one state as a batch: jit of vmap."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
from door import Adapter


class JaxAdapter(Adapter):
    """`one` is the library's function of one state, a tuple of arrays; `run` is jit of vmap of it."""

    one: Callable[..., Any]
    compiled: ClassVar[Any] = None

    def run(self, inputs: Any) -> Any:
        import jax

        if self.compiled is None:
            self.compiled = jax.jit(jax.vmap(self.one))  # type: ignore[misc]
        return jax.block_until_ready(self.compiled(*inputs))


def as_real(arrays: Any, real: Any) -> tuple[Any, ...]:
    """NumPy arrays on JAX's device, in a float type."""
    import jax

    return tuple(jax.device_put(np.ascontiguousarray(x, real)) for x in arrays)
