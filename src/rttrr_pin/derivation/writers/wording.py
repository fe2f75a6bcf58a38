"""What the documents say besides formulas, in lines of Markdown or LaTeX alike."""

from __future__ import annotations

import re
from collections.abc import Iterator

from rttrr_pin.core.model import Model
from rttrr_pin.derivation import QUANTITIES, Derivation

TITLES = {
    "v_dot_C": "Accelerations of the centres of mass",
    "F": "Net forces F",
    "N": "Net moments N",
    "f": "Joint forces f",
    "n": "Joint moments n",
    "tau": "Driving forces tau",
    "M": "Mass matrix M(q)",
    "C": "Coriolis and centrifugal matrix C(q, v)",
    "g": "Gravity g(q)",
}
"""Headings of the quantities."""

STEPS = "Steps"
STEPS_MEANING = "What is named on the way, in the order in which it is needed."


def plain(name: str) -> str:
    """A name from a file that may stand in any document, comment or docstring; LaTeX escapes its own signs."""
    return re.sub(r"[^\w .,:()+/#%&-]", "?", name)


def conventions(derivation: Derivation) -> Iterator[str]:
    """What a reader must know, a paragraph each."""
    model = derivation.robot.model
    yield (
        "Derived in symbols by rttrr-pin: the Newton-Euler iterations outwards and inwards, run on polynomials. "
        "SI units throughout."
    )
    yield (
        "Vectors of a link stand in the link's own frame {i}, that of the joint which carries it. c and s before an "
        "angle are its cosine and sine. Gravity enters as the base accelerating upwards. The payload is what the robot "
        "exerts on its surroundings, in the axes of its link."
    )
    frictional = any(joint.effects.damping or joint.effects.friction for joint in model.joints)
    plain_rates = model.nq == model.nv and all(joint.nv <= 1 for joint in model.moving)
    friction = " + damping v + friction sign(v)" if frictional else ""
    rates = (
        "dM/dt - 2 C is skew-symmetric" if plain_rates else "v and a are the rates of the joints in their own frames"
    )
    yield f"tau = M(q) a + C(q, v) v + g(q) + what the payload takes{friction}; {rates}."
    if derivation.form == "stepwise":
        yield (
            f"The form is stepwise ({derivation.reason}): steps are named as the recursion finishes them, each in "
            "symbols and earlier steps; a rate or acceleration behind a comma stands for the derivative by it, and g "
            "for a robot at rest. Entries that would only repeat the name of a step are left out."
        )


def heading(name: str) -> str:
    """What a quantity is, with its unit."""
    quantity = QUANTITIES[name]
    symmetric = " It is symmetric; the upper half is shown." if name == "M" else ""
    return f"{quantity.sentence} [{quantity.unit}].{symmetric}"


def names_of_links(model: Model) -> str:
    """Which number is which link and joint."""
    pairs = enumerate(zip(model.links, model.joints, strict=True), start=1)
    return "; ".join(f"{i}: {plain(link.name)} on {plain(joint.name)} ({joint.type})" for i, (link, joint) in pairs)
