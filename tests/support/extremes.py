"""Trees and states whose numbers reach over 60 orders of magnitude, and the verdicts on them that are false."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

import rttrr_pin
from rttrr_pin.compile.build import build
from rttrr_pin.compile.quantities import BOUND
from rttrr_pin.compile.trace import PayloadSlot
from rttrr_pin.core.arrays import norm
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import ImplementationError
from rttrr_pin.implementations import Batch, Evaluation, Implementation, make_implementation
from rttrr_pin.validation.compare import Comparison
from rttrr_pin.validation.comparison import adjudicate
from support.programs import evaluate
from support.trees import extreme_tree

LARGEST = 5
"""Joints of a tree."""

ORDERS = 30.0
"""Numbers have sizes from 10^-30 to 10^30."""

PLANTED = 1e-6
"""Relative, of one mass."""

KERNELS = 23
"""Of so many trees one has its kernels traced, which takes as long as all else of five. A prime, since the number of
joints, the base and the signs go by the remainders of a seed by 5, 2 and 3: of each kind there are some."""

LIBRARIES = ("pinocchio", "mujoco", "lagrange")


class TracedKernel:
    """The kernel's operations and bounds in Python, without LLVM, which takes a second for each robot."""

    version = ""

    def __init__(self, model: Model, quantities: tuple[str, ...]) -> None:
        self.name = "kernel" if len(quantities) > 1 else "kernel of tau"
        self.model, self.quantities = model, quantities

    def evaluate(self, batch: Batch) -> Evaluation:
        """One state."""
        names = tuple(name + part for name in self.quantities for part in ("", BOUND))
        slots = [PayloadSlot(load.link, load.in_base) for load in batch.loads]
        program = build(self.model, names, slots, straight_line=None)
        inputs = [batch.q[0], batch.v[0], batch.a[0], *(x for load in batch.loads for x in (load.f[0], load.n[0]))]
        numbers = evaluate(program, np.concatenate(inputs).tolist())
        ends = np.cumsum([field.width for field in program.outputs])[:-1]
        parts = zip(program.outputs, np.split(np.array(numbers, dtype=float), ends), strict=True)
        got = {field.name: x.reshape(1, *field.shape) for field, x in parts}
        bounds = {key: got[key + BOUND] for key in self.quantities}
        allowance = {key: x if key == "tau" else norm(x) for key, x in bounds.items()}
        return Evaluation({key: got[key] for key in self.quantities}, allowance)


def extreme_state(model: Model, rng: np.random.Generator) -> Batch:
    """One state, with a payload at the last link."""

    def numbers(count: int) -> np.ndarray:
        sizes = 10 ** rng.uniform(-ORDERS, ORDERS, (1, count)) * rng.choice([-1, 1], (1, count))
        return np.where(rng.random((1, count)) < 1 / 7, 0.0, sizes)

    q, v, a = (numbers(count) for count in (model.nq, model.nv, model.nv))
    for at in model.quaternions:
        quaternion = rng.normal(size=4)
        q[0, at : at + 4] = quaternion / np.linalg.norm(quaternion)
    return Batch(model, q, v, a, (Load(len(model.links) - 1, numbers(3), numbers(3)),))


def others(model: Model, kernel: bool) -> Iterator[Implementation]:
    """The programs that the recursion is compared with; not each library builds each robot."""
    if kernel:
        yield TracedKernel(model, ("tau",))  # whose inertia is regrouped
        yield TracedKernel(model, QUANTITIES)
    for name in LIBRARIES:
        try:
            yield make_implementation(name, model)
        except ImplementationError:
            continue


def heavier(model: Model, link: int) -> Model:
    """The robot with a larger mass at one link."""
    links = list(model.links)
    links[link] = replace(links[link], mass=links[link].mass * (1 + PLANTED))
    return replace(model, links=tuple(links))


def false_verdicts(
    seed: int, text: str = "", state: Callable[[Model, np.random.Generator], Batch] = extreme_state
) -> tuple[Counter[str], list[str]]:
    """What was counted on one tree in one state, and the false verdicts in words; an extreme tree unless text is given.

    A false alarm: two right programs lie apart by more than their allowances. A blind spot: the recursion of a robot
    with one mass larger by `PLANTED`, by which F of that link is, is within rounding of a right program; both knowing
    that F to a tenth of it. What a program's own rounding hides is counted apart.
    """
    rng = np.random.default_rng(seed)
    text = text or extreme_tree(seed, 1 + seed % LARGEST, ORDERS, signs=seed % 3 != 0)
    model = rttrr_pin.load(text, base="floating" if seed % 2 else "fixed", friction=True).model
    batch = state(model, rng)
    count, false = Counter[str](trees=1), list[str]()
    with np.errstate(all="ignore"):
        right = make_implementation("recursion", model).evaluate(batch)
        massive = [i for i, link in enumerate(model.links) if link.mass]
        link = int(rng.choice(massive)) if massive else None
        planted = None if link is None else _recursion_of(heavier(model, link), batch)
        for program in others(model, kernel=seed % KERNELS == 0):
            got = program.evaluate(batch)
            if not all(np.isfinite(x).all() for x in (got.allowance or {}).values()):
                count[f"{program.name}: overflow, named"] += 1
                continue
            count[f"{program.name}: compared"] += 1
            ratio = _ratio(batch, right, got)
            if not ratio <= 1.0:
                who = adjudicate(batch, [("recursion", right), (program.name, got)])
                wrong = [(one.name, one.first_wrong) for one in who.wrong]
                false.append(f"false alarm, seed {seed}, {program.name}: {ratio:.3g}, wrong: {wrong}")
            if planted is None or link is None or "F" not in program.quantities:
                continue
            known = all(_knows(side, link) for side in (planted, got))
            count[f"{program.name}: {'planted' if known else 'hidden by its rounding'}"] += 1
            if known and not _ratio(batch, planted, got) > 1.0:
                false.append(f"blind spot, seed {seed}, {program.name}")
    return count, false


def _ratio(batch: Batch, subject: Evaluation, reference: Evaluation) -> float:
    """The largest error / tolerance."""
    comparison = Comparison(batch.model, [key for key in subject.values if key in reference.values])
    return max((float(one.of_tolerance[0]) for one in comparison.differences(batch, subject, reference)), default=0.0)


def _recursion_of(model: Model, batch: Batch) -> Evaluation:
    """The reference recursion of another robot at the same state."""
    return make_implementation("recursion", model).evaluate(replace(batch, model=model))


def _knows(side: Evaluation, link: int) -> bool:
    """Whether rounding leaves F of the link known to a tenth of what is planted; where it is 0, nothing is."""
    allowed = (side.allowance or {})["F"][0, link]
    return bool(0.0 <= allowed <= PLANTED / 10 * math.hypot(*side.values["F"][0, link]) > 0.0)
