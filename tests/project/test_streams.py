"""The command line when its words, its streams or its user misbehave: an exit code and a sentence, no traceback."""

from __future__ import annotations

import io
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from rttrr_pin.__main__ import run
from rttrr_pin.cli import main
from support.serial_chains import EXAMPLES

READY = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # a test run in the background hands down an ignored SIGINT
from rttrr_pin.cli import main
main(["validate", "--states", "5", "--quiet"])  # imports everything: some libraries lose a Ctrl-C in that time
print("ready", flush=True)
sys.exit(main(sys.argv[1:]))
"""
"""A program that says when it is warm, and then does what its words say."""


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["validate", "--states"], "'--states' requires an argument"),
        (["validate", "--quiet=3"], "'--quiet' does not take a value"),
        (["inspect", "--json"], "'--json' requires an argument"),
    ],
)
def test_an_option_without_its_value_or_with_one_too_many(
    words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == 2
    error = capsys.readouterr().err
    assert message in error and f"see: rttrr-pin {words[0]} --help" in error


@pytest.mark.one_in(2)
@pytest.mark.parametrize(
    ("command", "code", "message"),
    [
        ("inspect >/dev/full", 2, "standard output: No space left on device"),
        ("--help >/dev/full", 2, "standard output: No space left on device"),
        ("inspect --json - >&- 2>&-", 0, ""),
        ("valdate 2>/dev/full", 2, ""),
    ],
)
def test_streams_that_take_nothing(command: str, code: int, message: str) -> None:
    words = ["sh", "-c", f"{sys.executable} -m rttrr_pin {command}"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == code
    assert message in done.stderr and "Traceback" not in done.stderr and "Exception ignored" not in done.stderr


COMMANDS: dict[str, list[str]] = {
    "validate": ["validate", "{robot}", "--states", "20", "--full"],
    "validate a folder": ["validate", "{folder}", "--states", "20"],
    "state": ["state", "{robot}"],
    "search": ["search", "{robot}", "--evaluations", "600"],
    "laws": ["laws", "{robot}", "--states", "20"],
    "sample": ["sample", "{robot}", "-n", "20"],
    "diagnose": ["diagnose", "{robot}", "--subject", "support.implementations:still", "--states", "20"],
    "conform": ["conform", "recursion", "{robot}", "-n", "2"],
    "compare": ["compare", "{robot}", "{robot}", "--full"],
    "derive": ["derive", "{robot}"],
    "inspect": ["inspect", "{robot}"],
    "audit": ["audit"],
    "new": ["new", "RT"],
}


def words_of(command: str, tmp_path: Path) -> list[str]:
    """The words for a robot whose name, links and joints have letters that ASCII and Latin-1 lack."""
    text = EXAMPLES["any-axes"].replace('"chain_1"', '"Pfl\u00fcger \u0141"')
    for tag in ("link", "joint"):
        text = text.replace(f'"{tag}_1"', f'"{tag}_\u00e4\u4e09"')
    folder = tmp_path / "robots"
    folder.mkdir(exist_ok=True)
    for name in ("\u00fc", "b"):
        (folder / f"{name}.urdf").write_text(text, encoding="utf-8")
    return [word.format(robot=folder / "\u00fc.urdf", folder=folder) for word in COMMANDS[command]]


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("encoding", ["ascii", "latin-1"])
def test_a_terminal_that_lacks_letters_gets_them_escaped(
    command: str, encoding: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    words = words_of(command, tmp_path)
    codes = []
    for own in (encoding, "utf-8"):
        shown = io.BytesIO()
        monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(shown, encoding=own))
        codes.append(main(words))
        assert shown.getvalue().decode(own)
    assert codes[0] == codes[1] < 2


@pytest.mark.one_in(12)
@pytest.mark.parametrize("command", COMMANDS)
def test_a_full_disk_behind_the_output_is_an_error(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with Path("/dev/full").open("w", encoding="utf-8") as full, monkeypatch.context() as patch:
        patch.setattr(sys, "stdout", full)
        assert main(words_of(command, tmp_path)) == 2
    assert "standard output: No space left on device" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize("command", [name for name in COMMANDS if name not in ("derive", "new", "sample")])
def test_who_prints_nothing_needs_no_output(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    words = [*words_of(command, tmp_path), "--quiet", "--json", str(tmp_path / "out.json")]
    if "--full" in words:
        words.remove("--full")
    with Path("/dev/full").open("w", encoding="utf-8") as full, monkeypatch.context() as patch:
        patch.setattr(sys, "stdout", full)
        assert main(words) < 2
    assert json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("command", COMMANDS)
def test_names_of_three_hundred_letters_are_told_to_be_too_long(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    name = {"new": ["-o", "n" * 300], "audit": ["n" * 300]}.get(command, [])
    words = [word.format(robot="n" * 300, folder="n" * 300) for word in COMMANDS[command]]
    assert main([*words, *name]) == 2
    error = capsys.readouterr().err
    assert "File name too long" in error and len(error) < 500


@pytest.mark.slow
@pytest.mark.parametrize("command", ["inspect", "state", "audit"])
def test_warnings_of_other_libraries_are_no_tracebacks(command: str, tmp_path: Path) -> None:
    words = [sys.executable, "-W", "error", "-m", "rttrr_pin", *words_of(command, tmp_path)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=600, check=False)
    assert "Traceback" not in done.stderr
    assert done.returncode in (0, 1) or (done.returncode == 2 and "-W or PYTHONWARNINGS" in done.stderr)


@pytest.mark.parametrize("words", [[], ["--json", "-"]], ids=["table", "json"])
def test_a_reader_that_leaves_does_not_change_the_verdict(words: list[str]) -> None:
    read, write = os.pipe()
    os.close(read)
    command = [sys.executable, "-m", "rttrr_pin", "validate", "--states", "50", *words]
    done = subprocess.run(command, stdout=write, stderr=subprocess.PIPE, text=True, timeout=600, check=False)
    os.close(write)
    assert done.returncode == 0
    assert "Traceback" not in done.stderr


def test_a_file_that_may_not_be_read_is_named(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError(13, "Permission denied", "robots")

    monkeypatch.setattr("rttrr_pin.cli._run", refuse)
    assert main(["validate", "robots"]) == 2
    assert capsys.readouterr().err == "error: robots: Permission denied\n"


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (MemoryError(), "error: there is not enough memory"),
        (RecursionError("too deep"), "error: too deep"),
        (ImportError("libx.so: failed to map segment"), "error: a library cannot be loaded: libx.so"),
        (FileNotFoundError(2, "No such file or directory"), "error: the current folder: No such file"),
    ],
)
def test_no_failure_is_a_verdict(
    error: Exception, said: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise error

    monkeypatch.setattr("rttrr_pin.cli._run", fail)
    assert main(["validate"]) == 2
    assert said in capsys.readouterr().err


def test_a_fault_of_ours_is_no_verdict(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> int:
        raise KeyError("x")

    monkeypatch.setattr("rttrr_pin.cli.main", fail)
    monkeypatch.setattr("rttrr_pin.__main__.interrupts.install", lambda: None)
    assert run() == 2
    assert "KeyError: 'x'\nerror: this is a fault of rttrr-pin" in capsys.readouterr().err


def test_interrupt_leaves_cleanly(tmp_path: Path) -> None:
    """Ctrl-C in a long run: exit 130, one line, no file, no traceback."""
    words = ["validate", "--states", "100000000", "--json", str(tmp_path / "out.json")]
    process = subprocess.Popen(
        [sys.executable, "-c", READY, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None and process.stdout.readline() == "ready\n"
    time.sleep(1)
    process.send_signal(signal.SIGINT)
    out, error = process.communicate(timeout=600)
    assert process.returncode == 130
    assert out == ""
    assert "interrupted" in error and "Traceback" not in error
    assert list(tmp_path.iterdir()) == []
