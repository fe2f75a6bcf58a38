"""The command line when its words, its streams or its user misbehave: an exit code and a sentence, no traceback."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from rttrr_pin.cli import main

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
