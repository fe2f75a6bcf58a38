"""The command line: exit codes, streams, files, and no traceback."""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

import rttrr_pin
from rttrr_pin.cli import main
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.implementations import registry
from support.serial_chains import EXAMPLES
from support.tolerances import ROUNDING, norm_error


def run(*words: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "rttrr_pin", *words], capture_output=True, text=True, cwd=cwd, timeout=600, check=False
    )


def test_main_job_from_another_folder(tmp_path: Path) -> None:
    """No argument: the bundled arm."""
    done = run("validate", cwd=tmp_path)
    assert done.returncode == 0
    assert "PASS all of 10,000 states x 29 rows" in done.stdout
    assert "rttrr-pin state --index" in done.stdout
    assert done.stderr == ""
    assert list(tmp_path.iterdir()) == []


def test_json_on_stdout_is_all_there_is(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["validate", "--states", "300", "--seed", "5", "--json", "-"]) == 0
    out, err = capsys.readouterr()
    data = json.loads(out)
    assert err == ""
    assert (data["robot"], data["seed"], data["n_states"], data["passed"]) == ("rttrr", 5, 300, True)
    (reference,) = data["references"]
    assert set(reference["quantities"]) == set(QUANTITIES)
    assert set(reference["quantities"]["n"]) == set(rttrr_pin.load("rttrr").link_names)
    assert {"rttrr-pin", "pinocchio", "numpy", "python"} <= set(data["versions"])
    row = reference["quantities"]["tau"]["joint_1"]
    assert row["passed"] and 0 <= row["relative"]["state"] < 300


def test_json_file_is_written_whole_beside_the_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "out.json"
    assert main(["validate", "--states", "50", "--json", str(target)]) == 0
    assert "PASS" in capsys.readouterr().out
    assert json.loads(target.read_text())["n_states"] == 50
    assert [path.name for path in tmp_path.iterdir()] == ["out.json"]


def test_quiet_prints_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["validate", "--states", "50", "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


def test_one_state_in_full(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["state", "--index", "7", "--payload", "1,2,3,4,5,6", "--payload-axes", "base"]) == 0
    out = capsys.readouterr().out
    assert "state 7" in out and "payload at tool, base axes" in out
    assert main(["state", "--index", "7", "--json", "-"]) == 0
    data = json.loads(capsys.readouterr().out)
    robot = rttrr_pin.load("rttrr")
    again = robot.inverse_dynamics(data["q"], data["v"], data["a"])
    assert norm_error(data["values"]["tau"], again.tau) <= ROUNDING
    assert set(data["references"][0]["values"]) == set(QUANTITIES)


def test_the_same_words_give_the_same_bytes(capsys: pytest.CaptureFixture[str]) -> None:
    texts = []
    for _ in range(2):
        assert main(["state", "--index", "3", "--payload", "random", "--json", "-"]) == 0
        texts.append(capsys.readouterr().out)
    assert texts[0] == texts[1]


def test_gravity_is_passed_on(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["state", "--index", "0", "--gravity", "0,0,0", "--sampling", "zeros", "--json", "-"]) == 0
    still = json.loads(capsys.readouterr().out)
    assert main(["state", "--index", "0", "--sampling", "zeros", "--json", "-"]) == 0
    heavy = json.loads(capsys.readouterr().out)
    assert heavy["q"] == still["q"]
    assert heavy["values"]["tau"] != still["values"]["tau"]


def test_long_tables_are_cut_unless_full(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from support.serial_chains import random_chain

    path = tmp_path / "long.urdf"
    path.write_text(random_chain(9, ("revolute", "fixed") * 12))
    assert main(["validate", str(path), "--states", "20"]) == 0
    short = capsys.readouterr().out
    assert main(["validate", str(path), "--states", "20", "--full"]) == 0
    assert "--full shows all" in short
    assert len(capsys.readouterr().out.splitlines()) > len(short.splitlines()) + 50


def test_names_are_not_markup(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A link may be called [bold]."""
    path = tmp_path / "odd.urdf"
    path.write_text(EXAMPLES["one-joint"].replace("link_1", "[bold]x").replace("joint_1", "[/]j"))
    assert main(["validate", str(path), "--states", "5"]) == 0
    out = capsys.readouterr().out
    assert "[bold]x" in out and "[/]j" in out


UNUSABLE = {
    "no-such-robot": (["validate", "rttr"], "did you mean"),
    "no-such-file": (["validate", "a/b.urdf"], "no bundled robot or file is called 'a/b.urdf'"),
    "no-such-option": (["validate", "--sed", "1"], "No such option '--sed'"),
    "states-word": (["validate", "--states", "many"], "--states"),
    "no-states": (["validate", "--states", "0"], "states is 0"),
    "sampling": (["validate", "--sampling", "corner"], "did you mean corners"),
    "payload": (["validate", "--payload", "1,2,3"], "expected 6 numbers"),
    "payload-word": (["validate", "--payload", "a,b,c,d,e,f"], "expected 6 numbers"),
    "payload-link": (["validate", "--payload", "1,2,3,4,5,6", "--payload-link", "hand"], "no link is called 'hand'"),
    "payload-link-alone": (["validate", "--payload-link", "tool"], "goes with a payload"),
    "payload-axes": (["validate", "--payload", "1,2,3,4,5,6", "--payload-axes", "world"], "expected link or base"),
    "payload-nan": (["validate", "--payload", "nan,2,3,4,5,6"], "expected 6 numbers"),
    "gravity": (["validate", "--gravity", "9.81"], "--gravity is '9.81': expected 3 numbers"),
    "seed": (["validate", "--seed", "-1"], "seed is -1"),
    "state": (["state", "--index", "-1"], "--index is -1: expected a whole number from 0"),
    "state-huge": (["state", "--index", "99999999999999999999"], "expected a whole number from 0 to 10^15"),
    "gravity-word": (["validate", "--gravity", "1_0,0,0"], "expected 3 numbers"),
    "nothing": (["validate", ""], "is empty"),
    "oracle": (["validate", "--reference", "bullet"], "there are kernel"),
    "payload-tiny": (["validate", "--payload", "1,2,3,4,5,1e-400"], "--payload: 1e-400 is smaller than float64 can"),
    "gravity-huge": (["validate", "--gravity", "0,0,1e400"], "--gravity: 1e400 is larger than float64 can hold"),
    "sample-none": (["sample", "-n", "0"], "-n is 0: expected a whole number from 1"),
    "sample-format": (["sample", "-o", "states.txt"], "expected the name of a .csv, .parquet, .jsonl file"),
    "sample-payload": (["sample", "--payload", "1,2,3,4,5,6"], "expected random or none"),
    "sample-link": (["sample", "--payload-link", "hand"], "no link is called 'hand'"),
    "sample-link-alone": (["sample", "--payload", "none", "--payload-link", "tool"], "leave --payload none out"),
    "diagnose-nothing": (["diagnose"], "name a table of results or a --subject, one of the two"),
    "diagnose-both": (["diagnose", "rttrr", "a.csv", "--subject", "kernel"], "one of the two"),
    "diagnose-states": (["diagnose", "--subject", "kernel", "--states", "0"], "--states is 0: expected a whole number"),
    "diagnose-program": (["diagnose", "--subject", "./my_id"], "there is no file ./my_id"),
    "diagnose-folder": (["diagnose", "rttrr", "tests"], "a table is a file .csv, .jsonl or .parquet"),
    "diagnose-reference": (["diagnose", "--subject", "kernel", "--reference", "bullet"], "there are kernel"),
    "diagnose-half-a-letter": (["diagnose", "--subject", "kernel", "--reference", "\ud800"], "there are kernel"),
    "diagnose-table": (["diagnose", "rttrr", "no.csv"], "no.csv cannot be read"),
    "diagnose-page": (["diagnose", "--subject", "kernel", "--html", "no/such/folder/x.html"], "cannot be written"),
    "diagnose-twice": (["diagnose", "--subject", "kernel", "--html", "-", "--json", "-"], "both go to stdout"),
    "compare-robot": (["compare", "rttrr", "rttr"], "did you mean"),
    "no-check": (["inspect", "--select", "P", "--ignore", "P"], "no check is left to run"),
    "json-folder": (["validate", "--states", "5", "--json", "no/such/folder/x.json"], "cannot be written"),
    "no-command": ([], "Usage"),
    "no-such-command": (["valdate"], "No such command"),
    "derive-quantity": (["derive", "--quantity", "taus"], "no quantity is called 'taus': did you mean tau"),
    "derive-form": (["derive", "--form", "short"], "no form is called 'short': there are auto, expanded, stepwise"),
    "derive-payload": (["derive", "--payload-link", "hand"], "no link is called 'hand'"),
    "derive-twice": (["derive", "--latex", "-", "--c", "-"], "--latex and --c both go to stdout"),
    "derive-folder": (["derive", "--python", "no/such/folder/x.py"], "cannot be written"),
    "derive-robot": (["derive", "rttr"], "did you mean"),
}


@pytest.mark.parametrize("case", UNUSABLE)
def test_unusable_input_exits_2_and_says_why(case: str, capsys: pytest.CaptureFixture[str]) -> None:
    words, message = UNUSABLE[case]
    assert main(words) == 2
    out, err = capsys.readouterr()
    assert message in err
    assert "Traceback" not in err and out == ""


def test_a_damaged_file_exits_2_with_its_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "bad.urdf"
    path.write_text('<robot name="x">\n<link name="a"><inertial><mass value="1,5"/></inertial></link></robot>')
    assert main(["validate", str(path)]) == 2
    assert "line 2" in capsys.readouterr().err


def test_disagreement_exits_1(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(registry.BUILT_IN, "wrong", "support.implementations:Wrong")
    assert main(["validate", "--states", "20", "--reference", "wrong"]) == 1
    assert "FAIL 1 of 29 rows beyond rounding, first n at link_3" in capsys.readouterr().out
    assert main(["state", "--index", "3", "--reference", "wrong"]) == 1
    assert main(["validate", "--states", "20", "--reference", "wrong", "--quiet", "--json", "-"]) == 1
    assert '"passed": false' in capsys.readouterr().out


def test_another_model_than_the_file_exits_1(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("rttrr_pin.implementations.pinocchio.differences", lambda assembly: ["link 'link_2' mass: 0"])
    assert main(["validate", "--states", "20"]) == 1
    assert "link 'link_2' mass" in capsys.readouterr().err


def test_version_and_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"rttrr-pin {rttrr_pin.__version__}\n"
    assert main(["validate", "--help"]) == 0
    assert "--payload" in capsys.readouterr().out


def test_json_goes_into_a_pipe_and_through_a_link(tmp_path: Path) -> None:
    """What is no file is written to, and not replaced."""
    os.mkfifo(tmp_path / "fifo")
    (tmp_path / "link.json").symlink_to(tmp_path / "target.json")
    reader = subprocess.Popen(["cat", str(tmp_path / "fifo")], stdout=subprocess.PIPE, text=True)
    assert main(["validate", "--states", "5", "--quiet", "--json", str(tmp_path / "fifo")]) == 0
    out, _ = reader.communicate(timeout=600)
    assert json.loads(out)["passed"]
    assert (tmp_path / "fifo").is_fifo()
    assert main(["validate", "--states", "5", "--quiet", "--json", str(tmp_path / "link.json")]) == 0
    assert (tmp_path / "link.json").is_symlink()
    assert json.loads((tmp_path / "target.json").read_text())["n_states"] == 5


def test_the_command_for_the_worst_state_draws_that_state(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """And writes no file anew."""
    words = [
        "validate",
        "--states",
        "300",
        "--seed",
        "3",
        "--payload",
        "random",
        "--base",
        "floating",
        "--json",
        str(tmp_path / "x.json"),
    ]
    assert main(words) == 0
    line = capsys.readouterr().out.splitlines()[-1]
    again = shlex.split(line.split(": ", 1)[1])
    assert "--json" not in again
    worst = json.loads((tmp_path / "x.json").read_text())["references"][0]["worst"]
    assert main([*again[1:], "--json", "-"]) == 0
    differences = json.loads(capsys.readouterr().out)["references"][0]["differences"]
    assert max(one["of_tolerance"] for one in differences) == worst["value"]


def test_what_is_not_by_default_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["validate", "--states", "5", "--base", "floating", "--gravity", "0,0,-1.62"]) == 0
    assert "floating base, gravity (0, 0, -1.62) m/s^2" in " ".join(capsys.readouterr().out.split())
    assert main(["validate", "--states", "5", "--base", "floating", "--gravity", "0,0,-1.62", "--json", "-"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert (data["base"], data["gravity"]) == ("floating", [0, 0, -1.62])


def test_what_an_mjcf_file_has_beyond_a_tree_is_a_warning_and_in_the_report(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(
        '<mujoco model="arm"><option gravity="0 0 -1"/><worldbody><body><joint name="j" axis="0 1 0" stiffness="2" damping="3"/>'
        '<inertial pos="1 0 0" mass="2" diaginertia="1 1 1"/></body></worldbody></mujoco>'
    )
    for command in ("validate --states 20", "state", "search --evaluations 512", "laws --states 5"):
        words = shlex.split(f"{command} {path} --subject recursion --friction")
        assert main([*words, "--json", "-"]) == 0
        printed = capsys.readouterr()
        assert printed.err == f"warning: {path}: left out of tau, though MuJoCo's mj_inverse has it: springs\n"
        assert any("springs" in note for note in json.loads(printed.out)["notes"])
        assert main([*words, "-q"]) == 0
        assert capsys.readouterr() == ("", "")
    main(shlex.split(f"validate {path} --subject recursion --states 5"))
    printed = capsys.readouterr()
    assert "gravity [0, 0, -1]" in printed.out.replace("(", "[").replace(")", "]").replace("-1.0", "-1").replace(
        ".0", ""
    )
    assert "--friction): damping of j" in printed.err


def test_other_formats_than_urdf_are_refused_by_inspect_with_the_way_on(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for text, message in (("<mujoco/>", "this is MJCF, which load, validate"), ("<sdf/>", "convert it to URDF")):
        (tmp_path / "robot.xml").write_text(text)
        assert main(["inspect", str(tmp_path / "robot.xml")]) == 2
        assert message in capsys.readouterr().err
