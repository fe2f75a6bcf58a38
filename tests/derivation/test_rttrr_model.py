"""The page of RTTRR's dynamic model, read as any reader would, is the recursion."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from rttrr_pin.auditing import read_publication
from rttrr_pin.auditing.match import as_terms
from rttrr_pin.auditing.reading import read_latex
from rttrr_pin.derivation.derivation import closed_forms

PAGE = Path(__file__).parents[2] / "docs/rttrr_model.md"


def equations() -> dict[str, str]:
    """Left-hand sides with all lines of their right-hand sides, which may go over several displays."""
    found: dict[str, str] = {}
    name = ""
    for display in re.findall(r"\$\$\n(.*?)\n\$\$", PAGE.read_text(), re.DOTALL):
        for line in display.split("\n"):
            text = line.strip().removesuffix("\\\\").strip()
            if text in (r"\begin{aligned}", r"\end{aligned}"):
                continue
            left, equals, right = text.partition("={}&")
            name = left.strip() if equals else name
            found[name] = f"{found.get(name, '')} {right if equals else text.removeprefix('&')}"
    return found


@pytest.fixture(scope="module")
def published():
    return read_publication()


@pytest.fixture(scope="module")
def forms(published):
    return closed_forms(published.robot)


def polynomial(published, text: str):
    component = read_latex(text, published.vocabulary, 1)[0].components[0]
    assert not component.unparsed
    readings = [term.readings[0] for term in component.terms]
    assert not [reading.unknown for reading in readings if reading.unknown]
    ring = published.robot.ring
    return ring.reduced(ring.polynomial(as_terms((x.coefficient, x.factors) for x in readings)))


@pytest.mark.parametrize("link", [5, 4, 3, 2, 1])
def test_the_moments_that_the_paper_left_out(published, forms, link) -> None:
    """As read from the page: n_5 to n_1."""
    for axis, right in zip("xyz", forms.n[link - 1], strict=True):
        assert polynomial(published, equations()[f"{{}}^{link}n_{axis}"]) == right, axis


@pytest.mark.parametrize("joint", [1, 2, 3, 4, 5])
def test_the_driving_forces(published, forms, joint) -> None:
    """As read from the page: Qm_1 to Qm_5."""
    assert polynomial(published, equations()[rf"\tau_{joint}"]) == forms.tau[joint - 1]


def test_a_slip_in_the_page_would_be_seen(published, forms) -> None:
    text = equations()["{}^5n_x"]
    assert polynomial(published, text.replace(r"\dot{q}_5^2", r"\dot{q}_4^2", 1)) != forms.n[4].x
