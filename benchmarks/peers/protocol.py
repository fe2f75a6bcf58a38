"""What all peers share: reading states, mapping joints by name, timing, writing.

A peer is one script: `python PEER.py STATES.npz ROBOT.urdf OUT.npz --threads T --repeats R`. It defines `prepare`,
which loads the robot, lays out the inputs as its library likes them, and returns the work to be timed. Libraries are
imported in `prepare`, after the process has been given its cores: most thread pools look at them once.

STATES.npz holds q, v, a (N, n), the names of the `joints` in that order, and `gravity` (3,). OUT.npz gets `tau`
(K, n) in the same order; K is less than N for peers too slow for all states. One line of JSON goes to stdout.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import tempfile
import time
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DROPPED = ("visual", "collision", "dynamics", "mimic")
"""Elements that have no part in tau, or that libraries read differently: meshes, damping, friction, followers."""

SHORTEST = 0.02
"""The shortest time that is measured [s]; quicker work is repeated within it."""


@dataclass(frozen=True)
class Follower:
    """A joint with <mimic>: q = multiplier q_leader + offset."""

    leader: str
    multiplier: float
    offset: float


@dataclass(frozen=True)
class Job:
    """The states and the robot.

    Attributes:
        urdf: path of the robot's file as it is.
        q: coordinates, (N, n) [rad or m]; v and a likewise.
        joints: names of the columns.
        gravity: in the base frame, (3,) [m/s^2].
        threads: how many to use.
    """

    urdf: Path
    q: Array
    v: Array
    a: Array
    joints: tuple[str, ...]
    gravity: Array
    threads: int

    @property
    def followers(self) -> dict[str, Follower]:
        """The joints that follow another, by name."""
        found = {}
        for joint in ET.parse(self.urdf).getroot().findall("joint"):
            mimic = joint.find("mimic")
            if mimic is not None and joint.get("type") != "fixed":
                multiplier, offset = float(mimic.get("multiplier", 1)), float(mimic.get("offset", 0))
                found[joint.attrib["name"]] = Follower(mimic.attrib["joint"], multiplier, offset)
        return found

    def bare_urdf(self) -> str:
        """The robot's text without the elements of `DROPPED`, so that followers are joints of their own.

        An inertial's <origin>, which URDF lets one leave out and adam does not, is written out.
        """
        root = ET.parse(self.urdf).getroot()
        for parent in [*root.findall("link"), *root.findall("joint")]:
            for child in [child for child in parent if child.tag in DROPPED]:
                parent.remove(child)
        for child in [child for child in root if child.tag in ("gazebo", "transmission")]:
            root.remove(child)
        for inertial in root.iter("inertial"):
            if inertial.find("origin") is None:
                ET.SubElement(inertial, "origin", xyz="0 0 0", rpy="0 0 0")
        return ET.tostring(root, encoding="unicode")

    @property
    def tree(self) -> dict[str, tuple[str, str]]:
        """The parent and the child link of each joint, fixed ones too."""
        ends = {}
        for joint in ET.parse(self.urdf).getroot().findall("joint"):
            parent, child = (joint.find(end) for end in ("parent", "child"))
            if parent is not None and child is not None:
                ends[joint.attrib["name"]] = (parent.attrib["link"], child.attrib["link"])
        return ends

    @property
    def root_link(self) -> str:
        """The link that no joint carries."""
        parents, children = (set(links) for links in zip(*self.tree.values(), strict=True))
        return min(parents - children)

    @contextmanager
    def bare_file(self) -> Iterator[str]:
        """The path of a file with `bare_urdf`, for libraries that read no text."""
        with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
            file.write(self.bare_urdf())
            file.flush()
            yield file.name

    def columns(self, names: Sequence[str]) -> tuple[Array, Array, Array]:
        """q, v, a with one C-ordered column for each of the library's joints, followers as they follow."""
        followers, place = self.followers, {name: k for k, name in enumerate(self.joints)}
        parts: tuple[list[Array], ...] = ([], [], [])
        for name in names:
            follower = followers.get(name, Follower(name, 1.0, 0.0))
            k = place[follower.leader]
            for part, x, offset in zip(parts, (self.q, self.v, self.a), (follower.offset, 0.0, 0.0), strict=True):
                part.append(follower.multiplier * x[:, k] + offset)
        q, v, a = (np.ascontiguousarray(np.stack(part, axis=1)) for part in parts)
        return q, v, a

    def torques(self, names: Sequence[str], tau: Array) -> Array:
        """Tau of the library's joints, (K, names), as the columns of the states: a follower adds to its leader."""
        followers, out = self.followers, np.zeros((len(tau), len(self.joints)))
        for name, column in zip(names, np.asarray(tau, dtype=np.float64).T, strict=True):
            follower = followers.get(name, Follower(name, 1.0, 0.0))
            out[:, self.joints.index(follower.leader)] += follower.multiplier * column
        return out


@dataclass(frozen=True)
class Work:
    """What a peer times.

    Attributes:
        run: computes tau of all states of the job.
        result: tau of the last run, (N, n), in the order of the job.
        note: what the figure is of.
    """

    run: Callable[[], object]
    result: Callable[[], Array]
    note: str = ""


Prepare = Callable[[Job], Work]


def read(states: Path, urdf: Path, threads: int, most: int | None = None) -> Job:
    """The job of a file of states; `most` cuts it to the first few."""
    with np.load(states) as file:
        q, v, a = (np.ascontiguousarray(file[name][:most]) for name in "qva")
        return Job(urdf, q, v, a, tuple(map(str, file["joints"])), file["gravity"], threads)


def timed(run: Callable[[], object], calls: int = 1) -> float:
    """The mean wall time of some calls [s]."""
    start = time.perf_counter()
    for _ in range(calls):
        run()
    return (time.perf_counter() - start) / calls


def calls_for(run: Callable[[], object]) -> int:
    """How many calls make a measurement long enough, after a first one that warms up."""
    run()
    return max(1, math.ceil(SHORTEST / timed(run)))


def give_cores(threads: int) -> None:
    """Let this process have as many cores as threads; both OpenMP and thread pools keep to it."""
    os.environ["OMP_NUM_THREADS"] = str(threads)
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[-threads:])


def serve(packages: Sequence[str], prepare: Prepare, most: int | None = None) -> None:
    """Run a peer as a script.

    Args:
        packages: the distributions whose versions are reported.
        prepare: loads, lays out, and returns the work.
        most: how many states a slow peer times.
    """
    parser = argparse.ArgumentParser()
    for name in ("states", "urdf", "out"):
        parser.add_argument(name, type=Path)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--repeats", type=int, default=5)
    chosen = parser.parse_args()
    give_cores(chosen.threads)
    job = read(chosen.states, chosen.urdf, chosen.threads, most)
    work = prepare(job)
    calls = calls_for(work.run)
    seconds = [timed(work.run, calls) for _ in range(chosen.repeats)]
    np.savez(chosen.out, tau=work.result())
    line: dict[str, Any] = {
        "peer": Path(parser.prog).stem,
        "version": ", ".join(f"{package} {metadata.version(package)}" for package in packages),
        "threads": chosen.threads,
        "states": len(job.q),
        "seconds": seconds,
        "note": work.note,
    }
    print(json.dumps(line))
