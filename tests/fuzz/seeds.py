"""The robots that are damaged: small ones that hold what the bundled arms do not, the arms, and example robots."""

from __future__ import annotations

from contextlib import suppress

LARGEST_SEED = 9000
"""Bytes; larger example robots are left out, to keep a case at milliseconds."""


INERTIAL = (
    '<inertial><origin xyz="0.1 -0.2 0.3" rpy="{rpy}"/><mass value="1.5"/>'
    '<inertia ixx="0.1" ixy="0.01" ixz="-0.02" iyy="0.2" iyz="0.03" izz="0.15"/></inertial>'
)
LIMIT = '<limit lower="-1.25" upper="1.5" velocity="2" effort="3"/>'


def _link(name: str, rpy: str = "0 0 0") -> str:
    return f'<link name="{name}">{INERTIAL.format(rpy=rpy)}</link>\n'


def _joint(name: str, kind: str, parent: str, child: str, more: str = "") -> str:
    axis = "" if kind in ("fixed", "floating") else '<axis xyz="0 0 1"/>'
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0.5 0 -0.25" rpy="0.1 0 0"/>{axis}{more}</joint>\n'
    )


SMALL = {
    "one": '<robot name="one">\n<link name="base"/>\n'
    + _link("a")
    + _joint("j", "revolute", "base", "a", LIMIT)
    + "</robot>",
    "tree": '<?xml version="1.0"?>\n<robot name="tree">\n<!-- a tree -->\n'
    + '<material name="m"><color rgba="1 0 0 1"/></material>\n'
    + "".join(_link(name, "0.1 0.2 0.3") for name in ("base", "a", "b", "c"))
    + _joint("j2", "prismatic", "base", "a", LIMIT)
    + _joint("j1", "continuous", "base", "b", '<dynamics damping="0.5" friction="0.25"/>')
    + _joint("j3", "fixed", "a", "c")
    + "</robot>",
    "mimic": '<robot name="hand">\n<link name="palm"/>\n'
    + "".join(_link(name) for name in ("f", "g", "h"))
    + _joint("j1", "revolute", "palm", "f", LIMIT)
    + _joint("j2", "revolute", "palm", "g", f'{LIMIT}<mimic joint="j1" multiplier="-2" offset="0.5"/>')
    + _joint("j3", "revolute", "g", "h", f'{LIMIT}<mimic joint="j2"/>')
    + "</robot>",
    "free": '<robot name="free">\n<link name="world"/>\n'
    + "".join(_link(name) for name in ("a", "b"))
    + _joint("p", "planar", "world", "a")
    + _joint("q", "floating", "a", "b")
    + "</robot>",
}
"""Robots that hold what the bundled arms do not: branches, turned inertias, followers, planar and floating joints."""


def seeds(with_examples: bool = True) -> dict[str, str]:
    """The texts that are damaged: small ones, the bundled arms, and small example robots if they are installed."""
    from rttrr_pin.errors import InputError
    from rttrr_pin.urdf.catalogue import bundled, examples

    files = dict(bundled())
    with suppress(InputError):
        found = examples() if with_examples else {}
        files |= {f"example:{name}": path for name, path in found.items() if path.stat().st_size <= LARGEST_SEED}
    return SMALL | {name: path.read_text(encoding="utf-8") for name, path in files.items()}
