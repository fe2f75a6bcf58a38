"""The command `derive`: what it prints and writes, and what it refuses."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import pytest

from rttrr_pin import Wrench
from rttrr_pin import derivation as symbolic
from rttrr_pin.cli import main
from rttrr_pin.compile.emit.c import compiler
from rttrr_pin.derivation.writers import WRITERS
from support.derivations import derived, drawn, robot
from support.tolerances import ROUNDING, norm_error


def test_the_command_says_how_long_the_forms_are(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["derive", "--quantity", "tau", "--quantity", "g"]) == 0
    out = capsys.readouterr().out
    assert "expanded form" in out and "--latex FILE" in out
    total = derived("rttrr", "auto", "letters")
    counted = sum(len(x) for name in ("tau", "g") for x in total.quantities[name].terms.values())
    assert f"{counted} terms in all" in out


def test_files_and_standard_output(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files = {name: tmp_path / f"model{suffix}" for name, suffix in (("latex", ".tex"), ("python", ".py"))}
    words = [word for name, path in files.items() for word in (f"--{name}", str(path))]
    assert main(["derive", "trr", "--quantity", "g", "--c", "-", *words]) == 0
    out, err = capsys.readouterr()
    assert out.startswith("/* Dynamic model of trr") and err == ""
    assert files["latex"].read_text().startswith("\\documentclass")
    assert files["python"].read_text().startswith('"""Dynamic model of trr')
    assert sorted(tmp_path.iterdir()) == sorted(files.values())


LONG_NAMES = {
    "words": "a very long robot name " * 20,
    "one word": "x" * 3000,
    "signs": "\u03b8*/ ??/" * 100,
    "a digit": "2R",
}


@pytest.mark.parametrize("kind", LONG_NAMES)
@pytest.mark.parametrize("numbers", [[], ["--numbers"]], ids=["letters", "numbers"])
def test_programs_take_any_name_of_a_robot(kind: str, numbers: list[str], tmp_path: Path) -> None:
    text = robot("two-joints").model.urdf
    assert text is not None
    (tmp_path / "a.urdf").write_text(re.sub('robot name="[^"]*"', f"robot name={quoteattr(LONG_NAMES[kind])}", text))
    source, code = tmp_path / "a.c", tmp_path / "a.py"
    words = ["derive", str(tmp_path / "a.urdf"), "--c", str(source), "--python", str(code), "-q", *numbers]
    assert main([*words, "--quantity", "tau", "--quantity", "C"]) == 0
    compile(code.read_text(), "a.py", "exec")
    flags = ("-std=c99", "-O0", "-Wall", "-Wextra", "-Werror", "-pedantic", "-fsyntax-only")
    done = subprocess.run([*compiler(), *flags, source], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_formulas_are_printed_where_they_fit_the_screen(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Whole quantities in order; what is printed is the polynomial."""
    derivation = symbolic.derive(robot("rttrr"), ["n", "g"])
    ring, names = derivation.ring, derivation.symbols
    for columns, height in ((200, 60), (40, 10)):
        monkeypatch.setenv("COLUMNS", str(columns))
        monkeypatch.setenv("LINES", str(height))
        assert main(["derive", "--quantity", "n", "--quantity", "g"]) == 0
        out = capsys.readouterr().out
        shown = re.findall(r"^g_(\d) = (.*(?:\n +.*)*)", out, re.M)
        assert len(shown) == 5 and "too long for this screen: n" in out
        assert max(map(len, re.search(r"^g_1 = .*?(?=\nto)", out, re.M | re.S)[0].split("\n"))) <= columns
        for k, text in shown:
            code = re.sub(r"(?<=[\w)]) (?=[\w(])", "*", " ".join(text.split("\ntoo")[0].split())).replace("^", "**")
            value = eval(code, {name: ring[name] for name in names})
            assert ring.reduced(value) == ring.polynomial(derivation.quantities["g"].terms[int(k) - 1,])


def test_the_payload_is_that_of_robots_with_one_last_link() -> None:
    """Through the Robot, in base axes or link axes, with the wrench that its own function takes."""
    derivation = symbolic.derive(robot("rttrr"), ["tau"])
    module: dict[str, Any] = {}
    exec(WRITERS["python"](derivation), module)
    at, payload = drawn("rttrr")
    ours = robot("rttrr").inverse_dynamics(at.q, at.v, at.a, Wrench(payload[:, :3], payload[:, 3:])).tau
    assert norm_error(module["tau"](at.q, at.v, at.a, payload), ours) <= ROUNDING
    assert module["tau"](at.q[0], at.v[0], at.a[0]).shape == (5,)
    with pytest.raises(ValueError, match=r"q has shape \(4,\), expected \(\.\.\., 5\)"):
        module["tau"](at.q[0, :4], at.v[0], at.a[0])
