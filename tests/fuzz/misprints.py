"""Misprints: correct equations set in type in many ways, with errors of every kind planted in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from rttrr_pin.auditing.differences import DOTS, Kind
from rttrr_pin.derivation.symbols import Expression, Factors, Role, Symbol, Term, factors_of


@dataclass(frozen=True)
class Misprint:
    """One planted error: its kind, the printed term (None: left out), the term that is right (None: added)."""

    kind: Kind
    printed: Term | None
    derived: Term | None


class Typesetter:
    """Prints sums of terms in LaTeX, in a way that chance decides: order, spelling, spaces, brackets, line breaks."""

    def __init__(self, symbols: Mapping[str, Symbol], rng: np.random.Generator) -> None:
        self.symbols, self.rng = symbols, rng
        self.one_of = lambda options: options[int(rng.integers(len(options)))]

    def component(self, terms: list[Term]) -> str:
        """A right-hand side."""
        order = [terms[k] for k in self.rng.permutation(len(terms))]
        pieces: list[tuple[str, str]] = []  # sign and text
        while order:
            group = self._group(order) if self.rng.random() < 0.15 else []
            if group:
                pieces.append(group)
            else:
                coefficient, factors = order.pop(0)
                pieces.append(("-" if coefficient < 0 else "+", self.term(abs(coefficient), factors)))
        return self._lines(pieces)

    def _group(self, order: list[Term]) -> tuple[str, str] | tuple[()]:
        """Some of the terms with one factor in common, in brackets."""
        name = self.one_of([name for name, _ in order[0][1]]) if order[0][1] else ""
        members = [x for x in order if (name, 1) in x[1]][:4]
        if len(members) < 2:
            return ()
        for member in members:
            order.remove(member)
        sign = self.one_of((-1, 1))
        inner = [(sign * x, tuple(f for f in factors if f != (name, 1))) for x, factors in members]
        texts = [("-" if x < 0 else "+", self.term(abs(x), factors)) for x, factors in inner]
        left, right = self.one_of((("(", ")"), (r"\left(", r"\right)"), ("[", "]"), (r"\left[", r"\right]")))
        body = " ".join(f"{s} {t}" for s, t in texts).removeprefix("+ ")
        return (
            "-" if sign < 0 else "+",
            f"{self.symbol(name, 1)} {self.one_of(('', chr(92) + 'cdot '))}{left}{body}{right}",
        )

    def _lines(self, pieces: list[tuple[str, str]]) -> str:
        """Broken over lines now and then, the sign repeated or not."""
        repeated = self.rng.random() < 0.7
        lines = self.rng.random() < 0.5
        text = "& " if lines else ""
        for k, (sign, body) in enumerate(pieces):
            if k and lines and self.rng.random() < 0.25:
                text += f" {sign} \\\\\n& {sign} {body}" if repeated else f" \\\\\n& {sign} {body}"
            else:
                text += body if not k and sign == "+" else f" {sign} {body}"
        return rf"\begin{{aligned}} {text} \end{{aligned}}" if lines else text

    def term(self, coefficient: Fraction, factors: Factors) -> str:
        """A product."""
        parts = [self.symbol(*factors[k]) for k in self.rng.permutation(len(factors))]
        if coefficient != 1 or not parts:
            if coefficient.denominator == 1:
                parts.insert(0, str(coefficient))
            else:
                parts.insert(0, rf"\frac{{{coefficient.numerator}}}{{{coefficient.denominator}}}")
        return self._joined(parts)

    def _joined(self, parts: list[str]) -> str:
        text = parts[0]
        for part in parts[1:]:
            text += self.one_of((" ", r" \cdot ", r" \, ", " ")) + part
        return text

    def symbol(self, name: str, power: int) -> str:
        """A symbol to a power."""
        symbol = self.symbols[name]
        if symbol.role in (Role.COSINE, Role.SINE):
            return self._trigonometric(name, power)
        text = symbol.latex
        if symbol.role in DOTS:
            dots = ("", r"\dot", r"\ddot")[DOTS[symbol.role]]
            letter = f"{dots}{{q}}" if dots and self.rng.random() < 0.7 else f"{dots} q".strip()
            text = f"{letter}_{self._index(str(symbol.index))}"
        elif name[0] in "Ml" and self.rng.random() < 0.5:
            text = f"{name[0]}_{{{name[2:]}}}"
        elif name[0] == "J" and self.rng.random() < 0.5:
            text = self._tensor(name)
        return text if power == 1 else f"{text}^{self._index(str(power))}"

    def _tensor(self, name: str) -> str:
        link, axes = name[2], name[3:]
        axes = axes[::-1] if self.rng.random() < 0.5 else axes
        return rf"{{}}^{link}J^*_{{{axes}}}"

    def _index(self, text: str) -> str:
        return text if self.rng.random() < 0.7 else f"{{{text}}}"

    def _trigonometric(self, name: str, power: int) -> str:
        letter, k = name[0], name[2:]
        word = self.one_of((letter, {"c": r"\cos", "s": r"\sin"}[letter]))
        argument = (
            self.one_of((f" q_{k}", f"(q_{k})", f" q_{{{k}}}"))
            if word != letter
            else self.one_of((f"q_{k}", f" q_{k}"))
        )
        return f"{word}{argument}" if power == 1 else f"{word}^{power}{argument}"


class Printer:
    """Plants errors into right terms."""

    def __init__(self, symbols: Mapping[str, Symbol], rng: np.random.Generator) -> None:
        self.symbols, self.rng = symbols, rng
        self.one_of = lambda options: options[int(rng.integers(len(options)))]

    def sines(self, terms: Expression) -> Expression:
        """The same sum, now and then with 1 - c^2 as s^2."""
        result = dict(terms)
        for factors, x in terms.items():
            for name, power in factors:
                if not (name.startswith("c_") and power == 2) or self.rng.random() < 0.5:
                    continue
                cofactor = factors_of({other: p for other, p in factors if other != name})
                sine = factors_of(dict(cofactor) | {"s" + name[1:]: 2})
                if result.get(cofactor) == -x and factors in result and sine not in result:
                    del result[cofactor], result[factors]
                    result[sine] = -x
        return result

    def misprinted(self, terms: list[Term], foreign: list[Term], count: int) -> tuple[list[Term], list[Misprint]]:
        """The terms with errors in some of them, each in another term.

        Args:
            terms: the right ones.
            foreign: terms of other equations, to be added by mistake.
            count: how many errors.
        """
        text = list(terms)
        planted: list[Misprint] = []
        untouched = list(terms)
        while len(planted) < count and untouched:
            kind = self.one_of(tuple(Kind))
            term = untouched.pop(int(self.rng.integers(len(untouched))))
            error = self._error(kind, term, foreign, terms)
            if error is None:
                untouched.append(term)
                continue
            if error.derived is not None:
                text.remove(error.derived)
            if error.printed is not None:
                text.append(error.printed)
            planted.append(error)
        return text, planted

    def _error(self, kind: Kind, term: Term, foreign: list[Term], terms: list[Term]) -> Misprint | None:
        coefficient, factors = term
        if kind is Kind.SIGN:
            return Misprint(kind, (-coefficient, factors), term)
        if kind is Kind.COEFFICIENT:
            number = self.one_of([x for x in (Fraction(1, 2), 2, 3, 4) if x != 1])
            return Misprint(kind, (coefficient * number, factors), term)
        if kind is Kind.MISSING:
            return Misprint(kind, None, term)
        if kind is Kind.DUPLICATE:
            return Misprint(kind, term, None)
        if kind is Kind.EXTRA:
            new = [x for x in foreign if x[1] not in {f for _, f in terms}]
            return Misprint(kind, self.one_of(new), None) if new else None
        changed = self._rate(factors) if kind is Kind.RATE else self._symbol_error(factors)
        return None if changed is None else Misprint(kind, (coefficient, changed), term)

    def _rate(self, factors: Factors) -> Factors | None:
        dotted = [name for name, _ in factors if self.symbols[name].role in DOTS]
        if not dotted:
            return None
        name = self.one_of(dotted)
        k = self.symbols[name].index
        return self._exchanged(factors, name, [x for x in (f"q_{k}", f"v_{k}", f"a_{k}") if x != name])

    def _symbol_error(self, factors: Factors) -> Factors | None:
        name = self.one_of([name for name, _ in factors])
        own = self.symbols[name]
        if own.role in DOTS:
            alike = [x.name for x in self.symbols.values() if x.role is own.role and x.name != name]
        else:
            alike = [
                x.name
                for x in self.symbols.values()
                if x.dimension == own.dimension and x.name != name and x.role not in (*DOTS, Role.SIGN)
            ]
        return self._exchanged(factors, name, alike)

    def _exchanged(self, factors: Factors, name: str, others: list[str]) -> Factors | None:
        """Another symbol in place of one; not one that stands in the term already."""
        free = [other for other in others if other not in dict(factors)]
        if not free:
            return None
        powers = dict(factors)
        powers[self.one_of(free)] = powers.pop(name)
        return factors_of(powers)
