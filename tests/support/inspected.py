"""URDFs for the tests of inspection: one arm on a base, of any mass, inertia, joint and shape."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

ENTRIES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")

LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'


def inertial(
    mass: object = 1, tensor: Iterable[object] = (0.02, 0, 0, 0.02, 0, 0.02), xyz: str = "0 0 0", rpy: str = "0 0 0"
) -> str:
    """tensor: ixx, ixy, ixz, iyy, iyz, izz, as texts or numbers."""
    entries = " ".join(f'{name}="{value}"' for name, value in zip(ENTRIES, tensor, strict=True))
    return f'<inertial><origin xyz="{xyz}" rpy="{rpy}"/><mass value="{mass}"/><inertia {entries}/></inertial>'


def diagonal(*moments: object) -> tuple[object, ...]:
    return moments[0], 0, 0, moments[1], 0, moments[2]


def shape(tag: str, role: str = "collision", xyz: str = "0 0 0", rpy: str = "0 0 0") -> str:
    return f'<{role}><origin xyz="{xyz}" rpy="{rpy}"/><geometry>{tag}</geometry></{role}>'


def joint(
    name: str, parent: str, child: str, kind: str = "revolute", limit: str = LIMIT, origin: str = "", more: str = ""
) -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{origin}'
        f'<axis xyz="0 0 1"/>{limit}{more}</joint>'
    )


def arm(
    inside: str | None = None,
    *,
    base: str = "",
    kind: str = "revolute",
    limit: str = LIMIT,
    more: str = "",
    extra: str = "",
) -> str:
    """A base and one link that moves; `inside` is what stands in the link, `extra` what stands beside it."""
    return (
        f'<robot name="arm"><link name="base">{base}</link>'
        f'<link name="arm">{inertial() if inside is None else inside}</link>'
        f"{joint('swing', 'base', 'arm', kind, limit, more=more)}{extra}</robot>"
    )


def tip(inside: str, kind: str = "fixed", origin: str = '<origin xyz="0.1 0 0" rpy="0 0 0.5"/>', more: str = "") -> str:
    """A link on the arm."""
    return f'<link name="tip">{inside}</link>' + joint("hold", "arm", "tip", kind, origin=origin, more=more)


def mirrored(left: Mapping[str, object], right: Mapping[str, object], apart: float = 0.0) -> str:
    """Two links whose names differ in their side, each with the arguments of `inertial`; at y = apart and -apart."""
    links = "".join(
        f'<link name="{side}_hand">{inertial(**numbers)}</link>'  # type: ignore[arg-type]
        + joint(f"{side}_wrist", "base", f"{side}_hand", origin=f'<origin xyz="0 {y} 0"/>')
        for side, numbers, y in (("left", left, apart), ("right", right, -apart))
    )
    return f'<robot name="mirrored"><link name="base"/>{links}</robot>'
