"""Ctrl-C and SIGTERM end the program with their exit code and a true sentence, wherever they arrive."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from xml.etree.ElementTree import Element

import pytest

from rttrr_pin.cli import main
from rttrr_pin.reporting import files, interrupts
from rttrr_pin.reporting.interrupts import Interrupted, held_back
from support.processes import left_behind, of_session
from support.serial_chains import EXAMPLES

SIGNALS = pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=["SIGINT", "SIGTERM"])

SWALLOWS = """
import os, time
try:
    os.kill(os.getpid(), {number})
    time.sleep(0.1)
except BaseException:
    pass
whole = True
"""
"""A library that loses what reaches it while it is imported, as trimesh does."""


@pytest.fixture
def installed() -> Iterator[None]:
    """Handlers as in a run; a run in the background of a shell inherits an ignored SIGINT."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    undo = interrupts.install()
    yield
    undo()
    signal.signal(signal.SIGINT, before)


def kill(number: int) -> None:
    os.kill(os.getpid(), number)


def wait_after(work: Callable[[], object]) -> None:
    """Time for a signal that waits."""
    work()
    time.sleep(10)


@SIGNALS
@pytest.mark.usefixtures("installed")
def test_a_signal_in_an_import_waits_until_it_is_over(
    number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    name = f"swallows_{int(number)}"
    (tmp_path / f"{name}.py").write_text(SWALLOWS.format(number=int(number)))
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(Interrupted):
        wait_after(lambda: __import__(name))
    assert sys.modules[name].whole
    assert interrupts.ending()[0] == 128 + number


@pytest.mark.usefixtures("installed")
def test_a_second_signal_does_not_wait() -> None:
    with held_back():
        kill(signal.SIGINT)
        with pytest.raises(Interrupted):
            wait_after(lambda: kill(signal.SIGINT))


@SIGNALS
@pytest.mark.usefixtures("installed")
def test_a_file_is_whole_whenever_the_signal_comes(
    number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    replace = Path.replace
    monkeypatch.setattr(Path, "replace", lambda self, target: (kill(number), time.sleep(0.1), replace(self, target))[2])
    with pytest.raises(Interrupted):
        wait_after(lambda: files.write_whole(tmp_path / "out.json", "whole"))
    assert [path.name for path in tmp_path.iterdir()] == ["out.json"]
    assert (tmp_path / "out.json").read_text() == "whole"
    assert interrupts.ending()[1].endswith("out.json written, nothing else")


def test_handlers_are_put_back() -> None:
    before = [signal.getsignal(number) for number in (*interrupts.ENDING, signal.SIGALRM)]
    assert main(["--version"]) == 0
    assert [signal.getsignal(number) for number in (*interrupts.ENDING, signal.SIGALRM)] == before


def test_an_ignored_signal_stays_ignored(monkeypatch: pytest.MonkeyPatch) -> None:
    """As of a program that a shell started in the background."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        monkeypatch.setattr("rttrr_pin.cli._run", lambda words: kill(signal.SIGINT) or 0)
        assert main(["validate"]) == 0
    finally:
        signal.signal(signal.SIGINT, before)


@SIGNALS
def test_the_exit_code_is_the_signals_where_a_library_has_swallowed_it(
    number: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def swallow(words: list[str]) -> int:
        try:
            kill(number)
            time.sleep(10)
        except BaseException:
            return 0
        return 1

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    monkeypatch.setattr("rttrr_pin.cli._run", swallow)
    try:
        assert main(["validate"]) == 128 + number
    finally:
        signal.signal(signal.SIGINT, before)
    assert capsys.readouterr().err == f"{interrupts.ENDING[number]}: nothing was written\n"


@pytest.mark.slow
def test_what_was_written_before_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    monkeypatch.setattr("rttrr_pin.auditing.command.show_audit", lambda *_: (kill(signal.SIGINT), time.sleep(10)))
    out = tmp_path / "audit.json"
    try:
        assert main(["audit", "--json", str(out)]) == 130
    finally:
        signal.signal(signal.SIGINT, before)
    assert capsys.readouterr().err == f"interrupted: {out} written, nothing else\n"
    assert out.read_text().endswith("}\n")


def started(words: list[str], **environment: str) -> subprocess.Popen[str]:
    """The program in a session of its own, with signals as a terminal has them."""
    command = [sys.executable, "-m", "rttrr_pin", *words]
    return subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        env=os.environ | environment,
    )


def wait_for(condition: object, seconds: float = 120.0) -> None:
    deadline = time.monotonic() + seconds
    while not condition():  # type: ignore[operator]
        assert time.monotonic() < deadline
        time.sleep(0.02)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    place = tmp_path / "robots"
    place.mkdir()
    for name in ("any-axes", "fixed-between"):
        (place / f"{name}.urdf").write_text(EXAMPLES[name])
    return place


@pytest.mark.one_in(3)
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL], ids=lambda number: number.name)
@pytest.mark.parametrize("whom", ["the program", "its group"])
def test_no_worker_outlives_the_program(number: signal.Signals, whom: str, folder: Path, tmp_path: Path) -> None:
    process = started(["validate", str(folder), "--states", "100000000", "--json", str(tmp_path / "out.json")])
    wait_for(lambda: len(of_session(process.pid)) >= 3)  # two workers and more
    time.sleep(0.5)
    (os.kill if whom == "the program" else os.killpg)(process.pid, number)
    out, error = process.communicate(timeout=60)
    assert process.returncode == (-9 if number == signal.SIGKILL else 128 + number)
    assert left_behind(process.pid) == []
    assert not (tmp_path / "out.json").exists()
    if number != signal.SIGKILL:
        assert (out, error) == ("", f"{interrupts.ENDING[number]}: nothing was written\n")


@pytest.mark.one_in(2)
@SIGNALS
def test_no_program_under_test_outlives_diagnose(number: signal.Signals, folder: Path, tmp_path: Path) -> None:
    program, noted = tmp_path / "my_id", tmp_path / "pid"
    note = f"open({str(noted) + '.part'!r}, 'w').write(str(os.getpid())); os.rename({str(noted) + '.part'!r}, {str(noted)!r})"
    program.write_text(f"#!{sys.executable}\nimport os, time\n{note}\ntime.sleep(1000)\n")
    program.chmod(0o755)
    words = ["diagnose", str(folder / "any-axes.urdf"), "--subject", str(program), "--html", str(tmp_path / "out.html")]
    process = started(words)
    wait_for(noted.exists)
    child = int(noted.read_text())
    os.kill(process.pid, number)
    out, error = process.communicate(timeout=60)
    assert (process.returncode, out) == (128 + number, "")
    assert error == f"{interrupts.ENDING[number]}: nothing was written\n"
    assert left_behind(process.pid) == left_behind(child) == []
    assert not (tmp_path / "out.html").exists()


@SIGNALS
def test_a_signal_of_which_a_library_makes_another_exception(
    number: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """`Element.extend` raises TypeError, whatever a generator raises."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    monkeypatch.setattr("rttrr_pin.cli._run", lambda words: Element("a").extend(kill(number) for _ in "a"))
    assert main(["new", "RT"]) == 128 + number
    signal.signal(signal.SIGINT, before)
    assert capsys.readouterr().err.endswith("nothing was written\n")


def test_an_exception_without_a_signal_is_raised(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rttrr_pin.cli._run", lambda words: Element("a").extend(1 / 0 for _ in "a"))
    with pytest.raises(TypeError):
        main(["new", "RT"])


def test_a_signal_that_waits_ends_with_the_program() -> None:
    """Python gives up its handlers before it ends: the timer of a signal that waits would end the process by itself."""
    code = (
        "import atexit, signal, time; from rttrr_pin.reporting import interrupts; interrupts.install(); "
        "signal.setitimer(signal.ITIMER_REAL, 0.05); signal.signal(signal.SIGALRM, signal.SIG_DFL); "
        "interrupts.ignore(); time.sleep(0.15)"
    )
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
