"""The audit: every printed equation against the recursion run on the same symbols, with evidence for each verdict."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, partial

from rttrr_pin.auditing.evidence import Evidence, Witness, weigh
from rttrr_pin.auditing.findings import findings_of
from rttrr_pin.auditing.form import expansions, folded, in_printed_form, sum_symbols, summed_angles, with_sums
from rttrr_pin.auditing.match import Numeral, Pair, as_terms, corrected, match
from rttrr_pin.auditing.printed import PrintedComponent, PrintedTerm, Split
from rttrr_pin.auditing.publication import DEFINITION, Convention, Equation, Publication
from rttrr_pin.auditing.text import Writing, in_language, spelled
from rttrr_pin.auditing.verdicts import Audit, ComponentAudit, ConventionCheck, Verdict
from rttrr_pin.core.model import Model
from rttrr_pin.derivation.derivation import ClosedForms, closed_forms
from rttrr_pin.derivation.ring import Polynomial, Ring
from rttrr_pin.derivation.symbols import (
    ACCELERATION,
    FORCE,
    MOMENT,
    Dimension,
    Role,
    Symbol,
    Terms,
    renamed,
    renamed_factors,
)


def audit(publication: Publication, seed: int = 0, progress: Callable[[int], None] = lambda done: None) -> Audit:
    """Hold every equation of a publication against the recursion.

    Args:
        publication: the equations, with all that they assume.
        seed: of the random state at which numbers are compared.
        progress: is called with the number of equations done.

    Returns:
        Verdicts and findings for every component, corrected equations, and evidence.

    Raises:
        OracleError: Pinocchio cannot take the robot.
    """
    auditor = Auditor(publication, seed)
    components: list[ComponentAudit] = []
    for done, equation in enumerate(publication.equations, start=1):
        components += auditor.audit(equation)
        progress(done)
    checks = [auditor.check(convention, components) for convention in publication.conventions]
    return Audit(publication, tuple(components), tuple(checks), seed)


@dataclass(frozen=True)
class Paired:
    """One component as printed, paired with what is derived."""

    component: PrintedComponent
    pairs: list[Pair]
    derived: Terms
    ring: Ring

    @property
    def weight(self) -> float:
        """Of all slips; a component that cannot be read weighs more than any that can."""
        return 1e6 if self.component.unparsed else sum(pair.weight for pair in self.pairs)


class Auditor:
    """What equations are held against: the derivation, and one witness of numbers."""

    def __init__(self, publication: Publication, seed: int) -> None:
        self.publication = publication
        self.robot = publication.robot
        self.seed = seed

    @cached_property
    def forms(self) -> ClosedForms:
        """The derivation."""
        return closed_forms(self.robot)

    @cached_property
    def forms_apart(self) -> ClosedForms | None:
        """The derivation with equal letters kept apart, as some texts do; their terms cancel in part."""
        return None if self.publication.apart is None else closed_forms(self.publication.apart)

    @cached_property
    def witness(self) -> Witness:
        """One random state."""
        return Witness(self.robot, self.seed)

    def audit(self, equation: Equation) -> list[ComponentAudit]:
        """The components of one equation; none for one that only defines letters."""
        if equation.quantity == DEFINITION:
            return []
        note, paired = self._best(equation)
        return [self._component(equation, k, one, note) for k, one in enumerate(paired)]

    def check(self, convention: Convention, components: Iterable[ComponentAudit]) -> ConventionCheck:
        """A convention against its alternative: the same pairing with some letters' signs turned."""
        if not convention.flip:
            return ConventionCheck(convention)
        touched = {
            equation.number: equation
            for equation in self.publication.equations
            if equation.quantity != DEFINITION
            and any(
                name in convention.flip
                for axis in range(max(1, len(equation.components)))
                for factors in self.robot.ring.terms(self.derived(equation, axis))
                for name, _ in factors
            )
        }
        findings = sum(len(c.findings) for c in components if c.equation in touched)
        turned = {name: -self.robot.ring[name] for name in convention.flip}
        otherwise = 0
        for equation in touched.values():
            _, paired = self._best(equation, turned)
            otherwise += sum(len(pair.kinds) for one in paired for pair in one.pairs)
        return ConventionCheck(convention, findings, otherwise)

    def derived(self, equation: Equation, k: int, forms: ClosedForms | None = None) -> Polynomial:
        """What is right for component k of an equation."""
        forms = forms or self.forms
        if equation.quantity == "tau":
            return forms.tau[equation.place]
        vectors = {"vC": forms.v_dot_C, "F": forms.F, "N": forms.N, "f": forms.f, "n": forms.n}
        return self.robot.ring.lift(list(vectors[equation.quantity][equation.place])[_axis(equation, k)])

    def _best(self, equation: Equation, turned: Mapping[str, Polynomial] | None = None) -> tuple[str, list[Paired]]:
        """The way to divide the display that leaves the least to explain."""
        splits = [(split, self.paired(equation, split, turned or {})) for split in self.publication.read(equation)]
        split, paired = min(splits, key=lambda pair: sum(one.weight for one in pair[1]))
        note = split.note
        if len(splits) > 1:
            note += f" ({len(splits)} ways were tried; this leaves the fewest slips)"
        return note, paired

    def paired(self, equation: Equation, split: Split, turned: Mapping[str, Polynomial]) -> list[Paired]:
        """Each component of an equation, divided in one way, paired with what is derived.

        Args:
            equation: the equation.
            split: how its text was divided and read.
            turned: what stands for some letters in the derivation, to try another convention.
        """
        return [self._nearest(equation, k, component, turned) for k, component in enumerate(split.components)]

    def _nearest(
        self, equation: Equation, k: int, component: PrintedComponent, turned: Mapping[str, Polynomial]
    ) -> Paired:
        """The pairing with the derivation in that form which leaves the least to explain."""
        together = self.robot.ring.substituted(self.derived(equation, k), turned)
        twins = self.publication.twins
        ways = [self._in_form(with_names(component, twins), self.robot.ring, together)]
        if self.forms_apart is not None and not turned:
            apart = self.derived(equation, k, self.forms_apart)
            ways.append(self._in_form(component, self.forms_apart.robot.ring, apart))
        best = min(ways, key=lambda way: way.weight)
        if component.unparsed or turned or not self._equal(best, together):
            return best
        read = [replace(pair, kinds=(), weight=0.0) for pair in best.pairs if pair.place is not None]
        return replace(best, pairs=read)

    def _in_form(self, component: PrintedComponent, ring: Ring, derived: Polynomial) -> Paired:
        terms = ring.terms(derived)
        ring = ring_of(ring, component.terms)
        sums = with_sums(summed_angles(ring.symbols))
        form = in_printed_form(folded(terms, sums), component.terms, angles_of(ring))
        return Paired(component, match(component.terms, form, ring.symbols, self.publication.twins), form, ring)

    def _equal(self, paired: Paired, derived: Polynomial) -> bool:
        """Whether the printed sum is equal to the derived one, whatever its form."""
        printed = as_terms(_numeral(pair) for pair in paired.pairs if pair.reading)
        return self._same(paired.ring, printed, derived)

    def _same(self, ring: Ring, printed: Terms, derived: Polynomial) -> bool:
        """Whether a sum in a text's letters is a derived polynomial."""
        sums = with_sums(summed_angles(ring.symbols))
        difference = ring.polynomial(renamed(printed, self.publication.twins)) - ring.polynomial(
            self.robot.ring.terms(derived)
        )
        return not len(ring.substituted(difference, expansions(ring, sums)))

    def _component(self, equation: Equation, k: int, paired: Paired, note: str) -> ComponentAudit:
        name = equation.names[k]
        terms, ring = paired.component.terms, paired.ring
        head = ComponentAudit(
            equation.number, name, equation.line, len(terms), len(paired.derived), Verdict.UNPARSED,
            unparsed=paired.component.unparsed, notes=(note,) if note else (),
        )  # fmt: skip
        if paired.component.unparsed:
            return head
        slips = any(pair.kinds for pair in paired.pairs)
        right = corrected(paired.pairs) if slips else [(_numeral(pair), False) for pair in paired.pairs]
        numerals = [numeral for numeral, _ in right]
        writing, proven = self._writing(equation, k, paired, numerals)
        findings = findings_of(
            name, paired.pairs, terms, ring.symbols, dimension_of(self.robot.model, equation), writing
        )
        quiet = [pair.reading.note for pair in paired.pairs if pair.reading and pair.reading.note and not pair.kinds]
        return replace(
            head,
            verdict=Verdict.DIFFERS if findings else Verdict.MATCH,
            findings=findings,
            notes=(*head.notes, *quiet),
            corrected=tuple(zip(writing(numerals), (changed for _, changed in right), strict=True)),
            proven=proven,
            evidence=self._evidence(equation, k, paired, numerals),
        )

    def _writing(self, equation: Equation, k: int, paired: Paired, right: list[Numeral]) -> tuple[Writing, bool]:
        """What writes as the text does, and whether the right terms can be read again; if not, as the tables do."""
        own = dict(paired.component.spellings)
        used = own | {name: x for name, x in self.publication.notation.items() if name not in own}
        like_text, like_tables = (self._in_letters(paired.ring, spellings) for spellings in (used, {}))
        if self._proven(equation, k, paired, like_text(right)):
            return like_text, True
        return like_tables, self._proven(equation, k, paired, like_tables(right))

    def _in_letters(self, ring: Ring, used: Mapping[str, str]) -> Writing:
        """What writes terms, with these spellings of the text before those of its tables."""
        language = self.publication.language
        letters = spelled(ring.symbols, self.publication.spellings, language, used)
        return partial(in_language, language, symbols=letters)

    def _proven(self, equation: Equation, k: int, paired: Paired, texts: list[str]) -> bool:
        """Whether the corrected text, read as the published one was, is the derived polynomial."""
        again = self.publication.read(replace(equation, components="x", texts=(" ".join(texts),)))[0].components[0]
        if again.unparsed:
            return False
        printed = as_terms((term.readings[0].coefficient, term.readings[0].factors) for term in again.terms)
        return self._same(ring_of(paired.ring, again.terms), printed, self.derived(equation, k))

    def _evidence(self, equation: Equation, k: int, paired: Paired, right: list[Numeral]) -> Evidence:
        sums = with_sums(summed_angles(paired.ring.symbols))
        values = {name: paired.ring.terms(x) for name, x in expansions(paired.ring, sums).items()}
        self.witness.with_sums(values)
        twins = self.publication.twins
        printed = renamed(as_terms(_numeral(pair) for pair in paired.pairs if pair.reading), twins)
        place = (equation.quantity, equation.place, _axis(equation, k))
        return weigh(self.witness, place, printed, renamed(as_terms(right), twins))


def _axis(equation: Equation, k: int) -> int:
    return "xyz".index(equation.components[k]) if equation.components else 0


def _numeral(pair: Pair) -> Numeral:
    return (pair.reading.coefficient, pair.reading.factors) if pair.reading else (Fraction(0), ())


def ring_of(ring: Ring, terms: Iterable[PrintedTerm]) -> Ring:
    """A ring that also has the sums of angles and the unknown symbols of printed terms."""
    readings = [reading for term in terms for reading in term.readings]
    names = dict.fromkeys(name for reading in readings for name, _ in reading.factors if name not in ring.symbols)
    sums = sum_symbols(with_sums(summed_angles(names)))
    known = {symbol.name for symbol in sums} | set(ring.symbols)
    unknown = [Symbol(name, name, Role.UNKNOWN) for name in names if name not in known]
    new = [symbol for symbol in sums if symbol.name not in ring.symbols]
    return Ring([*ring.symbols.values(), *new, *unknown]) if new or unknown else ring


def with_names(component: PrintedComponent, names: Mapping[str, str]) -> PrintedComponent:
    """A component read with other letters in place of some."""
    terms = (
        replace(
            term,
            readings=tuple(replace(x, factors=renamed_factors(x.factors, names)) for x in term.readings),
        )
        for term in component.terms
    )
    return replace(component, terms=tuple(terms))


def angles_of(ring: Ring) -> list[str]:
    """The suffixes of all angles: 4 of c_4."""
    return [name.removeprefix("c_") for name, symbol in ring.symbols.items() if symbol.role is Role.COSINE]


def dimension_of(model: Model, equation: Equation) -> Dimension:
    """The dimension that every term of an equation should have."""
    if equation.quantity == "tau":
        rotations = [rotation for joint in model.moving for rotation in joint.type.rotations]
        return MOMENT if rotations[equation.place] else FORCE
    return {"vC": ACCELERATION, "F": FORCE, "f": FORCE, "N": MOMENT, "n": MOMENT}[equation.quantity]
