"""Implementations by name, from another package, and what is none."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rttrr_pin import Model, validate
from rttrr_pin.errors import ImplementationError, RefusalError, RttrrError
from rttrr_pin.implementations import make_implementation, names
from rttrr_pin.implementations.registry import for_one_robot
from support.pendulum import pendulum

MODULE = """
from rttrr_pin.implementations import Evaluation

class Swing:
    name, version, quantities = "swing", "7", ("tau",)
    def __init__(self, model):
        self.model = model
    def evaluate(self, batch):
        import numpy as np
        return Evaluation({"tau": 0.6 * batch.a + 9.81 * np.sin(batch.q)})

def broken(model):
    raise RuntimeError("no licence")

def no_implementation(model):
    return model
"""


@pytest.fixture
def other_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A distribution that somebody installed."""
    (tmp_path / "swinging.py").write_text(MODULE)
    info = tmp_path / "swinging-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: swinging\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[rttrr_pin.implementations]\nswing = swinging:Swing\nbroken = swinging:broken\n"
        "none = swinging:no_implementation\ngone = not_there:Swing\nkernel = swinging:broken\n"
    )
    monkeypatch.syspath_prepend(tmp_path)


@pytest.mark.usefixtures("other_package")
def test_another_package_registers_an_implementation() -> None:
    assert "swing" in names()
    result = validate(pendulum(), "swing", "recursion", n_states=50)
    assert result.passed and result.subject == "swing 7"


@pytest.mark.usefixtures("other_package")
@pytest.mark.parametrize(
    ("name", "message"),
    [("broken", "RuntimeError: no licence"), ("none", "is a Model"), ("gone", "No module named 'not_there'")],
)
def test_a_package_that_fails_is_named(name: str, message: str) -> None:
    with pytest.raises(ImplementationError, match=message):
        make_implementation(name, pendulum().model)


@pytest.mark.usefixtures("other_package")
def test_a_package_does_not_replace_ours() -> None:
    assert make_implementation("kernel", pendulum().model).quantities == ("tau", "F", "N", "f", "n")
    assert names().count("kernel") == 1


@pytest.mark.parametrize(
    "source", ["", " ", "kernle", "it's", "./no_such_program", "no_module_of:mine", "os:nothing", 3, None]
)
def test_what_is_no_implementation(source: object) -> None:
    with pytest.raises(RttrrError):
        make_implementation(source, pendulum().model)  # type: ignore[arg-type]


@pytest.mark.usefixtures("other_package")
def test_a_class_or_a_function_of_the_model_is_made_for_the_robot() -> None:
    """Also by its name in a module, and where it makes a function."""
    import swinging  # type: ignore[import-not-found]

    def of_model(model: Model) -> Any:
        return lambda q, v, a: 0.6 * a + 9.81 * np.sin(q)

    for source in (swinging.Swing, "swinging:Swing", of_model):
        assert validate(pendulum(), source, "recursion", n_states=20).passed
    assert make_implementation(of_model, pendulum().model).name == "of_model"


@pytest.mark.usefixtures("other_package")
def test_what_is_made_for_one_robot() -> None:
    import swinging

    one = (lambda q, v, a: a, lambda *state: state[2], np.add, "results.csv", f"{sys.executable} x.py")
    several = ("kernel", "swing", swinging.Swing, "swinging:Swing", f"{sys.executable} x.py {{urdf}}")
    assert [for_one_robot(own) for own in one] == [True] * len(one)
    assert [for_one_robot(own) for own in several] == [False] * len(several)
    assert not for_one_robot(make_implementation("recursion", pendulum().model))


def test_not_implemented_is_a_refusal() -> None:
    def maker(model: Model) -> Any:
        raise NotImplementedError("pendulums")

    def function(q: Any, v: Any, a: Any) -> Any:
        raise NotImplementedError

    with pytest.raises(RefusalError, match=r"^maker does not take robot .*: pendulums$"):
        make_implementation(maker, pendulum().model)
    with pytest.raises(RefusalError, match="^function does not offer this$"):
        make_implementation(function, pendulum().model)
