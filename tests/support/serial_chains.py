"""Serial chains as URDF text: some made to be awkward, and any number of random ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

RANDOM_TYPES = ("revolute", "continuous", "prismatic", "fixed")


def numbers(values: ArrayLike) -> str:
    return " ".join(repr(float(x)) for x in np.ravel(values))


def inertial(rng: np.random.Generator, scale: float = 1.0, turned: bool = True) -> str:
    """A link of three point masses: its tensor is that of a possible body, with all six entries."""
    masses = scale * rng.uniform(0.2, 2.0, 4)
    points = rng.uniform(-0.3, 0.3, (4, 3))
    com = masses @ points / masses.sum()
    r = points - com
    tensor = sum(m * (x @ x * np.eye(3) - np.outer(x, x)) for m, x in zip(masses, r, strict=True))
    entries = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    rpy = rng.uniform(-3, 3, 3) if turned else np.zeros(3)
    written = " ".join(f'{name}="{float(tensor[at])!r}"' for name, at in entries.items())
    return (
        f'<inertial><origin xyz="{numbers(com)}" rpy="{numbers(rpy)}"/>'
        f'<mass value="{float(masses.sum())!r}"/><inertia {written}/></inertial>'
    )


def joint(
    i: int, kind: str, parent: str, child: str, xyz: ArrayLike, rpy: ArrayLike, axis: ArrayLike = (0, 0, 1)
) -> str:
    limit = "" if kind == "fixed" else '<limit lower="-2" upper="2" velocity="3" effort="10"/>'
    moves = "" if kind == "fixed" else f'<axis xyz="{numbers(axis)}"/>'
    return (
        f'<joint name="joint_{i}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{numbers(xyz)}" rpy="{numbers(rpy)}"/>{moves}{limit}</joint>'
    )


def random_chain(seed: int, types: tuple[str, ...]) -> str:
    """A chain of joints of the given types at random placements about random axes, massive links throughout."""
    rng = np.random.default_rng(seed)
    links, joints = ['<link name="base"/>'], []
    for i, kind in enumerate(types, start=1):
        parent = f"link_{i - 1}" if i > 1 else "base"
        axis = rng.normal(size=3)
        links.append(f'<link name="link_{i}">{inertial(rng)}</link>')
        joints.append(
            joint(
                i,
                kind,
                parent,
                f"link_{i}",
                rng.uniform(-0.5, 0.5, 3),
                rng.uniform(-3, 3, 3),
                axis / np.linalg.norm(axis),
            )
        )
    return f'<robot name="chain_{seed}">{"".join(links + joints)}</robot>'


EXAMPLES = {
    "any-axes": random_chain(1, ("revolute", "prismatic", "revolute", "prismatic", "revolute", "revolute")),
    "fixed-first": random_chain(2, ("fixed", "revolute", "prismatic", "revolute")),
    "fixed-between": random_chain(3, ("revolute", "fixed", "fixed", "prismatic", "fixed", "revolute", "fixed")),
    "continuous": random_chain(4, ("continuous", "prismatic", "continuous")),
    "one-joint": random_chain(5, ("prismatic",)),
    "no-joint": random_chain(6, ("fixed", "fixed")),
}
"""Chains that each hold something that is easily got wrong."""
