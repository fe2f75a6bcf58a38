"""Files of equations that are meant to do harm, or are no files: each ends in a sentence, soon, and in little memory."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

import rttrr_pin.urdf.files as files
from fuzz.text_campaign import check
from fuzz.text_cases import EXPRESSIONS, HOSTILE, PYTHON, TWO_LINK
from rttrr_pin.auditing import audit, read_publication
from rttrr_pin.cli import main
from rttrr_pin.derivation.expressions import read_expression
from rttrr_pin.errors import EquationError, InputError


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_ends_in_a_sentence(name: str, tmp_path: Path) -> None:
    import random

    for k in range(3):
        ending, text = HOSTILE[name](random.Random(k))
        outcome = check(ending, text.encode(errors="surrogatepass"), tmp_path)
        assert not outcome["failure"], (k, outcome, text[:200])


@pytest.mark.parametrize("text", EXPRESSIONS, ids=lambda text: ascii(text[:20]))
def test_a_hostile_expression_is_read_or_refused_at_once(text: str) -> None:
    started = time.process_time()
    with suppress(InputError):
        read_expression(text, ["m_1", "m_2", "l_1"])
    assert time.process_time() - started < 1.0


DEVICES = ["/dev/zero", "/dev/urandom", "/dev/full", "/dev/null", "/"]


@pytest.mark.parametrize("path", DEVICES)
@pytest.mark.parametrize("as_key", [False, True])
def test_devices_are_refused(path: str, as_key: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    if as_key:
        (tmp_path / "a.toml").write_text(f'symbols = "{path}"\n')
    assert main(["audit", str(tmp_path / "a.toml") if as_key else path]) == 2
    assert capsys.readouterr().err.startswith("error: ")


def test_a_pipe_that_nobody_writes_to_is_given_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "PATIENCE", 0.1)
    pipe = tmp_path / "pipe.toml"
    os.mkfifo(pipe)
    with pytest.raises(EquationError, match=r"pipe\.toml.*does not come"):
        read_publication(pipe)


def test_a_pipe_is_read_like_a_file() -> None:
    code = "import sys; from rttrr_pin.cli import main; sys.exit(main(['audit', '/dev/stdin', '--json', '-']))"
    done = subprocess.run([sys.executable, "-c", code], input=TWO_LINK, capture_output=True, text=True)
    assert done.returncode == 1 and '"tau1.1"' in done.stdout, done.stderr


@pytest.mark.parametrize("letter", ["θ", "中", "𝒳", "ﬁ"])
@pytest.mark.parametrize("language", ["latex", "python"])
def test_letters_of_any_script_are_symbols_that_may_be_unknown(letter: str, language: str, tmp_path: Path) -> None:
    head = TWO_LINK if language == "latex" else PYTHON
    head = head.split("[[equation]]")[0]
    text = head + f"[[equation]]\nquantity = \"tau\"\njoint = 1\n{language} = '''g + {letter}'''\n"
    (tmp_path / "a.toml").write_text(text)
    (component,) = audit(read_publication(tmp_path / "a.toml")).components
    assert component.undeclared or component.unparsed
    declared = text.replace(
        'dimension = "mass"', f'dimension = "mass"\n[[symbol]]\nname = "{letter}"\ndimension = "mass"', 1
    )
    (tmp_path / "a.toml").write_text(re.sub('mass = "(m_1|M)"', rf'mass = "\1 + {letter}"', declared))
    with suppress(EquationError):
        (component,) = audit(read_publication(tmp_path / "a.toml")).components
        assert component.findings


def test_names_reach_the_terminal_as_signs_only(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    evil = r"\u001b]0;owned\u0007\u001b[2J\u009b31m\u202e"
    text = TWO_LINK.replace('title = "', f'title = "{evil}').replace('number = "tau_1"', f'number = "{evil}"')
    (tmp_path / "a.toml").write_text(text)
    assert main(["audit", str(tmp_path / "a.toml")]) == 1
    assert main(["audit", str(tmp_path / "a.toml"), "--equation", "\x1b[2J"]) == 2
    shown = "".join(capsys.readouterr())
    assert "owned" in shown and not any(sign in shown for sign in "\x1b\x07\x9b\u202e")


def test_an_interruption_says_which_files_were_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from rttrr_pin.auditing import command

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    (tmp_path / "a.toml").write_text(TWO_LINK)
    words = ["audit", str(tmp_path / "a.toml"), "--json", str(tmp_path / "a.json"), "--html", str(tmp_path / "a.html")]
    with monkeypatch.context() as patch:
        patch.setattr(command, "run_audit", interrupted)
        assert main(words) == 130
    assert "nothing was written" in capsys.readouterr().err and not (tmp_path / "a.json").exists()
    monkeypatch.setattr(command, "show_audit", interrupted)
    assert main(words) == 130
    said = capsys.readouterr().err
    assert "a.json" in said and "a.html" in said and "nothing was" not in said
    assert (tmp_path / "a.json").exists() and (tmp_path / "a.html").exists()
