"""The recursion with its finished vectors named: short polynomials in names that came before, for any robot.

The recursion shows each finished w, w_dot, v_dot, F, N, f, n to `keep`; each component that is more than a symbol
is named there, and only its name goes on. M, C and g come from runs of their own, whose names carry a suffix:

    g(q)          no motion                       n_3x_g
    M(q) e_j      unit acceleration of joint j    n_3x_a2
    C(q, v) e_j   1/2 d tau / d v_j, by duals     n_3x_v2
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from flint import fmpq

from rttrr_pin.core.algebra import ZERO, Scalar, Vector
from rttrr_pin.core.dual import Dual, value_of
from rttrr_pin.core.dynamics import Result, dynamics
from rttrr_pin.core.joint import JointEffects
from rttrr_pin.core.model import Model
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.derivation.closed_forms import symbolic_arithmetic, unit_masses
from rttrr_pin.derivation.motion import index
from rttrr_pin.derivation.symbolic_robot import AXES, SymbolicRobot
from rttrr_pin.derivation.symbols import FORCE, MOMENT, NUMBER, Dimension, Expression, Role, Symbol

OUTWARDS, INWARDS = ("w", "w_dot", "v_dot", "F", "N"), ("f", "n")
"""What the recursion finishes on each link, in its order."""

SPIN = "dw"
"""Derivatives of w. All others depend linearly on derivatives alone, and have the plain name within their run."""

VECTORS = {
    "w": (r"\omega", Dimension(time=-1)),
    "w_dot": (r"\dot{\omega}", Dimension(time=-2)),
    "v_dot": (r"\dot{v}", Dimension(length=1, time=-2)),
    "F": ("F", FORCE),
    "N": ("N", MOMENT),
    "f": ("f", FORCE),
    "n": ("n", MOMENT),
    SPIN: (r"\omega", Dimension(time=-1)),
}
"""What a finished vector is called in LaTeX, and its dimension."""

Component = tuple[str, int, int]
"""Which vector, of which link from 0, which axis."""


@dataclass(frozen=True, slots=True)
class Step:
    """A name and what it stands for, in parameter symbols and names of earlier steps."""

    symbol: Symbol
    terms: Expression


@dataclass(frozen=True)
class Run:
    """The input of one run of the recursion, and how its names differ from those of the motion itself.

    Attributes:
        model: with the joint friction and armature that count.
        v: rates; duals where derivatives by one of them are wanted.
        a: accelerations.
        gravity: the field.
        payloads: what the robot exerts on its surroundings.
        suffix: of the names.
        latex: what follows the axis in the subscript.
        by: the dimension of the rate or acceleration that derivatives are taken by.
        dual: whether derivatives are named, and no values but w.
        accelerations: whether masses are 1 and F is wanted for itself, which then is v_dot_C.
    """

    model: Model
    v: Sequence[Scalar]
    a: Sequence[Scalar]
    gravity: Vector = ZERO
    payloads: Sequence[Payload] = ()
    suffix: str = ""
    latex: str = ""
    by: Dimension = NUMBER
    dual: bool = False
    accelerations: bool = False


class Stepwise:
    """The runs of the recursion over one robot, and the steps they name.

    Attributes:
        robot: with a symbol for each step of a run.
        steps: by name, in an order in which each needs only those before it.
    """

    def __init__(self, robot: SymbolicRobot) -> None:
        taken = {symbol.name for symbol in (*robot.motion, *robot.parameters.symbols)}
        self._names = _free_names(len(robot.model.links), taken)
        self._places = {name: component for component, name in self._names.items()}
        self.robot = robot = replace(robot, steps=tuple(Symbol(name, name, Role.STEP) for name in self._places))
        self.steps: dict[str, Step] = {}
        # first, whatever is asked for: the other runs share its w
        self._motion = self._result(Run(robot.model, robot.v, robot.a, robot.gravity, robot.payloads))

    def quantity(self, name: str) -> Iterable[Expression]:
        """The entries of a quantity, the last axis fastest."""
        match name:
            case "M":
                return self._mass_matrix()
            case "C":
                return self._coriolis()
            case "g":
                return self._gravity()
            case "tau":
                return map(self._terms, self._motion.tau)
            case "v_dot_C":
                robot = self.robot
                run = Run(robot.model, robot.v, robot.a, robot.gravity, accelerations=True)
                vectors = self._result(run).F
            case _:
                vectors = getattr(self._motion, name)
        return (self._terms(component) for vector in vectors for component in vector)

    def _gravity(self) -> list[Expression]:
        model = self.robot.model.without_joint_effects()
        nothing = [0] * model.nv
        run = Run(model, nothing, nothing, self.robot.gravity, suffix="_g", latex=",g")
        return [self._terms(x, run) for x in self._result(run).tau]

    def _mass_matrix(self) -> list[Expression]:
        """M(q), armature included; of what mirrors, the half that serial arms have the simpler form of."""
        model = _with_armature_alone(self.robot.model)
        columns = []
        for j, symbol in enumerate(self._symbols(Role.ACCELERATION)):
            unit = [int(i == j) for i in range(model.nv)]
            run = Run(model, [0] * model.nv, unit, suffix=f"_a{j + 1}", latex=f",{symbol.latex}", by=symbol.dimension)
            columns.append([self._terms(x, run) for x in self._result(run).tau])
        return [columns[max(i, j)][min(i, j)] for i in range(model.nv) for j in range(model.nv)]

    def _coriolis(self) -> list[Expression]:
        """C(q, v), by its columns 1/2 d tau / d v_j."""
        model, half = self.robot.model.without_joint_effects(), fmpq(1, 2)
        columns = []
        for j, symbol in enumerate(self._symbols(Role.RATE)):
            v = [Dual(x, {0: 1}) if i == j else x for i, x in enumerate(self.robot.v)]
            run = Run(
                model, v, [0] * model.nv, suffix=f"_v{j + 1}", latex=f",{symbol.latex}", by=symbol.dimension, dual=True
            )
            columns.append([self._terms(_part(x) * half, run) for x in self._result(run).tau])
        return [column[i] for i in range(model.nv) for column in columns]

    def _terms(self, x: Scalar, run: Run | None = None) -> Expression:
        """A polynomial of a run (None: of the motion itself), with the names that its steps have outside it."""
        ring, suffix = self.robot.ring, run.suffix if run else ""
        return {
            tuple(sorted((self._outside(name, suffix), power) for name, power in factors)): coefficient
            for factors, coefficient in ring.terms(ring.reduced(x)).items()
        }

    def _outside(self, name: str, suffix: str) -> str:
        """What a symbol of a run is called outside it; w is that of the motion in every run."""
        if name not in self._places or self._places[name][0] == "w":
            return name
        vector, link, axis = self._places[name]
        return (self._names["w", link, axis] if vector == SPIN else name) + suffix

    def _symbols(self, role: Role) -> list[Symbol]:
        return [symbol for symbol in self.robot.motion if symbol.role is role]

    def _result(self, run: Run) -> Result:
        order = _order(len(run.model.links))
        robot = self.robot
        bodies = unit_masses(robot.bodies()) if run.accelerations else robot.bodies()

        def keep(x: Vector) -> Vector:
            vector, link = next(order)
            if run.accelerations and vector in ("F", "N", "f", "n"):
                return x if vector == "F" else ZERO
            return Vector(*(self._kept((vector, link, axis), scalar, run) for axis, scalar in enumerate(x)))

        arithmetic = symbolic_arithmetic(robot, keep)
        return dynamics(run.model, arithmetic, robot.q, run.v, run.a, run.payloads, bodies, run.gravity)

    def _kept(self, component: Component, x: Scalar, run: Run) -> Scalar:
        """What stands for a component from now on."""
        if not run.dual:
            return self._named(component, x, run)
        vector, link, axis = component
        if vector != "w":
            return Dual(0, {0: self._named(component, _part(x), run)})
        return Dual(self._named(component, value_of(x), run), {0: self._named((SPIN, link, axis), _part(x), run)})

    def _named(self, component: Component, x: Scalar, run: Run) -> Scalar:
        """The component itself where it is short, else its name."""
        polynomial = self.robot.ring.reduced(x)
        if len(polynomial) == 0 or (len(polynomial) == 1 and polynomial.total_degree() <= 1):
            return polynomial
        name = self._names[component]
        outside = self._outside(name, run.suffix)
        if outside not in self.steps:
            self.steps[outside] = Step(_symbol(component, outside, run), self._terms(polynomial, run))
        return self.robot.ring[name]


def needed(steps: Iterable[Step], results: Iterable[Expression]) -> list[Step]:
    """The steps that results depend on, in their order."""
    wanted = {name for terms in results for factors in terms for name, _ in factors}
    kept = []
    for step in reversed(list(steps)):
        if step.symbol.name in wanted:
            kept.append(step)
            wanted |= {name for factors in step.terms for name, _ in factors}
    return kept[::-1]


def _order(links: int) -> Iterator[tuple[str, int]]:
    """The vectors that the recursion shows to `keep`, one after the other."""
    yield from ((vector, link) for link in range(links) for vector in OUTWARDS)
    yield from ((vector, link) for link in reversed(range(links)) for vector in INWARDS)


def _free_names(links: int, taken: set[str]) -> dict[Component, str]:
    """A name for each component, with a _ behind it where a symbol has that name."""
    names: dict[Component, str] = {}
    for component in ((vector, link, axis) for vector in VECTORS for link in range(links) for axis in range(3)):
        vector, link, axis = component
        name = f"{vector}_{link + 1}{AXES[axis]}"
        while name in taken:
            name += "_"
        names[component] = name
    return names


def _symbol(component: Component, name: str, run: Run) -> Symbol:
    """The symbol of a step; w itself is that of the motion in every run."""
    vector, link, axis = component
    base, dimension = VECTORS[vector]
    if vector == "w" or not run.latex:
        return Symbol(name, f"{{}}^{index(link + 1)}{base}_{AXES[axis]}", Role.STEP, dimension)
    latex = f"{{}}^{index(link + 1)}{base}_{{{AXES[axis]}{run.latex}}}"
    return Symbol(name, latex, Role.STEP, dimension.times(run.by, -1))


def _part(x: Scalar) -> Scalar:
    """The derivative; the integer 0, which polynomials take, where there is none."""
    return x.parts.get(0, 0) if isinstance(x, Dual) else 0


def _with_armature_alone(model: Model) -> Model:
    """The robot whose joints take torque by their armature only."""
    joints = [replace(joint, effects=JointEffects(armature=joint.effects.armature)) for joint in model.joints]
    return replace(model, joints=tuple(joints))
