"""A user's own function: of one state or many, right or wrong, and what it may not return."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Batch, Evaluation, RandomPayload, validate
from rttrr_pin.cli import main
from rttrr_pin.errors import ImplementationError, RttrrError
from rttrr_pin.implementations.function import Function
from support.pendulum import URDF, moment, pendulum

GOOD: dict[str, tuple[Callable[..., Any], bool]] = {
    "batch": (moment, True),
    "one-state": (lambda q, v, a: [float(moment(q[0], v[0], a[0]))], False),
    "scalar": (lambda q, v, a: float(moment(q, v, a).item()), False),
    "batch-only": (lambda q, v, a: moment(q[:, 0], v[:, 0], a[:, 0]), True),
    "dict": (lambda q, v, a: {"tau": moment(q, v, a)}, True),
}


@pytest.mark.parametrize("case", GOOD)
def test_a_right_function_passes(case: str) -> None:
    function, batches = GOOD[case]
    assert Function(function, pendulum().model).takes_batches == batches
    assert validate(pendulum(), function, "recursion", n_states=200).passed


def test_a_function_may_change_its_arguments() -> None:
    def careless(q: Any, v: Any, a: Any) -> Any:
        a *= 0.6
        a += 9.81 * np.sin(q)
        return a

    assert validate(pendulum(), careless, "recursion", n_states=50).passed


def test_a_function_may_return_the_same_array_each_time() -> None:
    buffer = np.zeros(1)

    def frugal(q: Any, v: Any, a: Any) -> Any:
        buffer[0] = moment(q[0], v[0], a[0])
        return buffer

    assert validate(pendulum(), frugal, "recursion", n_states=50).passed


def test_what_a_function_sets_of_numpy_stays_with_it() -> None:
    def strict(q: Any, v: Any, a: Any) -> Any:
        np.seterr(all="raise")
        return moment(q, v, a)

    before = np.geterr()
    assert validate(pendulum(), strict, "recursion", n_states=50).passed
    assert np.geterr() == before


@pytest.mark.parametrize("error", [0.0, 1e-3])
def test_a_function_in_single_precision_is_judged_as_such(error: float) -> None:
    def single(q: Any, v: Any, a: Any) -> Any:
        return moment(*(x.astype(np.float32) for x in (q, v, a))).astype(np.float32) * np.float32(1.0 + error)

    result = validate(pendulum(), single, "recursion", n_states=500)
    assert result.passed == (not error)
    assert "single is judged as float32, which it returns" in result.notes


def test_the_robots_own_function_passes_in_all_quantities_and_a_planted_error_is_found() -> None:
    robot = rttrr_pin.load("rttrr")

    def all_of(q: Any, v: Any, a: Any) -> dict[str, Any]:
        return dict(robot.inverse_dynamics(q, v, a).items())

    def wrong(q: Any, v: Any, a: Any) -> dict[str, Any]:
        parts = all_of(q, v, a)
        return parts | {"N": parts["N"] * (1 + 1e-9)}

    assert validate(robot, all_of, "recursion", n_states=100).passed
    rows = validate(robot, wrong, "recursion", n_states=100).references[0].rows
    assert {row.quantity for row in rows if not row.passed} == {"N"}


def fail(error: Exception) -> None:
    raise error


def silent() -> Exception:
    """An exception that cannot say what it is."""
    return type("Silent", (Exception,), {"__str__": lambda self: 1 / 0})()


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (lambda q, v, a: 1 / 0, "raised ZeroDivisionError at state 0: division by zero"),
        (lambda q: q, "raised TypeError at state 0"),
        (lambda q, v, a: np.zeros(2), r"returned tau of shape \(2,\), expected \(1,\)"),
        (lambda q, v, a: "text", "returned tau as str, expected real numbers"),
        (lambda q, v, a: None, "returned tau as NoneType"),
        (lambda q, v, a: {"torque": q}, "returned 'torque'"),
        (lambda q, v, a: {}, "returned nothing"),
        (lambda q, v, a: {"f": np.zeros(4)}, "expected"),
        (lambda q, v, a: q + 0j, "returned tau as complex128, expected real numbers"),
        (lambda q, v, a: q > 0, "returned tau as bool, expected real numbers"),
        (lambda q, v, a: sys.exit(0), "raised SystemExit at state 0: 0"),
        (lambda q, v, a: fail(silent()), "raised Silent at state 0$"),
        (lambda q, v, a: fail(ValueError("x" * 10**6)), r"\(1000000 characters\)"),
    ],
)
def test_what_a_function_may_not_do(function: Callable[..., Any], message: str) -> None:
    with pytest.raises(RttrrError, match=message):
        Function(function, pendulum().model)


def test_a_function_that_fails_later_names_the_state() -> None:
    def fails(q: Any, v: Any, a: Any) -> Any:
        if abs(float(q[0])) > 3:
            raise ValueError("singular")
        return moment(q, v, a)

    with pytest.raises(ImplementationError, match=r"raised ValueError at state \d+: singular"):
        validate(pendulum(), fails, "recursion", n_states=200)

    def changes(q: Any, v: Any, a: Any) -> Any:
        return {"tau" if abs(float(q[0])) < 1 else "f": np.zeros(1 if abs(float(q[0])) < 1 else (1, 3))}

    with pytest.raises(ImplementationError, match="returned f, and tau when it was tried"):
        validate(pendulum(), changes, "recursion", n_states=200)


def test_a_function_takes_no_payload() -> None:
    with pytest.raises(ImplementationError, match="no payload"):
        validate(pendulum(), moment, "recursion", n_states=5, payload=RandomPayload())


def test_a_module_of_the_current_folder(
    tmp_path: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delitem(sys.modules, "my_dynamics", raising=False)  # of another test
    (tmp_path / "my_dynamics.py").write_text(
        "import numpy as np\ndef my_id(q, v, a): return 0.6 * a + 9.81 * np.sin(q)\n"
    )
    (tmp_path / "pendulum.urdf").write_text(URDF)
    monkeypatch.chdir(tmp_path)
    words = ["validate", "pendulum.urdf", "--reference", "recursion", "--states", "50", "--subject"]
    assert main([*words, "my_dynamics:my_id"]) == 0
    assert "my_id" in capsys.readouterr().out.splitlines()[0]
    assert main([*words, "my_dynamics:none"]) == 2
    assert "has no attribute 'none'" in capsys.readouterr().err


@pytest.mark.parametrize("text", ["import sys; sys.exit(0)", "raise SystemExit", "def f(:"])
def test_a_module_that_ends_the_program_is_no_verdict(
    text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    name = f"ends_{len(text)}"
    (tmp_path / f"{name}.py").write_text(text)
    monkeypatch.chdir(tmp_path)
    assert main(["validate", "--subject", f"{name}:f"]) == 2
    assert f"{name}:f cannot be imported: " in capsys.readouterr().err


def evaluation(**arrays: Any) -> Any:
    """What an implementation says that was asked of three states of a pendulum."""
    return Evaluation({"tau": np.zeros((3, 1))} | arrays.pop("values", {}), **arrays)


@pytest.mark.parametrize(
    ("says", "message"),
    [
        (lambda: {"tau": np.zeros((3, 1))}, "returned a dict: expected an Evaluation"),
        (lambda: fail(KeyError("q")), "raised KeyError at states from 0: 'q'"),
        (lambda: sys.exit(0), "raised SystemExit at states from 0: 0"),
        (lambda: Evaluation({}), "has no tau in its values"),
        (lambda: evaluation(values={"tau": np.zeros(3)}), r"has tau of shape \(3,\) and type float64 in its values"),
        (
            lambda: evaluation(values={"tau": np.zeros((3, 1), complex)}),
            r"has tau of shape \(3, 1\) and type complex128 in its values",
        ),
        (lambda: evaluation(allowance={}), "has no tau in its allowance"),
        (lambda: evaluation(allowance={"tau": np.full((3, 1), -1.0)}), "has an allowance for tau that is negative"),
    ],
)
def test_an_implementation_of_the_users_says_what_it_promises(says: Callable[[], Any], message: str) -> None:
    class Own:
        name, version, quantities = "own", "", ("tau",)

        def evaluate(self, batch: Batch) -> Evaluation:
            result: Evaluation = says()
            return result

    with pytest.raises(ImplementationError, match=f"own {message}"):
        validate(pendulum(), Own(), "recursion", n_states=3)


@pytest.mark.one_in(2)
@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("outputs", ["tau", ("tau", "n")], ids=str)
def test_a_kernel_is_a_function_like_any_other(outputs: str | tuple[str, ...], dtype: str) -> None:
    """Though q alone is what it cannot do without; and one of another robot is wrong."""
    robot = rttrr_pin.load("rttrr")
    assert validate(robot, robot.compile(outputs, dtype=dtype), n_states=10).passed
    other = rttrr_pin.load("rttrr", gravity=(0, 0, -9.8))
    assert not validate(robot, other.compile(outputs, dtype=dtype), n_states=10).passed


def test_a_function_that_changes_its_precision_is_judged_as_when_it_was_tried() -> None:
    robot = rttrr_pin.load("rttrr")
    kernel = robot.compile("tau")

    def sometimes(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        tau = kernel(q, v, a)
        return tau.astype(np.float32) if len(q) == 50 else tau

    report = validate(robot, sometimes, "kernel", n_states=50)
    assert not report.passed and Function(sometimes, robot.model).type == np.float64
