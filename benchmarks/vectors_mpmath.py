"""Inverse dynamics in mpmath by another way than the recursion, from the files of a folder of vectors and nothing else.

Nothing of rttrr_pin is imported. The pose of each link is a 3 x 3 matrix and a vector in base axes, each with its first
and second derivative in time (a jet); no velocity, no angular velocity and no acceleration is passed on. With R the
rotation of a link, p its origin, m its mass, r its centre, S its second moments about the centre, g gravity:

    F    m (p'' + R'' r - g)
    N    the vector of the skew matrix R'' S R^T - R S R''^T
    f    the sum of F over all that the link carries
    n    the sum of N + c x F over the same, less its origin x f
    tau  the sum over the same of the integral of u . (x'' - g) dm, with u the velocities of a unit rate of the joint:
         Lagrange's form, after Uicker and Kahn, from the moments of each link about its own origin

The numbers of the URDF are the doubles nearest to its decimals. On a floating base, base axes are those of the root
link at that instant, so that of the last bit of a quaternion's length only gravity, turned by its matrix, depends.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from mpmath import cos, mp, mpf, sin, sqrt

DIGITS = 60
mp.dps = DIGITS

ZERO, ONE = mpf(0), mpf(1)
NULL = [[ZERO] * 3 for _ in range(3)]
UNIT = [[ONE if i == k else ZERO for k in range(3)] for i in range(3)]

V = list[Any]
M = list[list[Any]]


def numbers(text: str) -> V:
    """The doubles nearest to decimals, exactly."""
    return [mpf(float(word)) for word in text.split()]


def mul(A: M, B: M) -> M:
    columns = list(zip(*B, strict=True))
    return [[r[0] * c[0] + r[1] * c[1] + r[2] * c[2] for c in columns] for r in A]


def madd(*parts: M) -> M:
    return [[sum(x[1:], x[0]) for x in zip(*rows, strict=True)] for rows in zip(*parts, strict=True)]


def scaled(x: Any, A: M) -> M:
    return [[x * y for y in row] for row in A]


def turned(A: M, x: V) -> V:
    return [r[0] * x[0] + r[1] * x[1] + r[2] * x[2] for r in A]


def transposed(A: M) -> M:
    return [list(row) for row in zip(*A, strict=True)]


def add(*parts: V) -> V:
    return [sum(x[1:], x[0]) for x in zip(*parts, strict=True)]


def sub(x: V, y: V) -> V:
    return [a - b for a, b in zip(x, y, strict=True)]


def times(a: Any, x: V) -> V:
    return [a * y for y in x]


def dot(x: V, y: V) -> Any:
    return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]


def cross(x: V, y: V) -> V:
    return [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]]


def outer(x: V, y: V) -> M:
    return [[a * b for b in y] for a in x]


def skew(w: V) -> M:
    return [[ZERO, -w[2], w[1]], [w[2], ZERO, -w[0]], [-w[1], w[0], ZERO]]


def of_skew(A: M) -> V:
    return [A[2][1], A[0][2], A[1][0]]


def about(axis: int, angle: Any) -> M:
    """A rotation about a coordinate axis."""
    s, c = sin(angle), cos(angle)
    K = skew(UNIT[axis])
    return madd(UNIT, scaled(s, K), scaled(1 - c, mul(K, K)))


def of_quaternion(x: Any, y: Any, z: Any, w: Any, twice: Any) -> M:
    """1 + twice (w K + K^2), with K the skew matrix of (x, y, z)."""
    K = skew([x, y, z])
    return madd(UNIT, scaled(twice * w, K), scaled(twice, mul(K, K)))


def placement(origin: ElementTree.Element | None) -> tuple[M, V]:
    """Rotation and translation of an <origin>."""
    attributes = {} if origin is None else origin.attrib
    p = numbers(attributes.get("xyz", "0 0 0"))
    if "quat_xyzw" in attributes:
        x, y, z, w = numbers(attributes["quat_xyzw"])
        return of_quaternion(x, y, z, w, 2 / (x * x + y * y + z * z + w * w)), p
    roll, pitch, yaw = numbers(attributes.get("rpy", "0 0 0"))
    return mul(about(2, yaw), mul(about(1, pitch), about(0, roll))), p


@dataclass
class Link:
    """A link and the joint that carries it; numbers of the file."""

    name: str
    parent: int
    type: str
    R0: M
    p0: V
    axis: V
    m: Any
    r: V
    S: M
    moved_by: int  # of the joints that move by themselves; -1 for a fixed one
    multiplier: Any
    offset: Any
    armature: Any
    damping: Any
    friction: Any


WIDTHS = {"revolute": 1, "continuous": 1, "prismatic": 1, "planar": 3, "floating": 6}


class Robot:
    """The robot of a folder of vectors."""

    def __init__(self, folder: Path) -> None:
        self.meta = json.loads((folder / "meta.json").read_text())
        tree = ElementTree.parse(folder / "robot.urdf").getroot()
        links = {x.get("name"): x for x in tree.findall("link")}
        joints = {x.get("name"): x for x in tree.findall("joint")}
        self.gravity = [mpf(x) for x in self.meta["gravity"]]
        self.floating = self.meta["base"] == "floating"
        moving = [x["name"] for x in self.meta["joints"] if x["moves"]]
        order = [x["link"] for x in self.meta["joints"]]
        self.links = []
        for told in self.meta["joints"]:
            joint = joints.get(told["name"])
            if joint is None:  # the base's own
                kind, parent, R0, p0, axis = "floating", -1, UNIT, [ZERO] * 3, [ZERO] * 3
            else:
                kind, over = joint.get("type", ""), joint.find("parent").get("link")  # type: ignore[union-attr]
                parent = order.index(over) if over in order else -1
                R0, p0 = placement(joint.find("origin"))
                along = joint.find("axis")
                axis = numbers("1 0 0" if along is None else along.get("xyz", "1 0 0"))
                length = sqrt(dot(axis, axis))
                axis = [x / length for x in axis]
            leader, multiplier, offset = told["name"], ONE, ZERO
            while leader in joints and (mimic := joints[leader].find("mimic")) is not None:
                offset += multiplier * mpf(float(mimic.get("offset", "0")))
                multiplier *= mpf(float(mimic.get("multiplier", "1")))
                leader = mimic.get("joint", "")
            moved_by = moving.index(leader) if kind != "fixed" else -1
            effects = [mpf(told[key]) for key in ("armature", "damping", "friction")]
            inertia = inertial(links[told["link"]])
            self.links.append(
                Link(told["link"], parent, kind, R0, p0, axis, *inertia, moved_by, multiplier, offset, *effects)
            )
        kinds = [
            x.type
            for name in moving
            for x, told in zip(self.links, self.meta["joints"], strict=True)
            if told["name"] == name
        ]
        self.widths = [(WIDTHS[kind] + (kind == "floating"), WIDTHS[kind]) for kind in kinds]

    def __call__(self, q: V, v: V, a: V, payload: dict[str, tuple[V, V]]) -> dict[str, list[Any]]:
        """tau, F, N, f, n of one state, as flat lists in the order of the columns."""
        q, v, a = ([mpf(x) for x in own] for own in (q, v, a))
        own, at_q, at_v = [], 0, 0
        for nq, nv in self.widths:
            own.append((q[at_q : at_q + nq], v[at_v : at_v + nv], a[at_v : at_v + nv]))
            at_q, at_v = at_q + nq, at_v + nv
        gravity = self.gravity
        if self.floating:
            gravity = turned(transposed(of_quaternion(*own[0][0][3:], 2)), gravity)
        n = len(self.links)
        poses: list[Any] = []
        F, N, c, H = [], [], [], []
        for link in self.links:
            pose = self.pose(link, poses[link.parent] if link.parent >= 0 else None, own)
            R, _, R2, p, _, p2 = pose
            poses.append(pose)
            c.append(add(p, turned(R, link.r)))
            F.append(times(link.m, sub(add(p2, turned(R2, link.r)), gravity)))
            moment = mul(mul(R2, link.S), transposed(R))
            N.append(of_skew(madd(moment, scaled(-ONE, transposed(moment)))))
            first = times(link.m, link.r)
            second = madd(link.S, scaled(link.m, outer(link.r, link.r)))  # about the origin of the link
            lifted = sub(p2, gravity)
            H.append(madd(outer(p, F[-1]), outer(turned(R, first), lifted), mul(mul(R, second), transposed(R2))))
        out = {
            "F": [turned(transposed(x[0]), y) for x, y in zip(poses, F, strict=True)],
            "N": [turned(transposed(x[0]), y) for x, y in zip(poses, N, strict=True)],
        }
        total, moments = [list(x) for x in F], [add(x, cross(y, z)) for x, y, z in zip(N, c, F, strict=True)]
        acting = [[ZERO] * 3 for _ in range(n)], [[ZERO] * 3 for _ in range(n)]  # payloads, moments about the base
        for name, (force, moment) in payload.items():
            i = next(k for k, link in enumerate(self.links) if link.name == name)
            f, m = (turned(poses[i][0], [mpf(x) for x in y]) for y in (force, moment))
            acting[0][i], acting[1][i] = f, add(m, cross(poses[i][3], f))
        f_sum = [add(x, y) for x, y in zip(total, acting[0], strict=True)]
        n_sum = [add(x, y) for x, y in zip(moments, acting[1], strict=True)]
        inertial_force = total
        for i in reversed(range(n)):
            k = self.links[i].parent
            if k >= 0:
                f_sum[k], n_sum[k] = add(f_sum[k], f_sum[i]), add(n_sum[k], n_sum[i])
                inertial_force[k], H[k] = add(inertial_force[k], inertial_force[i]), madd(H[k], H[i])
                acting[0][k], acting[1][k] = add(acting[0][k], acting[0][i]), add(acting[1][k], acting[1][i])
        out["f"] = [turned(transposed(x[0]), y) for x, y in zip(poses, f_sum, strict=True)]
        n_own = [sub(m, cross(x[3], y)) for x, y, m in zip(poses, f_sum, n_sum, strict=True)]
        out["n"] = [turned(transposed(x[0]), y) for x, y in zip(poses, n_own, strict=True)]
        tau = [[ZERO] * nv for _, nv in self.widths]
        for i, link in enumerate(self.links):
            if link.moved_by < 0:
                continue
            R, origin = poses[i][0], poses[i][3]
            rates, accelerations = own[link.moved_by][1:]
            for k, (linear, w) in enumerate(unit_rates(link)):
                d, w = turned(R, linear), turned(R, w)
                u0 = sub(d, cross(w, origin))  # the velocity at the base's origin
                W = skew(w)
                power = sum(W[x][y] * H[i][y][x] for x in range(3) for y in range(3))
                power += dot(u0, inertial_force[i]) + dot(u0, acting[0][i]) + dot(w, acting[1][i])
                rate, acceleration = link.multiplier * rates[k], link.multiplier * accelerations[k]
                sign = (rate > 0) - (rate < 0)
                power += link.armature * acceleration + link.damping * rate + link.friction * sign
                tau[link.moved_by][k] += link.multiplier * power
        flat = {key: [x for y in value for x in y] for key, value in out.items()}
        return {"tau": [x for y in tau for x in y]} | flat

    def pose(self, link: Link, parent: Any, own: list[Any]) -> Any:
        """Rotation and origin of a link in base axes with their derivatives."""
        E, E1, E2, d, d1, d2 = relative(link, own)
        if parent is None:
            if self.floating:
                return UNIT, E1, E2, [ZERO] * 3, d1, d2
            parent = (UNIT, NULL, NULL, [ZERO] * 3, [ZERO] * 3, [ZERO] * 3)
        R, R1, R2, p, p1, p2 = parent
        A, A1, A2 = (mul(x, link.R0) for x in (R, R1, R2))
        return (
            mul(A, E),
            madd(mul(A1, E), mul(A, E1)),
            madd(mul(A2, E), scaled(mpf(2), mul(A1, E1)), mul(A, E2)),
            add(p, turned(R, link.p0), turned(A, d)),
            add(p1, turned(R1, link.p0), turned(A1, d), turned(A, d1)),
            add(p2, turned(R2, link.p0), turned(A2, d), times(mpf(2), turned(A1, d1)), turned(A, d2)),
        )


def relative(link: Link, own: list[Any]) -> Any:
    """What a joint adds, after its placement: rotation and translation, with their derivatives."""
    none = [ZERO] * 3
    if link.moved_by < 0:
        return UNIT, NULL, NULL, none, none, none
    q, v, a = own[link.moved_by]
    if link.type == "floating":  # of the base, in its own axes at this instant
        if link.parent >= 0:
            raise NotImplementedError("a floating joint that is not the base's")
        K, K1 = skew(v[3:]), skew(a[3:])
        return UNIT, K, madd(mul(K, K), K1), none, v[:3], add(a[:3], cross(v[3:], v[:3]))
    if link.type == "planar":
        E, w, linear = about(2, q[2]), [ZERO, ZERO, v[2]], [v[0], v[1], ZERO]
        K, K1 = skew(w), skew([ZERO, ZERO, a[2]])
        d2 = turned(E, add([a[0], a[1], ZERO], cross(w, linear)))
        return E, mul(E, K), mul(E, madd(mul(K, K), K1)), [q[0], q[1], ZERO], turned(E, linear), d2
    q, v, a = link.multiplier * q[0] + link.offset, link.multiplier * v[0], link.multiplier * a[0]
    if link.type == "prismatic":
        return UNIT, NULL, NULL, times(q, link.axis), times(v, link.axis), times(a, link.axis)
    K = skew(link.axis)
    KK = mul(K, K)
    E = madd(UNIT, scaled(sin(q), K), scaled(1 - cos(q), KK))
    KE = mul(K, E)
    return E, scaled(v, KE), madd(scaled(a, KE), scaled(v * v, mul(KK, E))), none, none, none


def unit_rates(link: Link) -> list[tuple[V, V]]:
    """Velocity of the origin and angular velocity, in the link's axes, of a unit of each rate."""
    none = [ZERO] * 3
    if link.type == "floating":
        return [*((e, none) for e in UNIT), *((none, e) for e in UNIT)]
    if link.type == "planar":
        return [(UNIT[0], none), (UNIT[1], none), (none, UNIT[2])]
    return [(link.axis, none) if link.type == "prismatic" else (none, link.axis)]


def inertial(element: ElementTree.Element) -> tuple[Any, V, M]:
    """Mass, centre of mass, and second moments about it in link axes."""
    own = element.find("inertial")
    if own is None:
        return ZERO, [ZERO] * 3, NULL
    R, r = placement(own.find("origin"))
    mass, tensor = own.find("mass"), own.find("inertia")
    m = ZERO if mass is None else mpf(float(mass.get("value", "0")))
    attributes = {} if tensor is None else tensor.attrib
    J = [[mpf(float(attributes.get(f"i{''.join(sorted(a + b))}", "0"))) for b in "xyz"] for a in "xyz"]
    half = (J[0][0] + J[1][1] + J[2][2]) / 2
    S = [[half * UNIT[i][k] - J[i][k] for k in range(3)] for i in range(3)]
    return m, r, mul(mul(R, S), transposed(R))
