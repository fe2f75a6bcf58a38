"""The robot as a user holds it: `load` one, ask it for inverse dynamics."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rttrr_pin.algebra import Scalar, Vector
from rttrr_pin.arithmetic import FLOAT, Load, evaluate
from rttrr_pin.errors import InputError, NumberError, ShapeError
from rttrr_pin.model import STANDARD_GRAVITY, LinkWrenches, Model, Wrench
from rttrr_pin.model.inputs import Coordinates, coordinates, vectors
from rttrr_pin.newton_euler import Wrenches

Array = NDArray[np.float64]

BLOCK = 4096
"""States computed at a time: the temporaries of one block stay in the cache, and memory does not grow with N."""


class Robot:
    """A robot and its inverse dynamics.

    Attributes:
        model: its links and joints as data.
    """

    def __init__(self, model: Model) -> None:
        self.model = model

    def __repr__(self) -> str:
        joints = ", ".join(f"{joint.name} ({joint.type})" for joint in self.model.moving)
        return f"<Robot {self.name!r}: {joints or 'no moving joint'}>"

    @property
    def name(self) -> str:
        """The robot's name in its file."""
        return self.model.name

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The moving joints: the last axis of q, v, a and tau."""
        return self.model.joint_names

    @property
    def link_names(self) -> tuple[str, ...]:
        """The links axis of F, N, f, n: every link but the root, which no joint carries."""
        return self.model.link_names

    def inverse_dynamics(
        self,
        q: Coordinates,
        v: Coordinates,
        a: Coordinates,
        payload: Wrench | Sequence[Wrench] | None = None,
    ) -> LinkWrenches:
        """Driving forces and all joint loads for given motion, by the Newton-Euler recursion.

            F_i = M_i v_dot_Ci                              (paper, equations 16-22)
            N_i = I_i w_dot_i + w_i x I_i w_i               (23-30)
            f_i = F_i + sum over children c of R_ic f_c     (31-43)
            n_i = N_i + r_Ci x F_i + sum over c of (R_ic n_c + p_ic x R_ic f_c)
            tau_i = n_i (revolute) or f_i (prismatic) along the axis

        Args:
            q: joint coordinates, (..., nv) [rad or m], or a dict by joint name.
            v: joint rates, (..., nv) [rad/s or m/s].
            a: joint accelerations, (..., nv) [rad/s^2 or m/s^2].
            payload: what the robot exerts on its surroundings; several where several links do. Leading axes
                broadcast with those of q, v, a.

        Returns:
            tau (..., nv) and F, N, f, n (..., links, 3), the latter in {i}, the frame of each link.

        Raises:
            ShapeError: an array has not one value for each joint, or leading axes do not broadcast.
            NumberError: a value is NaN, inf, complex, ..., or so large that the result overflows.
            UnknownNameError, MissingJointError: a dict's keys, or the payload's link, do not exist.
        """
        arrays = [coordinates(name, x, self.joint_names) for name, x in zip("qva", (q, v, a), strict=True)]
        loads = [self.load_of(wrench) for wrench in _as_list(payload)]
        batch = _batch_shape(arrays, loads)
        rows = int(np.prod(batch, dtype=np.int64))
        q_, v_, a_ = (np.broadcast_to(x, (*batch, x.shape[-1])).reshape(rows, x.shape[-1]) for x in arrays)
        flat_loads = [_flat(load, batch, rows) for load in loads]
        out = empty_wrenches(self.model, rows)
        for part in blocks(rows):
            states = (q_[part], v_[part], a_[part])
            with np.errstate(over="ignore", invalid="ignore"):  # looked for below, where the state can be named
                result = evaluate(self.model, FLOAT, *states, [load.block(part) for load in flat_loads])
            fill(out, part, result)
        _check_overflow(out, q_, v_, a_)
        shaped = {key: x.reshape(*batch, *x.shape[1:]) for key, x in out.items()}
        return LinkWrenches.of(shaped, self.link_names, self.joint_names)

    def load_of(self, wrench: Wrench) -> Load:
        """A user's wrench at the index of its link."""
        f, n = vectors("payload force", wrench.force), vectors("payload moment", wrench.moment)
        return Load(self.payload_link(wrench.link), f, n, wrench.expressed_in == "base")

    def payload_link(self, name: str | None) -> int:
        """The index of the link that a payload acts at; for None the only last link.

        Raises:
            UnknownNameError: no link is called so.
            InputError: there is no name, and not exactly one last link.
        """
        if name is not None:
            return self.model.link_index(name)
        leaves = self.model.leaves()
        if len(leaves) == 1:
            return leaves[0]
        names = ", ".join(self.link_names[i] for i in leaves) or "none"
        raise InputError(
            f"the payload names no link, and robot {self.name!r} has {len(leaves)} last links ({names}): "
            "pass Wrench(..., link=NAME)"
        )


def load(source: str | os.PathLike[str], gravity: ArrayLike = STANDARD_GRAVITY) -> Robot:
    """Load a robot.

    Args:
        source: the name of a bundled robot (`"rttrr"`), or the path of a URDF file.
        gravity: the gravity field in the base frame, (3,) [m/s^2]: a free body accelerates by it.

    Returns:
        The robot, its links and joints in Pinocchio's order for the same file.

    Raises:
        UnknownNameError: there is neither such a file nor such a bundled robot.
        UrdfError: the file cannot be used; the message says where and why.
        ShapeError, NumberError: gravity is no vector of three finite numbers.
    """
    from rttrr_pin.model.urdf import read_urdf  # loads yourdfpy, which takes a second

    field = vectors("gravity", gravity)
    if field.ndim != 1:
        raise ShapeError(
            f"gravity has shape {field.shape}, expected (3,): pass one vector, such as {STANDARD_GRAVITY}",
            name="gravity",
            got=field.shape,
            wanted="(3,)",
        )
    return Robot(read_urdf(source if isinstance(source, str) else Path(source)).with_gravity(field))


def blocks(rows: int, size: int = BLOCK) -> Iterator[slice]:
    """Consecutive slices that cover a batch."""
    return (slice(start, min(start + size, rows)) for start in range(0, rows, size))


def empty_wrenches(model: Model, rows: int) -> LinkWrenches:
    """Arrays for the results of a batch, not yet filled."""
    spatial = (rows, len(model.links), 3)
    arrays = {"tau": np.empty((rows, model.nv)), **{key: np.empty(spatial) for key in "FNfn"}}
    return LinkWrenches.of(arrays, model.link_names, model.joint_names)


def fill(out: LinkWrenches, part: slice, result: Wrenches) -> None:
    """Write the scalars of one block into the arrays of the batch."""
    _fill_columns(out.tau[part], result.tau)
    for key in ("F", "N", "f", "n"):
        vectors_: list[Vector] = getattr(result, key)
        for i, vector in enumerate(vectors_):
            _fill_columns(getattr(out, key)[part, i], list(vector))


def _fill_columns(out: Array, scalars: Sequence[Scalar]) -> None:
    for column, scalar in enumerate(scalars):
        out[:, column] = scalar


def _as_list(payload: Wrench | Sequence[Wrench] | None) -> list[Wrench]:
    """None, one or several wrenches as a list."""
    if payload is None:
        return []
    wrenches = [payload] if isinstance(payload, Wrench) else list(payload)
    for wrench in wrenches:
        if not isinstance(wrench, Wrench):
            raise InputError(
                f"payload is a {type(wrench).__name__}, expected a Wrench: pass Wrench(force=..., moment=...)"
            )
    return wrenches


def _batch_shape(arrays: Sequence[Array], loads: Sequence[Load]) -> tuple[int, ...]:
    """The common leading shape."""
    named = dict(zip("qva", (x.shape[:-1] for x in arrays), strict=True))
    for load in loads:
        named[f"payload force at link {load.link + 1}"] = load.f.shape[:-1]
        named[f"payload moment at link {load.link + 1}"] = load.n.shape[:-1]
    try:
        return np.broadcast_shapes(*named.values())
    except ValueError:
        shapes = ", ".join(f"{name}: {shape}" for name, shape in named.items())
        raise ShapeError(
            f"the leading axes do not broadcast ({shapes}): give all the same batch shape",
            name="q, v, a",
            got=(),
            wanted="leading axes that broadcast",
        ) from None


def _flat(load: Load, batch: tuple[int, ...], rows: int) -> Load:
    """The load with the batch on one axis."""
    f, n = (x if x.ndim == 1 else np.broadcast_to(x, (*batch, 3)).reshape(rows, 3) for x in (load.f, load.n))
    return Load(load.link, f, n, load.in_base)


def _check_overflow(out: LinkWrenches, q: Array, v: Array, a: Array) -> None:
    """Finite inputs whose results are not finite have overflowed; say where."""
    for key, x in out.items():
        if not np.isfinite(x).all():
            row = int(np.argwhere(~np.isfinite(x))[0][0])
            sizes = {name: float(np.abs(y[row]).max(initial=0.0)) for name, y in (("q", q), ("v", v), ("a", a))}
            largest = max(sizes, key=sizes.__getitem__)
            raise NumberError(
                f"{key} overflows in state {row}, where |{largest}| reaches {sizes[largest]:.3g}: "
                "pass coordinates of a size that a robot can have, in rad, m and s",
                name=largest,
                index=(row,),
                value=sizes[largest],
            )
