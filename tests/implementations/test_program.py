"""Programs on stdin and stdout: right ones, wrong ones, and those that die, hang, chatter or run away."""

from __future__ import annotations

import copy
import gc
import os
import pickle
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from rttrr_pin import Wrench, validate
from rttrr_pin.errors import ImplementationError, RttrrError
from rttrr_pin.implementations import Batch
from rttrr_pin.implementations.program import Program
from support.pendulum import moment, pendulum, program

RIGHT = 'print(json.dumps({"tau": [tau]}))'


def states(count: int) -> Batch:
    q, v, a = np.random.default_rng(1).uniform(-3, 3, (3, count, 1))
    return Batch(pendulum().model, q, v, a)


def made(folder: Path, reply: str, seconds: float = 10.0) -> Program:
    return Program(program(folder, reply), pendulum().model, seconds)


@pytest.mark.parametrize(
    "reply",
    [
        RIGHT,
        "print(tau)",
        "print([tau])",
        'print(json.dumps({"tau": {"pivot": tau}}))',
        'sys.stdout.write("\\n" + json.dumps([tau]) + "\\r\\n")',
    ],
)
def test_replies_of_every_form_are_taken(tmp_path: Path, reply: str) -> None:
    batch = states(50)
    result = made(tmp_path, reply).evaluate(batch)
    assert result.values["tau"] == pytest.approx(moment(batch.q, batch.v, batch.a), rel=1e-14)


def test_links_by_name_or_in_order(tmp_path: Path) -> None:
    both = made(tmp_path, 'print(json.dumps({"f": [[1, 2, 3]], "n": {"rod": [4, 5, 6.5]}, "tau": tau}))')
    assert both.quantities == ("tau", "f", "n")
    values = both.evaluate(states(2)).values
    assert values["f"].tolist() == [[[1, 2, 3]]] * 2 and values["n"].tolist() == [[[4, 5, 6.5]]] * 2


def test_a_right_program_passes_and_a_planted_error_is_found(tmp_path: Path) -> None:
    assert validate(pendulum(), made(tmp_path, RIGHT), "recursion", n_states=500).passed
    wrong = made(tmp_path, 'print(json.dumps({"tau": [tau * (1 + 1e-12)]}))')
    assert not validate(pendulum(), wrong, "recursion", n_states=500).passed


@pytest.mark.parametrize("form", ["%.6g", "%.4f", "%.8e"])
def test_few_digits_are_judged_as_such(tmp_path: Path, form: str) -> None:
    """Right to the last digit printed; an error of a few units of that digit is found."""
    right = made(tmp_path, f'print("{form}" % tau)')
    assert right.digits is not None and f"judged at {right.digits} digits" in right.notes[0]
    assert validate(pendulum(), right, "recursion", n_states=300).passed
    wrong = made(tmp_path, f'print("{form}" % (tau + 3e-4))')
    assert not validate(pendulum(), wrong, "recursion", n_states=300).passed


def test_no_number_is_a_deviation_and_no_error(tmp_path: Path) -> None:
    values = made(tmp_path, 'print("[null]" if k % 2 else "NaN")').evaluate(states(2)).values
    assert np.isnan(values["tau"]).all()
    assert not validate(pendulum(), made(tmp_path, "print(-nan if k == 30 else tau)"), "recursion", n_states=50).passed


def test_the_payload_is_handed_over(tmp_path: Path) -> None:
    """A force along z at the pivot does no work; a moment about y is tau's."""
    reply = 'print(tau + sum(load["n"][1] for load in state.get("payload", [])))'
    payload = Wrench((0, 0, 5), (0, 2, 0))
    assert validate(pendulum(), made(tmp_path, reply), "recursion", n_states=50, payload=payload).passed


def test_nothing_waits_for_a_program_that_does_not_flush_line_by_line(tmp_path: Path) -> None:
    """stdout is a terminal, so that C, C++ and Python write each line at once; a full pipe in any direction is fine."""
    assert len(made(tmp_path, RIGHT + '; sys.stderr.write("x" * 3000)', 5).evaluate(states(3000)).values["tau"]) == 3000


HOSTILE = {
    "dies": ("k == 5 and sys.exit(3); print(tau)", "ended with exit code 3 at state 102"),
    "killed": ("k == 5 and os.kill(os.getpid(), 11); print(tau)", "was ended by signal 11 at state 102"),
    "raises": ("print(tau if k < 5 else 1 / 0)", "ZeroDivisionError: "),
    "hangs": ("k == 5 and time.sleep(60); print(tau)", "did not reply within 0.4 s"),
    "closes": ("k == 5 and (os.close(1), os.close(0), time.sleep(60)); print(tau)", "closed its output"),
    "garbage": ('print(tau if k < 5 else "tau = 3")', "wrote what is no reply: 'tau = 3' is no JSON"),
    "banner": ('k or print("Loading robot"); print(tau)', "'Loading robot' is no JSON"),
    "too-many-lines": ("print(tau); print(tau)", "wrote more lines than it has read states"),
    "deep": ('print("[" * 900 + "0" + "]" * 900)', "lists in each other, more than 8 deep"),
    "many-names": ("print(json.dumps({str(k): 0 for k in range(50000)}))", "returned '0', '1', "),
    "nested": ('print("[" * 100000)', "is no JSON"),
    "too-few": ("print([])", "tau has 0 numbers, expected 1"),
    "too-many": ("print([tau, tau])", "tau has 2 numbers, expected 1"),
    "word": ("print('[\"abc\"]')", "tau has 'abc' where a number is expected"),
    "bool": ("print('[true]')", "tau has True where a number is expected"),
    "object": ("print('{\"tau\": [{}]}')", "tau has {} where a number is expected"),
    "joint": ('print(\'{"tau": {"pivto": 1}}\')', "did you mean pivot"),
    "nothing": ("print('{}')", "returned nothing"),
    "quantity": ("print('{\"torque\": [1]}')", "returned 'torque': expected tau"),
    "changes": ("print(json.dumps({'tau' if k < 5 else 'f': [1] * (1 if k < 5 else 3)}))", "replied with f"),
    "refuses": ('print(\'{"error": "singular"}\')', "replied with an error: singular"),
    "runs-away": ("sys.stdout.write('1' * 2000000)", "wrote more than 1,000,000 bytes"),
    "silent-runaway": ("while True: print(1.5)", "wrote more lines than it has read states"),
}


@pytest.mark.parametrize("case", HOSTILE)
def test_a_hostile_program_is_named_and_ended(tmp_path: Path, case: str) -> None:
    reply, message = HOSTILE[case]
    reply = reply.replace("while True: print(1.5)", "[print(1.5) for _ in iter(int, 1)]")
    command = program(tmp_path, f'k or print(os.getpid(), file=open("{tmp_path}/pid", "w")); ' + reply)
    q = np.zeros((10, 1))

    def ask() -> None:
        one = Program(command, pendulum().model, 0.4 if case == "hangs" else 5.0)
        time.sleep(0.3 if "while" in HOSTILE[case][0] else 0.0)
        one.evaluate(Batch(pendulum().model, q, q, q, first=100))

    with pytest.raises(RttrrError) as caught:
        ask()
    assert message in str(caught.value)
    assert not alive(int((tmp_path / "pid").read_text()))


def test_the_end_of_stderr_is_shown(tmp_path: Path) -> None:
    with pytest.raises(ImplementationError, match=r"(?s)stderr ends:.*cannot open robot.bin$"):
        made(tmp_path, 'sys.stderr.write("x" * 100000 + "\\ncannot open robot.bin\\n"); sys.exit(1)')


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("/no/such/program", "cannot be started: No such file"),
        ("'unbalanced", "is no command"),
        ("", "cannot be started"),
        (f"{os.devnull} x", "cannot be started: Permission denied"),
    ],
)
def test_what_is_no_program(command: str, message: str) -> None:
    with pytest.raises(ImplementationError, match=message):
        Program(command, pendulum().model)


def test_a_program_starts_again_after_an_error(tmp_path: Path) -> None:
    again = made(tmp_path, "k == 5 and sys.exit(1); print(tau)")
    with pytest.raises(ImplementationError, match="at state 2"):
        again.evaluate(states(5))
    assert len(again.evaluate(states(5)).values["tau"]) == 5


@pytest.mark.parametrize("reply", ["print(os.getpid())", "print(os.getpid()); k == 2 and time.sleep(60)"])
def test_a_program_ends_with_its_object(tmp_path: Path, reply: str) -> None:
    """At the end of its input or, if it does not leave, by force."""
    one = made(tmp_path, reply)
    child = int(one.evaluate(states(1)).values["tau"][0, 0]) if "sleep" not in reply else one._child._process.pid  # type: ignore[union-attr]
    assert alive(child)
    del one
    gc.collect()
    assert not alive(child)


def test_an_interrupt_ends_the_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    one = made(tmp_path, "print(os.getpid())")
    child = int(one.evaluate(states(1)).values["tau"][0, 0])

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("rttrr_pin.implementations.child_process.select.poll", interrupt)
    with pytest.raises(KeyboardInterrupt):
        one.evaluate(states(1))
    assert not alive(child)


def alive(process: int) -> bool:
    for _ in range(20):
        try:
            os.kill(process, 0)
        except ProcessLookupError:
            return False
        if "\nState:\tZ" in Path(f"/proc/{process}/status").read_text():
            return False
        time.sleep(0.02)
    return True


COPIES: list[Callable[[Program], Program]] = [copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))]


@pytest.mark.parametrize("copied", COPIES)
def test_a_copy_asks_a_program_of_its_own(tmp_path: Path, copied: Callable[[Program], Program]) -> None:
    one = made(tmp_path, RIGHT)
    other = copied(one)
    first, second, third = (each.evaluate(states(5)).values["tau"] for each in (one, other, one))
    assert (first == second).all() and (first == third).all()
    assert one._child is not None and other._child is not None and one._child is not other._child
