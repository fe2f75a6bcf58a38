"""Claim: the auditor finds every planted misprint, names kind and term of 98 percent, and reports no clean copy.

From the derived equations of the paper's 60 components: 1,000 copies of a component with one to three errors each, and
200 clean copies of all 60, each set in type at random: order, spelling, spaces, brackets, line breaks, c^2 or s^2.

Run: python -m tests.fuzz.misprint_campaign [--cases N] [--clean N] [--seed S] [--save]. Exit 1 if an error is missed, if
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

from rttrr_pin.auditing import Kind, Publication, read_publication
from rttrr_pin.auditing.derived import Derived, derive
from rttrr_pin.auditing.match import Matching, match_best
from rttrr_pin.auditing.read import read_component
from rttrr_pin.derivation.symbols import Expression, Term

from .misprints import Misprint, Printer, Typesetter

WANTED = 0.98


@cache
def publication() -> Publication:
    """One for each process."""
    return read_publication()


@cache
def derived() -> tuple[Derived, ...]:
    """The derivation, which is the same for all cases."""
    return derive(publication())


@dataclass(frozen=True)
class Target:
    """A component, with its right terms and with terms that are printed elsewhere for the same quantity."""

    name: str
    terms: Expression
    foreign: list[Term]


@cache
def targets() -> list[Target]:
    """The paper's components."""
    expressions = derived()[0].expressions
    return [
        Target(
            name,
            terms,
            [
                (x, f)
                for other, others in expressions.items()
                if other.rstrip("xyz0123456789") == name.rstrip("xyz0123456789")
                for f, x in others.items()
                if f not in terms
            ],
        )
        for name, terms in expressions.items()
    ]


def read(target: Target, text: str) -> Matching:
    """A component as set in type, read and matched."""
    return match_best(read_component(publication(), text), target.name, derived(), publication().aliases)


def case(seed: int) -> tuple[list[tuple[str, bool]], bool, str]:
    """One copy with errors: each planted kind and whether it was named, whether anything was found, and the text."""
    rng = np.random.default_rng(seed)
    target = targets()[int(rng.integers(len(targets())))]
    symbols = derived()[0].symbols
    printer = Printer(symbols, rng)
    right = [(x, f) for f, x in printer.sines(target.terms).items()]
    terms, planted = printer.misprinted(right, target.foreign, int(rng.integers(1, 4)))
    text = Typesetter(symbols, rng).component(terms)
    matching = read(target, text)
    reported = [
        Misprint(kind, None if pair.reading is None else pair.reading.term, pair.derived)
        for pair in matching.pairs
        for kind in pair.kinds
    ]
    named = []
    for error in planted:
        known = error in reported
        if known:
            reported.remove(error)
        named.append((str(error.kind), known))
    return named, any(pair.kinds for pair in matching.pairs), text


def clean(seed: int) -> list[str]:
    """One clean copy of all components: those that were reported, with their text."""
    rng = np.random.default_rng([seed, 1])
    symbols = derived()[0].symbols
    reported = []
    for target in targets():
        right = [(x, f) for f, x in Printer(symbols, rng).sines(target.terms).items()]
        text = Typesetter(symbols, rng).component(right)
        matching = read(target, text)
        if matching.component.printed.unparsed or any(pair.kinds for pair in matching.pairs):
            reported.append(f"{target.name}: {matching.component.printed.unparsed} {text}")
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
    errors = [error for named, _, _ in cases for error in named]
    planted = Counter(kind for kind, _ in errors)
    known = Counter(kind for kind, right in errors if right)
    missed = [text for _, found, text in cases if not found]
    reported = [text for copy in copies for text in copy]
    share = sum(known.values()) / len(errors)
    figures = {
        "copies_with_errors": len(cases),
        "errors": len(errors),
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
