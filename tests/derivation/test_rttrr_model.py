"""The page of RTTRR's dynamic model, written by the command and read as any reader would, is the recursion."""

from __future__ import annotations

import re

import pytest

from rttrr_pin.auditing import read_publication
from rttrr_pin.auditing.read import read_latex
from rttrr_pin.cli import main
from rttrr_pin.derivation.closed_forms import closed_forms
from rttrr_pin.derivation.symbols import expression_of


@pytest.fixture(scope="module")
def equations(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Left-hand sides with all lines of their right-hand sides, which may go over several displays."""
    page = tmp_path_factory.mktemp("model") / "rttrr_model.md"
    assert main(["derive", "--quiet", "--markdown", str(page)]) == 0
    sides: dict[str, str] = {}
    name = ""
    for display in re.findall(r"\$\$\n(.*?)\n\$\$", page.read_text(), re.DOTALL):
        for line in display.split("\n"):
            text = line.strip().removesuffix("\\\\").strip()
            if text in (r"\begin{aligned}", r"\end{aligned}"):
                continue
            left, equals, right = text.partition("={}&")
            name = left.strip() if equals else name
            sides[name] = f"{sides.get(name, '')} {right if equals else text.removeprefix('&')}"
    return sides


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
    return ring.reduced(ring.polynomial(expression_of((x.coefficient, x.factors) for x in readings)))


@pytest.mark.one_in(3)
@pytest.mark.parametrize("link", [5, 4, 3, 2, 1])
def test_the_moments_that_the_paper_left_out(published, forms, equations, link) -> None:
    """As read from the page: n_5 to n_1."""
    for axis, right in zip("xyz", forms.n[link - 1], strict=True):
        assert polynomial(published, equations[f"{{}}^{link}n_{axis}"]) == right, axis


@pytest.mark.parametrize("joint", [1, 2, 3, 4, 5])
def test_the_driving_forces(published, forms, equations, joint) -> None:
    """As read from the page: Qm_1 to Qm_5."""
    assert polynomial(published, equations[rf"\tau_{joint}"]) == forms.tau[joint - 1]


def test_an_error_in_the_page_would_be_seen(published, forms, equations) -> None:
    text = equations["{}^5n_x"]
    assert polynomial(published, text.replace(r"\dot{q}_5^2", r"\dot{q}_4^2", 1)) != forms.n[4].x
