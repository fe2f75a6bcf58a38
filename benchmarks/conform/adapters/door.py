"""The door that all adapters share: a robot and states in the project's conventions, one library behind it.

An adapter is one script, run by the interpreter of its library's environment:

    python ADAPTER.py {urdf} {base} {gravity} {effects}                        answers states
    python ADAPTER.py {urdf} {base} {gravity} {effects} --float float32        the same in float32
    python ADAPTER.py ... --time STATES.npz --counts 1 256                     times the library's own batch form
    python ADAPTER.py --about                                                  versions, call and conventions

The first two lines, as they stand, are subjects of `rttrr-pin conform`, which fills in the robot. States are JSON lines
on stdin and replies JSON lines on stdout, as docs/notation.md has them. What a library has no call for ends with
`not offered: ...`; what it refuses is told in its own words.

A library is a class: `__init__` loads the robot, `inputs` turns states into the library's conventions, `run` is the
call as its users write it, `results` turns what it returned back. Only `run` is timed.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import sys
import tempfile
import textwrap
import time
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

SHORTEST = 0.02
"""The shortest time that is measured [s]; quicker work is repeated within it."""

REPEATS = 3

LONGEST = 6.0
"""Seconds that one measurement may take; a library too slow for all states is timed on the first of them."""


class NotOfferedError(Exception):
    """The library has no call for this; the message says for what."""


@dataclass(frozen=True)
class Joint:
    """A joint in the project's order; `q` and `v` say where its coordinates and rates stand, if any."""

    name: str
    type: str
    parent: str
    child: str
    q: slice
    v: slice
    follows: str
    armature: float = 0.0
    damping: float = 0.0
    friction: float = 0.0


@dataclass(frozen=True)
class Payload:
    """What a link exerts on its surroundings: force and moment at its origin, in link axes, (N, 3) each."""

    link: str
    f: Array
    n: Array


@dataclass(frozen=True)
class States:
    """States in the project's conventions: q (N, nq), v and a (N, nv)."""

    q: Array
    v: Array
    a: Array
    payload: tuple[Payload, ...] = ()

    def __len__(self) -> int:
        return len(self.q)

    def first(self, count: int) -> States:
        """The first few, repeated from the beginning where there are not so many."""
        at = np.arange(count) % len(self.q)
        return States(self.q[at], self.v[at], self.a[at])


@dataclass(frozen=True)
class Robot:
    """A robot: its file, and what the project read in it.

    Attributes:
        path: of the URDF, without shapes.
        text: the URDF.
        root: the link that no joint of the file carries.
        floating: whether the base floats.
        gravity: the field in base axes, (3,) [m/s^2].
        links: names; `joints[i]` carries `links[i]`.
    """

    path: str
    text: str
    root: str
    floating: bool
    gravity: Array
    links: tuple[str, ...]
    joints: tuple[Joint, ...]

    @classmethod
    def read(cls, path: Path, base: str, gravity: str, effects: str) -> Robot:
        """The robot of a URDF, its joints in the project's order: depth first, branches in the order of their names."""
        urdf = ET.parse(path).getroot()
        for link in urdf.iter("link"):
            for shape in [own for own in link if own.tag in ("visual", "collision")]:  # they may name files
                link.remove(shape)
        elements = {joint.get("name", ""): joint for joint in urdf.findall("joint")}
        ends = {name: [own.find(end).get("link", "") for end in ("parent", "child")]  # type: ignore[union-attr]
                for name, own in elements.items()}  # fmt: skip
        (root,) = {parent for parent, _ in ends.values()} - {child for _, child in ends.values()}
        floating, joints, by_joint = base == "floating", [], json.loads(effects)
        if floating:
            joints.append(Joint("root_joint", "floating", "", root, slice(0, 7), slice(0, 6), ""))
        waiting = [root]
        while waiting:
            link = waiting.pop()
            if link != root:
                name = next(name for name, (_, child) in ends.items() if child == link)
                mimic = elements[name].find("mimic")
                kind, follows = elements[name].get("type", ""), "" if mimic is None else mimic.get("joint", "")
                width = 0 if kind == "fixed" or follows else 1
                q, v = joints[-1].q.stop if joints else 0, joints[-1].v.stop if joints else 0
                own = by_joint.get(name, {})
                joints.append(Joint(name, kind, ends[name][0], link, slice(q, q + width), slice(v, v + width), follows,
                                    **own))  # fmt: skip
            carried = sorted((name for name, (parent, _) in ends.items() if parent == link), reverse=True)
            waiting += [ends[name][1] for name in carried]
        text = ET.tostring(urdf, encoding="unicode")
        field = np.array([float(x) for x in gravity.split(",")])
        links = tuple(joint.child for joint in joints)
        return cls(in_file(text), text, root, floating, field, links, tuple(joints))

    @property
    def nv(self) -> int:
        """The number of rates."""
        return max((joint.v.stop for joint in self.joints), default=0)

    @property
    def moving(self) -> list[Joint]:
        """The joints of one coordinate of their own, the floating base not among them."""
        return [joint for joint in self.joints if joint.v.stop - joint.v.start == 1 and not joint.follows]

    def joint(self, name: str) -> Joint:
        """The joint of a name."""
        return next(joint for joint in self.joints if joint.name == name)

    def carrier(self, link: str) -> Joint:
        """The joint that carries a link."""
        return next(joint for joint in self.joints if joint.child == link)

    def check_order(self, names: Sequence[str]) -> None:
        """Every moving joint is one of the library's, and no other is."""
        own = sorted(joint.name for joint in self.moving)
        if sorted(names) != own:
            raise SystemExit(f"the library has joints {sorted(names)}, the file {own}")

    def columns(self, names: Sequence[str]) -> tuple[list[int], list[int]]:
        """Where q and v of joints stand."""
        joints = [self.joint(name) for name in names]
        return [joint.q.start for joint in joints], [joint.v.start for joint in joints]


class Adapter:
    """One library. Class attributes say what it is, methods how it is called.

    Attributes:
        packages: distributions whose versions are told, the library itself first.
        offers: of "floating", "mimic", "payload", "armature", "damping", "friction", "branches", "prismatic".
        words: what is not offered, where more is to be said than its name.
        call: the call as a user writes it.
        conventions: what the adapter converts.
        names: the library's joints of one coordinate, in its order; set by `__init__`.
    """

    packages: ClassVar[tuple[str, ...]] = ()
    offers: ClassVar[frozenset[str]] = frozenset()
    words: ClassVar[Mapping[str, str]] = {}
    call: ClassVar[str] = ""
    conventions: ClassVar[str] = ""
    names: Sequence[str]
    result: Array

    def __init__(self, robot: Robot, real: type[np.floating[Any]]) -> None:
        """Load the robot."""
        self.robot, self.real = robot, real

    def inputs(self, states: States) -> Any:
        """States in the library's conventions: by default q, v, a of its joints in its order."""
        at_q, at_v = self.robot.columns(self.names)
        return tuple(np.ascontiguousarray(x[:, at], self.real) for x, at in ((states.q, at_q), (states.v, at_v),
                                                                             (states.a, at_v)))  # fmt: skip

    def run(self, inputs: Any) -> Any:
        """The library's call on all states: what is timed."""
        raise NotImplementedError

    def results(self, raw: Any, states: States) -> Mapping[str, Array]:
        """Results in the project's conventions: by default `raw` is tau of its joints in its order."""
        return {"tau": self.torques(np.asarray(raw), np.zeros((len(states), 0)))}

    def torques(self, tau: Array, base: Array) -> Array:
        """Tau (N, nv) from that of the library's joints and that of the base, (N, 6) or (N, 0)."""
        out = np.zeros((len(tau), self.robot.nv))
        out[:, : base.shape[1]] = base
        out[:, self.robot.columns(self.names)[1]] = tau
        return out

    def many(self, inputs: Any) -> Any:
        """The batch form that is timed, where it is another call than `run`."""
        return self.run(inputs)


def refuse(adapter: type[Adapter], robot: Robot) -> None:
    """Say so where the library has no call for what the robot needs."""
    needs = {
        "floating": (robot.floating, "a floating base"),
        "mimic": (any(joint.follows for joint in robot.joints), "joints that follow others"),
        "armature": (any(joint.armature for joint in robot.joints), "armature"),
        "damping": (any(joint.damping for joint in robot.joints), "damping of joints"),
        "friction": (any(joint.friction for joint in robot.joints), "Coulomb friction of joints"),
        "branches": (len({joint.parent for joint in robot.joints}) < len(robot.joints), "links that carry several"),
        "prismatic": (any(joint.type == "prismatic" for joint in robot.joints), "prismatic joints"),
    }
    if missing := [
        adapter.words.get(key, words) for key, (needed, words) in needs.items() if needed and key not in adapter.offers
    ]:
        raise NotOfferedError(", ".join(missing))


TREES = frozenset({"branches", "prismatic"})
"""What most libraries offer."""


def in_file(text: str) -> str:
    """The path of a file with a text, for libraries that read no text; it goes with the folder that `serve` makes."""
    with tempfile.NamedTemporaryFile("w", suffix=".urdf", dir=Path.cwd(), delete=False) as file:
        file.write(text)
    return file.name


def rotations(quaternions: Array) -> Array:
    """The matrices of quaternions (x, y, z, w), (N, 3, 3): from the body's axes to the world's."""
    x, y, z, w = np.moveaxis(quaternions, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def placements(q: Array) -> Array:
    """The matrices (N, 4, 4) of a floating base from our coordinates (N, 7)."""
    out = np.tile(np.eye(4), (len(q), 1, 1))
    out[:, :3, :3], out[:, :3, 3] = rotations(q[:, 3:7]), q[:, :3]
    return out


def turned(R: Array, x: Array) -> Array:
    """R x for each state."""
    return np.einsum("kij,kj->ki", R, x)


def back(R: Array, x: Array) -> Array:
    """R^T x for each state."""
    return np.einsum("kji,kj->ki", R, x)


def in_world(states: States) -> tuple[Array, Array, Array, Array, Array]:
    """Of a floating base, in world axes: R, velocity of its origin, angular velocity, and the accelerations of both."""
    R = rotations(states.q[:, 3:7])
    v, w, v_dot, w_dot = states.v[:, :3], states.v[:, 3:6], states.a[:, :3], states.a[:, 3:6]
    return R, turned(R, v), turned(R, w), turned(R, v_dot + np.cross(w, v)), turned(R, w_dot)


def serve(adapter: type[Adapter]) -> None:
    """Run an adapter as a script."""
    parser = argparse.ArgumentParser(description=sys.modules["__main__"].__doc__)
    parser.add_argument("urdf", type=Path, nargs="?")
    parser.add_argument("base", choices=("fixed", "floating"), nargs="?", default="fixed")
    parser.add_argument("gravity", nargs="?", default="0,0,-9.81")
    parser.add_argument("effects", nargs="?", default="{}")
    parser.add_argument("--float", choices=("float32", "float64"), default="float64", dest="real")
    parser.add_argument("--time", type=Path)
    parser.add_argument("--counts", type=int, nargs="+", default=[1])
    parser.add_argument("--about", action="store_true", help="versions and conventions, as JSON")
    chosen = parser.parse_args()
    replies = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)  # what libraries print is no reply
    for key in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[key] = "1"
    if chosen.real == "float64":
        os.environ["JAX_ENABLE_X64"] = "1"
    os.environ["JAX_PLATFORMS"] = "cpu"
    os.environ["JAX_COMPILATION_CACHE_DIR"] = str(Path(sys.prefix, "jax-cache"))
    os.environ["JAX_PERSISTENT_COMPILATION_CACHE_MIN_COMPILE_TIME_SECS"] = "1"
    if chosen.about:
        replies.write(json.dumps(_about(adapter)) + "\n")
        return
    urdf, states = (path and path.resolve() for path in (chosen.urdf, chosen.time))
    folder = tempfile.TemporaryDirectory()
    os.chdir(folder.name)  # what libraries write beside them goes with it
    try:
        robot = Robot.read(urdf, chosen.base, chosen.gravity, chosen.effects)
        refuse(adapter, robot)
        library = adapter(robot, np.dtype(chosen.real).type)
        if chosen.time:
            replies.write(json.dumps(_timed(library, states, chosen.counts)) + "\n")
        else:
            for line in sys.stdin:
                replies.write(_answer(library, json.loads(line)) + "\n")
    except NotOfferedError as missing:
        replies.write(json.dumps({"error": f"not offered: {missing}"}) + "\n")
    except Exception as error:
        said = textwrap.shorten(str(error), 140, placeholder=" ...")
        replies.write(json.dumps({"error": f"refused: {type(error).__name__}: {said}"}) + "\n")
        raise


def _about(adapter: type[Adapter]) -> dict[str, Any]:
    versions = {package: metadata.version(package) for package in adapter.packages}
    return {"versions": versions, "call": adapter.call, "conventions": adapter.conventions,
            "offers": sorted(adapter.offers)}  # fmt: skip


def _answer(library: Adapter, request: Mapping[str, Any]) -> str:
    """The reply to one state."""
    q, v, a = (np.array([request[key]], np.float64) for key in ("q", "v", "a"))
    loads = tuple(
        Payload(load["link"], np.array([load["f"]], float), np.array([load["n"]], float))
        for load in request.get("payload", ())
        if load["axes"] == "link"
    )
    if len(loads) < len(request.get("payload", ())):
        raise NotOfferedError("payloads in base axes")
    if loads and "payload" not in library.offers:
        raise NotOfferedError("a payload")
    states = States(q, v, a, loads)
    results = library.results(library.run(library.inputs(states)), states)
    return json.dumps({key: np.asarray(x[0], np.float64).tolist() for key, x in results.items()})


def _timed(library: Adapter, path: Path, counts: Sequence[int]) -> dict[str, Any]:
    """Nanoseconds a state of the library's batch form, by number of states: the fastest of some runs."""
    with np.load(path) as file:
        all_states = States(file["q"], file["v"], file["a"])
    found: dict[str, Any] = {}
    each = 0.0
    for count in counts:
        fewer = count if each * count <= LONGEST / REPEATS else max(1, int(LONGEST / REPEATS / each))
        inputs = library.inputs(all_states.first(fewer))
        run = library.run if count == 1 else library.many
        run(inputs)
        once = max(_seconds(run, inputs, 1), 1e-6)
        calls = max(1, math.ceil(SHORTEST / once))
        each = min(_seconds(run, inputs, calls) / fewer for _ in range(REPEATS))
        found[str(count)] = {"ns": 1e9 * each, "states": fewer}
    return found


def _seconds(run: Any, inputs: Any, calls: int) -> float:
    """Processor time of a call [s], which other programs on the machine leave alone."""
    start = time.process_time()
    for _ in range(calls):
        run(inputs)
    return (time.process_time() - start) / calls
