"""A subject and its references on the states of one robot."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from rttrr_pin.core.joint import JointEffects
from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.errors import InputError
from rttrr_pin.exact.adjudication import Adjudication, Assessment, Deviation, in_order, nearest
from rttrr_pin.exact.enclosures import Enclosures, enclose
from rttrr_pin.exact.parameters import Parameters, exact_parameters
from rttrr_pin.implementations import Batch, Evaluation, Implementation, make_implementation, make_references
from rttrr_pin.implementations.protocol import evaluated
from rttrr_pin.implementations.registry import Source
from rttrr_pin.robot import Robot
from rttrr_pin.validation.compare import Comparison, Difference, Row, with_allowance
from rttrr_pin.validation.ranking import Ranking
from rttrr_pin.validation.sampling import Payload, Sampler
from rttrr_pin.validation.states import States, model_of

References = Source | list[Source] | tuple[Source, ...]
"""One reference or several."""

QUIET = np.errstate(over="ignore", invalid="ignore")
"""What overflows or is no number is a deviation like any other, and is shown with its state."""


@dataclass(frozen=True, slots=True)
class Run:
    """What is compared with what, and what was seen.

    Attributes:
        states: those that are compared.
        programs: the subject, which is judged, and the references that it is compared with.
        comparisons: gather the differences, one for each reference.
        ranking: the states to look at again, by the largest error / tolerance against any reference.
    """

    states: States
    programs: tuple[Implementation, ...]
    comparisons: tuple[Comparison, ...]
    ranking: Ranking = field(default_factory=Ranking)

    @classmethod
    def of(
        cls, robot: Robot, subject: Source, reference: References, seed: int, sampling: str, payload: Payload
    ) -> Run:
        """Prepare to compare.

        Raises:
            InputError: an argument cannot be used, or the programs have no quantity in common.
            ImplementationError: a program is missing, refuses the robot, or built another model than the file says.
        """
        model = model_of(robot, "there is nothing to compare")
        sampler = Sampler(model, sampling, seed, payload)
        judged = make_implementation(subject, model)
        references = make_references(reference, model)
        programs = (judged, *references)
        comparisons = []
        for other in references:
            shared = [key for key in judged.quantities if key in other.quantities]
            comparisons.append(Comparison(model, shared, other.name, other.version))
            if not comparisons[-1].rows:
                raise InputError(
                    f"{judged.name} gives {', '.join(judged.quantities) or 'nothing'}, and {other.name} gives "
                    f"{', '.join(other.quantities)}: there is nothing to compare"
                    f"{'' if model.nv else ', since no joint moves'}"
                )
        states = States(sampler, programs, compiled=any(program.name == "kernel" for program in programs))
        _check_inertia(model, states)
        return cls(states, programs, tuple(comparisons))

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader of the verdict must know: of how the robot was read, of each program, of what was compared."""
        of_programs = (note for program in self.programs for note in getattr(program, "notes", ()))
        zero = ", ".join(key for key in QUANTITIES if key in self.zero)
        compared = (f"{zero}: zero everywhere by all programs, so that nothing was compared there",) if zero else ()
        return (*(note.text for note in self.states.sampler.model.notes), *of_programs, *compared)

    @property
    def zero(self) -> set[str]:
        """The quantities that are zero in all that was compared."""
        zero, seen = [one.zero for one in self.comparisons], [one.seen for one in self.comparisons]
        return set[str]().union(*zero).difference(*seen)

    def check_compared(self) -> None:
        """Zeros that equal zeros are no agreement.

        Raises:
            InputError: nothing else was seen.
        """
        if not any(one.seen for one in self.comparisons):
            raise InputError(
                f"{', '.join(key for key in QUANTITIES if key in self.zero)} of robot "
                f"{self.states.sampler.model.name!r} are zero in every state, by all programs: nothing was compared; "
                "pass gravity, a payload or states in which a force acts"
            )

    @property
    def subject(self) -> Implementation:
        """The program that is judged."""
        return self.programs[0]

    @property
    def references(self) -> tuple[Implementation, ...]:
        """Those that it is compared with."""
        return self.programs[1:]

    @QUIET
    def evaluate(self, batch: Batch) -> list[Evaluation]:
        """What each program makes of a batch, the subject first."""
        results = [with_allowance(batch, evaluated(program, batch)) for program in self.programs]
        for program, result in zip(self.programs, results, strict=True):
            check_bounds(batch, program, result)
        return results

    @QUIET
    def add(self, batch: Batch) -> None:
        """Take in some states."""
        subject, *others = self.evaluate(batch)
        pairs = zip(self.comparisons, others, strict=True)
        ratios = [comparison.add(batch, subject, other) for comparison, other in pairs]
        self.ranking.see(np.max(ratios, axis=0), batch.first)

    @QUIET
    def differences(self, batch: Batch, results: Sequence[Evaluation]) -> list[Difference]:
        """How far the subject is from each reference."""
        subject, *others = results
        pairs = zip(self.comparisons, others, strict=True)
        return [comparison.differences(batch, subject, other) for comparison, other in pairs]

    def adjudicate(self, batch: Batch, results: Sequence[Evaluation]) -> Adjudication:
        """Who is right in one state, by the exact reference."""
        return adjudicate(batch, [(program.name, x) for program, x in zip(self.programs, results, strict=True)])


@QUIET
def adjudicate(batch: Batch, results: Sequence[tuple[str, Evaluation]]) -> Adjudication:
    """Who is right in a state: each program against enclosures of the true values, within its own allowance.

    The tolerance is the sum of the allowances, so where a state is beyond it, at least one program is beyond its own.

    Args:
        batch: the state, a batch of one.
        results: by name, what each program gave, the subject first.
    """
    enclosures = enclose(batch.model, batch.q, batch.v, batch.a, batch.loads, true_parameters(batch.model))
    assessments = tuple(_assessment(batch, enclosures, name, evaluation) for name, evaluation in results)
    return Adjudication(batch.first, int(np.max(enclosures.bits)), assessments)


def _assessment(batch: Batch, enclosures: Enclosures, name: str, evaluation: Evaluation) -> Assessment:
    """How far one program is off the true values of one state, quantity by quantity, in the order of the recursion."""
    deviations = [
        Deviation(
            row.quantity, row.at, float(one.relative[0]), float(one.of_tolerance[0]), float(one.error[0]), row.unit
        )
        for row, one in off_the_truth(batch, enclosures, evaluation)
    ]
    return Assessment(name, in_order(batch.model, deviations))


def off_the_truth(batch: Batch, enclosures: Enclosures, evaluation: Evaluation) -> Iterator[tuple[Row, Difference]]:
    """How far a program is off the true values of some states, by quantity and place: (N,) each.

    The true value in an enclosure that is nearest to the program's is taken: what it is off by is certain, and no more
    is. The tolerance is the program's own allowance, since the truth has none.
    """
    true = nearest(enclosures, evaluation.values)
    truth = Evaluation(true, {key: np.zeros(x.shape[:2]) for key, x in true.items()}, evaluation.tau_joint)
    comparison = Comparison(batch.model, tuple(true))
    return zip(comparison.rows, comparison.differences(batch, evaluation, truth), strict=True)


def true_parameters(model: Model) -> Parameters:
    """Whose numbers decide who is right: the file's, as any program reads them; without a file, the model's own."""
    try:
        exact_parameters(model, "read")
    except InputError:
        return "doubles"
    return "read"


def _check_inertia(model: Model, states: States) -> None:
    """What is certain to give zeros that equal zeros is said before anything is computed."""
    inertial = any(link.mass or link.inertia.any() for link in model.links)
    resisted = any(joint.effects != JointEffects() for joint in model.joints)
    loaded = states.sampler.payload is not None or (states.table is not None and bool(states.table.loads))
    if not (inertial or resisted or loaded):
        root = " but its root, which stands still," if model.root.mass or model.root.inertia.any() else ""
        raise InputError(f"no link of robot {model.name!r}{root} has mass: nothing was compared")


def check_bounds(batch: Batch, program: Implementation, result: Evaluation) -> None:
    """Where no bound on the rounding is finite there is no verdict; a result that alone is not finite is an error."""
    for key, allowed in (result.allowance or {}).items():
        if not allowed.max(initial=0.0) < np.inf:
            beyond = ~np.isfinite(allowed).reshape(len(allowed), -1).all(axis=1)
            raise InputError(
                f"{key} overflows in state {batch.first + int(np.argmax(beyond))}: float64 holds no bound on the "
                f"rounding of {program.name} there; pass gravity, payload, masses and states that a robot can have"
            )
