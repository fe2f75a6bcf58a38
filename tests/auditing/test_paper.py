"""The equations of the paper that are right as printed, against the recursion.

Source: Detesan, "The dynamic model of RTTRR serial robot - Iterations outwards and inwards the robot's
mechanical structure". Each equation stands here term by term, in the printed order and grouping, so that a
reader can hold it beside the paper. `c` and `s` are cosine and sine, `dq` and `ddq` the first and the second
time derivative; the frame, a superscript in front, comes behind the letter: `r4y` is 4r_C4y, `J4xz` is
4J*_xz, `f6x` is 6f_x. Mind the sign: the paper's J_xz is minus the matrix element.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

import rttrr_pin
from rttrr_pin import LinkWrenches, Robot, Wrench
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints import FIXED, JOINT_TYPES
from rttrr_pin.core.model import Link, Model
from support.tolerances import ROUNDING

Array = NDArray[np.float64]
Symbols = dict[str, Array | float]


@dataclass(frozen=True)
class Equation:
    """One printed equation.

    Attributes:
        number: the paper's.
        line: where it starts in the text of the paper.
        quantity: what it gives: v_dot_C, F, N (three components), f_z or Qm (one).
        link: which link it is about, from 1.
        components: its right-hand sides.
    """

    number: str
    line: int
    quantity: str
    link: int
    components: tuple[str, ...]

    def __str__(self) -> str:
        return f"({self.number})-{self.quantity}-{self.link}"


F4Z = """
    M5*g - sq5*f6x + M4*ddq2 + cq5*f6z + M4*g + sq5*M5*r5x*dq5**2 - sq5*M5*ddq5*r5z
    - cq5*M5*ddq5*r5x - cq5*M5*r5z*dq5**2 + M5*ddq2"""

F3Z = """
    M5*g - sq5*f6x + M4*ddq2 + cq5*f6z + M4*g + sq5*M5*r5x*dq5**2 - sq5*M5*ddq5*r5z
    - cq5*M5*ddq5*r5x - cq5*M5*r5z*dq5**2 + M5*ddq2 + M3*g + M3*ddq2"""

F2Z_AS_PRINTED = """
    M5*g - sq5*f6x + M4*ddq2 + cq5*f6z + M4*g + sq5*M5*r5z*dq5**2 - sq5*M5*ddq5*r5z
    - cq5*M5*ddq5*r5x - cq5*M5*r5z*dq5**2 + M5*ddq2 + M3*g + M3*ddq2 + M2*g + M2*ddq2"""
"""Equation (40), line 223: its sixth term has 5r_C5z, where (34) and (37) have 5r_C5x."""

EQUATIONS = (
    Equation("9", 41, "v_dot_C", 1, ("-ddq1*r1y - dq1**2*r1x", "ddq1*r1x - dq1**2*r1y", "g")),
    Equation("10", 43, "v_dot_C", 2, ("-ddq1*r2y - dq1**2*r2x", "ddq1*r2x - dq1**2*r2y", "g + ddq2")),
    Equation(
        "11",
        45,
        "v_dot_C",
        3,
        (
            "-ddq1*q3 - ddq1*l3 - dq1**2*l2 - 2*dq3*dq1 - ddq1*r3y - dq1**2*r3x",
            "ddq1*l2 - dq1**2*q3 - dq1**2*l3 + ddq3 + ddq1*r3x - dq1**2*r3y",
            "g + ddq2",
        ),
    ),
    Equation(
        "12",
        47,
        "v_dot_C",
        4,
        (
            """
            -cq4*ddq1*q3 - cq4*ddq1*l3 - cq4*dq1**2*l2 - 2*cq4*dq3*dq1 - cq4*ddq1*l4 + sq4*ddq1*l2
            - sq4*dq1**2*q3 - sq4*dq1**2*l3 + sq4*ddq3 - sq4*dq1**2*l4 - r4y*ddq1 - r4y*ddq4 - r4x*dq1**2
            - 2*r4x*dq1*dq4 - r4x*dq4**2""",
            """
            sq4*ddq1*q3 + sq4*ddq1*l3 + sq4*dq1**2*l2 + 2*sq4*dq3*dq1 + sq4*ddq1*l4 + cq4*ddq1*l2
            - cq4*dq1**2*q3 - cq4*dq1**2*l3 + cq4*ddq3 - cq4*dq1**2*l4 + r4x*ddq1 + r4x*ddq4 - r4y*dq1**2
            - 2*r4y*dq1*dq4 - r4y*dq4**2""",
            "g + ddq2",
        ),
    ),
    Equation("16", 77, "F", 1, ("-M1*(ddq1*r1y + dq1**2*r1x)", "-M1*(-ddq1*r1x + dq1**2*r1y)", "M1*g")),
    Equation("17", 79, "F", 2, ("-M2*(ddq1*r2y + dq1**2*r2x)", "-M2*(-ddq1*r2x + dq1**2*r2y)", "M2*(g + ddq2)")),
    Equation("23", 83, "N", 1, ("-J1xz*ddq1 + dq1**2*J1yz", "-J1yz*ddq1 - dq1**2*J1xz", "J1z*ddq1")),
    Equation("24", 85, "N", 2, ("-J2xz*ddq1 + dq1**2*J2yz", "-J2yz*ddq1 - dq1**2*J2xz", "J2z*ddq1")),
    Equation("25", 87, "N", 3, ("-J3xz*ddq1 + dq1**2*J3yz", "-J3yz*ddq1 - dq1**2*J3xz", "J3z*ddq1")),
    Equation(
        "26",
        89,
        "N",
        4,
        (
            "-J4xz*ddq1 - J4xz*ddq4 + J4yz*dq1**2 + 2*J4yz*dq1*dq4 + J4yz*dq4**2",
            "-J4yz*ddq1 - J4yz*ddq4 - J4xz*dq1**2 - 2*J4xz*dq1*dq4 - J4xz*dq4**2",
            "J4z*(ddq1 + ddq4)",
        ),
    ),
    Equation("34", 153, "f_z", 4, (F4Z,)),
    Equation("37", 188, "f_z", 3, (F3Z,)),
    # (40) with the sixth term of (37), from which it follows
    Equation("37+M2(g+ddq2)", 188, "f_z", 2, (F3Z + " + M2*(g + ddq2)",)),
    Equation("37+M2(g+ddq2)", 188, "Qm", 2, (F3Z + " + M2*(g + ddq2)",)),
)


def expression(text: str) -> ast.Expression:
    """A right-hand side, parsed."""
    return ast.parse(f"({text})", mode="eval")


def value(formula: ast.Expression, symbols: Symbols) -> Array:
    """A right-hand side in numbers, one for each state."""
    code = compile(ast.fix_missing_locations(formula), "<equation>", "eval")
    return np.asarray(eval(code, {"__builtins__": {}}, symbols))


def terms(parent: ast.AST, field: str) -> Iterator[tuple[ast.AST, str]]:
    """Where the terms of a sum stand, those in parentheses on their own: node and attribute."""
    node = getattr(parent, field)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        yield from terms(node, "left")
        yield from terms(node, "right")
    elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult) and isinstance(node.right, ast.BinOp):
        yield from terms(node, "right")
    else:
        yield parent, field


def flipped(formula: ast.Expression, term: int) -> ast.Expression:
    """A right-hand side with one of its terms turned round."""
    formula = copy.deepcopy(formula)
    parent, field = list(terms(formula, "body"))[term]
    setattr(parent, field, ast.UnaryOp(ast.USub(), getattr(parent, field)))
    return formula


@dataclass(frozen=True)
class States:
    """Motions with a payload, our result for them, and the paper's symbols for their numbers."""

    symbols: Symbols
    result: LinkWrenches

    def ours(self, equation: Equation) -> tuple[Array, Array]:
        """What an equation is about, from our result, and the vector whose size its error is measured by."""
        i = equation.link - 1
        F, N, f = (getattr(self.result, key)[..., i, :] for key in ("F", "N", "f"))
        match equation.quantity:
            case "v_dot_C":
                acceleration = F / self.symbols[f"M{equation.link}"]
                return acceleration, acceleration
            case "F":
                return F, F
            case "N":
                return N, N
            case "f_z":
                return f[..., 2:], f
            case _:
                return self.result.tau[..., i : i + 1], f

    def agree(self, equation: Equation, components: list[ast.Expression]) -> bool:
        """Whether an equation with these right-hand sides gives our numbers, in every state."""
        ours, scale = self.ours(equation)
        columns = [np.broadcast_to(value(x, self.symbols), ours.shape[:-1]) for x in components]
        error = np.linalg.norm(np.stack(columns, axis=-1) - ours, axis=-1)
        return bool((error <= ROUNDING * np.linalg.norm(scale, axis=-1)).all())


def paper_symbols(model: Model, motion: tuple[Array, Array, Array], f6: Array) -> Symbols:
    """The paper's symbols for the numbers of a model, of a motion and of a payload force."""
    named: Symbols = {"g": -model.gravity[2]}
    named |= {"l2": model.joints[2].p[0], "l3": model.joints[2].p[1], "l4": model.joints[3].p[1]}
    named |= {f"f6{axis}": f6[..., k] for k, axis in enumerate("xyz")}
    for i in range(1, 6):
        link = model.links[i - 1]
        for name, x in zip(("q", "dq", "ddq"), motion, strict=True):
            named[f"{name}{i}"] = x[..., i - 1]
        named |= {f"sq{i}": np.sin(named[f"q{i}"]), f"cq{i}": np.cos(named[f"q{i}"]), f"M{i}": link.mass}
        named |= {f"r{i}{axis}": link.com[k] for k, axis in enumerate("xyz")}
        J_z, J_xz, J_yz = link.inertia[2, 2], -link.inertia[0, 2], -link.inertia[1, 2]  # (3)-(5)
        named |= {f"J{i}z": J_z, f"J{i}xz": J_xz, f"J{i}yz": J_yz}
    return named


CHAIN = (("revolute", "z"), ("prismatic", "z"), ("prismatic", "y"), ("revolute", "z"), ("revolute", "y"))
"""How the joints of the arm move, and about or along which of their axes."""


def random_arm(rng: np.random.Generator) -> Robot:
    """The paper's arm with random lengths, masses, centres of mass, full tensors and gravity."""
    h1, h2, l2, l3, h3, l4, h4, h5 = rng.uniform(-1.0, 1.0, 8)
    p = [(0, 0, h1), (0, 0, h2), (l2, l3, h3), (0, l4, h4), (0, 0, h5), rng.uniform(-1.0, 1.0, 3)]
    links, joints = [], []
    for i, (kind, axis) in enumerate(CHAIN):
        half = rng.normal(size=(3, 3))
        links.append(Link(f"link_{i + 1}", rng.uniform(0.5, 5.0), rng.normal(size=3), half + half.T))
        unit = np.eye(3)["xyz".index(axis)]
        joints.append(Joint(f"joint_{i + 1}", JOINT_TYPES[kind], i - 1, p=np.array(p[i]), axis=unit))
    links.append(Link("tool"))
    joints.append(Joint("tool_joint", FIXED, 4, p=np.array(p[5])))
    gravity = np.array([0.0, 0.0, rng.uniform(-20.0, -1.0)])
    return Robot(Model("random RTTRR", Link("base"), tuple(links), tuple(joints), gravity))


def vectors(rng: np.random.Generator) -> Array:
    """Values for the five joints in a few states."""
    return rng.normal(size=(20, 5))


def one_joint(rng: np.random.Generator) -> Array:
    """Every joint in turn alone has a value that is not zero."""
    return np.kron(np.eye(5), np.ones((4, 1))) * rng.normal(size=(20, 1))


PLACES: dict[str, Callable[[np.random.Generator], tuple[Array, Array, Array]]] = {
    "anywhere": lambda rng: (vectors(rng), vectors(rng), vectors(rng)),
    "q=0": lambda rng: (np.zeros((20, 5)), vectors(rng), vectors(rng)),
    "q=pi/2": lambda rng: (np.full((20, 5), np.pi / 2), vectors(rng), vectors(rng)),
    "zero-rates": lambda rng: (vectors(rng), np.zeros((20, 5)), vectors(rng)),
    "at-rest": lambda rng: (vectors(rng), np.zeros((20, 5)), np.zeros((20, 5))),
    "one-coordinate": lambda rng: (one_joint(rng), vectors(rng), vectors(rng)),
    "one-rate": lambda rng: (vectors(rng), one_joint(rng), np.zeros((20, 5))),
    "one-acceleration": lambda rng: (vectors(rng), np.zeros((20, 5)), one_joint(rng)),
}
"""Batches of q, v, a: anywhere, and where mistakes hide or show."""

ARMS = ("seed-0", "seed-1", "seed-2", "rttrr-seed-3")
"""Arms of random numbers, and the bundled one; with the seed of the motions."""


def seed(name: str) -> int:
    """The seed in the name of an arm."""
    return int(name.rpartition("-")[2])


@cache
def arm(name: str) -> Robot:
    """One of the arms."""
    if name.startswith("rttrr"):
        return rttrr_pin.load("rttrr")
    return random_arm(np.random.default_rng(seed(name)))


@cache
def states(name: str, place: str) -> States:
    """Motions of an arm at some place, with random payloads."""
    rng = np.random.default_rng([seed(name), list(PLACES).index(place)])
    motion = PLACES[place](rng)
    f6, n6 = rng.normal(size=(2, 20, 3)) * 10.0
    result = arm(name).inverse_dynamics(*motion, Wrench(f6, n6))
    return States(paper_symbols(arm(name).model, motion, f6), result)


@pytest.mark.parametrize("name", ARMS)
def test_arm_has_the_geometry_of_the_paper(name: str) -> None:
    """Types, axes and offsets of the joints are those for which the paper's equations were derived."""
    model = arm(name).model
    R, p, axes = (np.array([getattr(joint, key) for joint in model.joints]) for key in ("R", "p", "axis"))
    assert [str(joint.type) for joint in model.joints] == [kind for kind, _ in CHAIN] + ["fixed"]
    assert np.array_equal(axes[:5], [np.eye(3)["xyz".index(axis)] for _, axis in CHAIN])
    assert np.array_equal(R, np.broadcast_to(np.eye(3), R.shape))
    assert not p[[0, 1, 4], :2].any()
    assert not p[3, 0]
    assert not model.gravity[:2].any()


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("name", ARMS)
@pytest.mark.parametrize("equation", EQUATIONS, ids=str)
def test_equation_holds_as_printed(equation: Equation, name: str, place: str) -> None:
    """The printed equation gives what the recursion gives, in every state."""
    assert states(name, place).agree(equation, [expression(x) for x in equation.components])


@pytest.mark.parametrize("name", ARMS[:3])
@pytest.mark.parametrize("equation", EQUATIONS, ids=str)
def test_a_wrong_sign_is_seen(equation: Equation, name: str) -> None:
    """With any one of its terms turned round, an equation no longer gives what the recursion gives."""
    printed = [expression(x) for x in equation.components]
    for k, component in enumerate(printed):
        for term in range(len(list(terms(component, "body")))):
            wrong = [*printed[:k], flipped(component, term), *printed[k + 1 :]]
            assert not states(name, "anywhere").agree(equation, wrong), ast.unparse(wrong[k])


@pytest.mark.parametrize("name", ARMS[:3])
def test_driving_force_misses_equation_40_by_its_misprint(name: str) -> None:
    """Equation (40) as printed is wrong by the term with 5r_C5z for 5r_C5x, and by nothing else."""
    equation, at = Equation("40", 223, "Qm", 2, (F2Z_AS_PRINTED,)), states(name, "anywhere")
    correction = " + sq5*M5*(r5x - r5z)*dq5**2"
    assert not at.agree(equation, [expression(F2Z_AS_PRINTED)])
    assert at.agree(equation, [expression(F2Z_AS_PRINTED + correction)])
