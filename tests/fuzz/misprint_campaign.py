"""Claim: the auditor finds every planted misprint, names kind and term of 98 percent, and reports no clean copy.

From the derived equations of the paper's 60 components: 1,000 copies of a component with one to three slips each, and
200 clean copies of all 60, each set in type at random: order, spelling, spaces, brackets, line breaks, c^2 or s^2.

Run: python -m tests.fuzz.misprint_campaign [--cases N] [--clean N] [--seed S] [--save]. Exit 1 if a slip is not found, if
less than 98 percent are named, or if a clean copy is reported.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache
from multiprocessing import get_context

import numpy as np

from rttrr_pin.auditing import Kind, read_publication
from rttrr_pin.auditing.audit import Auditor, Paired
from rttrr_pin.auditing.publication import DEFINITION, Equation
from rttrr_pin.derivation.symbols import Terms

from .misprints import Misprint, Numeral, Printer, Typesetter

WANTED = 0.98


@cache
def auditor() -> Auditor:
    """One for each process: the derivation is the same for all cases."""
    return Auditor(read_publication(), seed=0)


@dataclass(frozen=True)
class Target:
    """A component, with what is right for it and what is printed elsewhere for the same quantity."""

    equation: Equation
    terms: Terms
    foreign: list[Numeral]


@cache
def targets() -> list[Target]:
    """The paper's components."""
    judge = auditor()
    found: list[tuple[Equation, Terms]] = []
    for equation in judge.publication.equations:
        for k, axis in enumerate(equation.components if equation.quantity != DEFINITION else ""):
            one = Equation(equation.number, equation.quantity, equation.place, axis, ())
            found.append((one, judge.robot.ring.terms(judge.derived(equation, k))))
    return [
        Target(
            one,
            terms,
            [
                (x, f)
                for other, theirs in found
                if other.quantity == one.quantity
                for f, x in theirs.items()
                if f not in terms
            ],
        )
        for one, terms in found
    ]


def read(target: Target, text: str) -> Paired:
    """A component as set in type, paired by the auditor."""
    judge = auditor()
    equation = Equation(
        target.equation.number, target.equation.quantity, target.equation.place, target.equation.components, (text,)
    )
    splits = judge.publication.read(equation)
    assert len(splits) == 1
    return judge.paired(equation, splits[0], {})[0]


def case(seed: int) -> tuple[list[tuple[str, bool]], bool, str]:
    """One copy with slips: each planted kind and whether it was named, whether anything was found, and the text."""
    rng = np.random.default_rng(seed)
    target = targets()[int(rng.integers(len(targets())))]
    symbols = auditor().robot.ring.symbols
    printer = Printer(symbols, rng)
    right = [(x, f) for f, x in printer.sines(target.terms).items()]
    terms, planted = printer.misprinted(right, target.foreign, int(rng.integers(1, 4)))
    text = Typesetter(symbols, rng).component(terms)
    paired = read(target, text)
    reported = [
        Misprint(kind, None if pair.reading is None else (pair.reading.coefficient, pair.reading.factors), pair.derived)
        for pair in paired.pairs
        for kind in pair.kinds
    ]
    named = []
    for slip in planted:
        known = slip in reported
        if known:
            reported.remove(slip)
        named.append((str(slip.kind), known))
    return named, any(pair.kinds for pair in paired.pairs), text


def clean(seed: int) -> list[str]:
    """One clean copy of all components: those that were reported, with their text."""
    rng = np.random.default_rng([seed, 1])
    symbols = auditor().robot.ring.symbols
    reported = []
    for target in targets():
        right = [(x, f) for f, x in Printer(symbols, rng).sines(target.terms).items()]
        text = Typesetter(symbols, rng).component(right)
        paired = read(target, text)
        if paired.component.unparsed or any(pair.kinds for pair in paired.pairs):
            reported.append(f"{target.equation.names[0]}: {paired.component.unparsed} {text}")
    return reported


def main() -> int:
    from benchmarks.common import arguments, finish

    parser = arguments(__doc__ or "")
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--clean", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    start = time.perf_counter()
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        cases = list(pool.map(case, range(chosen.seed, chosen.seed + chosen.cases), chunksize=20))
        copies = list(pool.map(clean, range(chosen.seed, chosen.seed + chosen.clean), chunksize=2))
    slips = [slip for named, _, _ in cases for slip in named]
    planted = Counter(kind for kind, _ in slips)
    known = Counter(kind for kind, right in slips if right)
    missed = [text for _, found, text in cases if not found]
    reported = [text for copy in copies for text in copy]
    share = sum(known.values()) / len(slips)
    figures = {
        "copies_with_slips": len(cases),
        "slips": len(slips),
        "copies_not_reported": missed[:10],
        "named_with_kind_and_term": round(share, 4),
        "by_kind": {kind: f"{known[kind]} of {planted[kind]}" for kind in map(str, Kind)},
        "clean_copies_of_60_components": len(copies),
        "clean_components_reported": reported[:10],
        "seconds": round(time.perf_counter() - start, 1),
    }
    finish("audit_misprints", figures, chosen.save)
    return 1 if missed or reported or share < WANTED else 0


if __name__ == "__main__":
    sys.exit(main())
