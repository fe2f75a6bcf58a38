"""The robots of the levels of `rttrr-pin conform`: `python docs/level_robots.py` writes urdf/levels/*.urdf.

They are no machines: each has what its level asks, and numbers without symmetry, so that no error hides. Each body is
six points of equal mass, so that its tensor is one that a body can have.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from rttrr_pin.modular_arm.build import significant

FOLDER = Path(__file__).parents[1] / "urdf" / "levels"

AXES = ("0 0 1", "0 1 0", "1 0 0", "0 0.6 0.8", "-0.6 0 0.8", "0.48 -0.6 0.64", "0 -1 0")
"""Those of the joints in turn; the components of the skew ones have two digits and a length of 1."""


class Writer:
    """One robot's elements, whose numbers come from a generator of its own.

    Attributes:
        lines: of the file so far.
    """

    def __init__(self, name: str, seed: int, mass: float = 2.0, reach: float = 0.3) -> None:
        """Begin a robot.

        Args:
            name: of it.
            seed: of its numbers.
            mass: of a link, about [kg].
            reach: from one joint to the next, about [m].
        """
        self.lines = [f'<robot name="{name}">']
        self.mass, self.reach = mass, reach
        self._rng = np.random.Generator(np.random.Philox(key=seed))

    def link(self, name: str, heavy: bool = True) -> None:
        """A link; one that is not heavy is a frame."""
        if not heavy:
            self.lines.append(f'  <link name="{name}"/>')
            return
        mass = self.mass * self._rng.uniform(0.5, 1.5)
        points = self._rng.uniform(-0.5, 0.5, (6, 3)) * self.reach
        com = points.mean(axis=0)
        r = points - com
        tensor = mass / 6 * (np.sum(r * r) * np.eye(3) - r.T @ r)
        entries = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
        inertia = " ".join(f'{key}="{_text([tensor[at]])}"' for key, at in entries.items())
        self.lines += [
            f'  <link name="{name}">',
            "    <inertial>",
            f'      <origin xyz="{_text(com)}" rpy="{_text(self._rng.uniform(-1.5, 1.5, 3))}"/>',
            f'      <mass value="{_text([mass])}"/>',
            f"      <inertia {inertia}/>",
            "    </inertial>",
            "  </link>",
        ]

    def joint(self, kind: str, parent: str, child: str, axis: str = "", inside: Sequence[str] = ()) -> str:
        """A joint and the link behind it, and the name of that link."""
        name = f"{child}_joint"
        xyz, rpy = self._rng.uniform(-1.0, 1.0, 3) * self.reach, self._rng.uniform(-1.5, 1.5, 3)
        body = [f'    <origin xyz="{_text(xyz)}" rpy="{_text(rpy)}"/>']
        body += [f'    <parent link="{parent}"/>', f'    <child link="{child}"/>']
        if kind != "fixed":
            body.append(f'    <axis xyz="{axis}"/>')
        if kind in ("revolute", "prismatic"):
            half, speed, effort = ("2.8", "3", "100") if kind == "revolute" else ("0.4", "1", "500")
            body.append(f'    <limit lower="-{half}" upper="{half}" velocity="{speed}" effort="{effort}"/>')
        self.lines += [f'  <joint name="{name}" type="{kind}">', *body, *inside, "  </joint>"]
        return child

    def arm(self, kinds: Sequence[str], parent: str, first: int = 1, inside: Sequence[str] = ()) -> str:
        """A chain of joints and heavy links, and the name of the last."""
        for k, kind in enumerate(kinds, first):
            self.link(f"link_{k}")
            parent = self.joint(kind, parent, f"link_{k}", AXES[k % len(AXES)], inside)
        return parent

    @property
    def text(self) -> str:
        """The file."""
        return "\n".join(['<?xml version="1.0"?>', *self.lines, "</robot>", ""])


def _text(numbers: Sequence[float] | np.ndarray) -> str:
    return " ".join(significant([float(x)]) for x in numbers)


R, P, C, X = "revolute", "prismatic", "continuous", "fixed"


def arm6() -> Writer:
    """Six revolute joints in a chain."""
    robot = Writer("arm6", 1)
    robot.link("base")
    robot.arm([R] * 6, "base")
    return robot


def tree() -> Writer:
    """A body with three limbs, one of which branches again."""
    robot = Writer("tree", 2)
    robot.link("base")
    trunk = robot.arm([R, P], "base")
    left = robot.arm([R, C, R], trunk, first=3)
    robot.arm([R, R], trunk, first=6)
    robot.arm([P], left, first=8)
    robot.arm([C], left, first=9)
    robot.arm([R, R], "base", first=10)
    return robot


def fixed() -> Writer:
    """Bodies on fixed joints: within the chain, beside it, at its end; and a frame."""
    robot = Writer("fixed", 3)
    robot.link("base")
    end = robot.arm([R, X, R], "base")
    robot.link("sensor")
    robot.joint(X, end, "sensor")
    end = robot.arm([P, X, X], end, first=4)
    robot.link("tool_frame", heavy=False)
    robot.joint(X, end, "tool_frame")
    robot.arm([R, X], end, first=7)
    return robot


def mimic() -> Writer:
    """Joints that follow others: further out, on another limb, with a slide of a turn, and at the end."""
    robot = Writer("mimic", 4)
    robot.link("base")
    end = robot.arm([R, R], "base")
    followers = [
        (R, end, 'multiplier="-1.5" offset="0.2"', "link_2_joint"),
        (P, end, 'multiplier="0.05" offset="0.1"', "link_1_joint"),
        (R, "base", 'multiplier="0.5"', "link_2_joint"),
    ]
    for k, (kind, parent, numbers, leader) in enumerate(followers, 3):
        robot.arm([kind], parent, k, [f'    <mimic joint="{leader}" {numbers}/>'])
    robot.arm([R], "link_3", 6)
    return robot


def effects() -> Writer:
    """Damping and friction in each joint; armature, which URDF has no word for, stands in the levels."""
    robot = Writer("effects", 5)
    robot.link("base")
    robot.arm([R, R, P, R], "base", inside=['    <dynamics damping="0.7" friction="1.3"/>'])
    return robot


def small() -> Writer:
    """A hand of grams and centimetres, whose tensors are about 1e-8 kg m^2."""
    robot = Writer("small", 6, mass=0.002, reach=0.01)
    robot.link("base")
    for finger in range(3):
        robot.arm([R, R, R], "base", first=3 * finger + 1)
    return robot


def sixty() -> Writer:
    """Sixty joints: a trunk of twenty, and four limbs of ten."""
    robot = Writer("sixty", 7, mass=1.0, reach=0.2)
    robot.link("base")
    robot.arm([R, R, R, R, P] * 4, "base")
    for limb, trunk in enumerate(("link_5", "link_10", "link_15", "link_20")):
        robot.arm([R, C, R, P, R] * 2, trunk, first=21 + 10 * limb)
    return robot


ROBOTS = (arm6, tree, fixed, mimic, effects, small, sixty)


def files() -> Iterator[tuple[Path, str]]:
    """Each file and what belongs in it."""
    for robot in ROBOTS:
        comment = f"{(robot.__doc__ or '').rstrip('.')}. Written by `python docs/level_robots.py`: do not edit."
        head, rest = robot().text.split("\n", 1)
        yield FOLDER / f"{robot.__name__}.urdf", f"{head}\n<!-- {comment} -->\n{rest}"


def main() -> int:
    """Write the files, or with --check say which are not what they should be."""
    changed = [path for path, text in files() if not path.exists() or path.read_text() != text]
    if "--check" in sys.argv[1:]:
        print(*(f"{path.name} is not what the script writes" for path in changed), sep="\n", file=sys.stderr)
        return int(bool(changed))
    FOLDER.mkdir(exist_ok=True)
    for path, text in files():
        path.write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
