"""Inverse dynamics of a chain of revolute, prismatic and fixed joints, in plain NumPy: what is tested here."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np

GRAVITY = np.array([0.0, 0.0, -9.81])


def numbers(element: ElementTree.Element | None, attribute: str) -> np.ndarray:
    text = None if element is None else element.get(attribute)
    return np.array((text or "0 0 0").split(), dtype=float)


def rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    x, y, z = axis
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def of_rpy(rpy: np.ndarray) -> np.ndarray:
    x, y, z = np.eye(3)
    return rotation(z, rpy[2]) @ rotation(y, rpy[1]) @ rotation(x, rpy[0])


def read_chain(path: str | Path) -> list[tuple]:
    """Of each link: type, axis, R and p of the joint; mass, centre of mass and tensor about it, in link axes."""
    robot = ElementTree.parse(path).getroot()
    links = {link.get("name"): link.find("inertial") for link in robot.iter("link")}
    parents = {joint.find("parent").get("link"): joint for joint in robot.iter("joint")}
    name = next(iter(links.keys() - {joint.find("child").get("link") for joint in parents.values()}))
    chain = []
    while name in parents:
        joint = parents[name]
        name, origin, inertial = (
            joint.find("child").get("link"),
            joint.find("origin"),
            links[joint.find("child").get("link")],
        )
        mass, com, tensor = 0.0, np.zeros(3), np.zeros((3, 3))
        if inertial is not None:
            mass, com = float(inertial.find("mass").get("value")), numbers(inertial.find("origin"), "xyz")
            entries = {key: float(value) for key, value in inertial.find("inertia").attrib.items()}
            own = np.array([[entries["i" + "".join(sorted(a + b))] for b in "xyz"] for a in "xyz"])
            R = of_rpy(numbers(inertial.find("origin"), "rpy"))
            tensor = R @ own @ R.T
        axis = numbers(joint.find("axis"), "xyz")
        axis = axis / (np.linalg.norm(axis) or 1.0)
        placed = of_rpy(numbers(origin, "rpy")), numbers(origin, "xyz")
        chain.append((joint.get("type"), axis, *placed, mass, com, tensor))
    return chain


def inverse_dynamics(chain: list[tuple], q: np.ndarray, v: np.ndarray, a: np.ndarray) -> dict[str, np.ndarray]:
    """Driving forces tau, and F, N, f, n of each link in its own axes, by Newton-Euler recursion."""
    states = iter(zip(q, v, a, strict=True))
    w, w_dot, p_ddot = np.zeros(3), np.zeros(3), -GRAVITY
    placed, F, N, tau = [], [], [], []
    for kind, axis, R, p, mass, com, tensor in chain:
        q_i, v_i, a_i = next(states) if kind != "fixed" else (0.0, 0.0, 0.0)
        turns, slides = (axis * (kind in ("revolute", "continuous"))), (axis * (kind == "prismatic"))
        p = p + R @ slides * q_i
        R = R @ rotation(turns, q_i)
        p_ddot = R.T @ (p_ddot + np.cross(w_dot, p) + np.cross(w, np.cross(w, p)))
        w_p, w_dot = R.T @ w, R.T @ w_dot
        p_ddot = p_ddot + 2 * np.cross(w_p, slides * v_i) + slides * a_i
        w, w_dot = w_p + turns * v_i, w_dot + np.cross(w_p, turns * v_i) + turns * a_i
        F.append(mass * (p_ddot + np.cross(w_dot, com) + np.cross(w, np.cross(w, com))))
        N.append(tensor @ w_dot + np.cross(w, tensor @ w))
        placed.append((R, p))
    f, n = [np.zeros(3)] * len(chain), [np.zeros(3)] * len(chain)
    R, p, f_next, n_next = np.eye(3), np.zeros(3), np.zeros(3), np.zeros(3)
    for i in reversed(range(len(chain))):
        kind, axis, _, _, _, com, _ = chain[i]
        n_next = N[i] + np.cross(com, F[i]) + R @ n_next + np.cross(p, R @ f_next)
        f_next = F[i] + R @ f_next
        f[i], n[i], (R, p) = f_next, n_next, placed[i]
        if kind != "fixed":
            tau.insert(0, axis @ (f_next if kind == "prismatic" else n_next))
    return {"tau": np.array(tau), "F": np.array(F), "N": np.array(N), "f": np.array(f), "n": np.array(n)}
