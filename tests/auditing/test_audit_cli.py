"""`rttrr-pin audit`: what it writes, how it ends, and what it says of files that it cannot use."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from rttrr_pin.cli import main

TWO_LINK = Path(__file__).parents[2] / "examples/audit_two_link.toml"
MISPRINT, MENDED = r"- m_2 l_1 l_2 s_2 \dot{\theta}_1", r"- 2 m_2 l_1 l_2 s_2 \dot{\theta}_1"


@pytest.fixture
def clean(tmp_path: Path) -> Path:
    """The example without its planted error."""
    return changed(tmp_path, (MISPRINT, MENDED))


def changed(folder: Path, *changes: tuple[str, str], name: str = "equations.toml") -> Path:
    text = TWO_LINK.read_text()
    for old, new in changes:
        assert text.count(old) >= 1, old
        text = text.replace(old, new, 1)
    path = folder / name
    path.write_text(text)
    return path


def test_the_example_has_the_planted_finding_and_no_other(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["audit", str(TWO_LINK), "--json", "-"]) == 1
    out, err = capsys.readouterr()
    data = json.loads(out)
    assert err == ""
    (finding,) = [finding for component in data["components"] for finding in component["findings"]]
    assert (finding["id"], finding["kind"], finding["dimension_ok"]) == ("tau1.1", "coefficient", True)
    assert MISPRINT.split()[-1] in finding["printed"] and finding["derived"].startswith("- 2 ")


def test_the_example_mended_is_all_right(clean: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["audit", str(clean)]) == 0
    out = capsys.readouterr().out
    assert "ALL RIGHT 2 match; 0 findings" in out and "--equation" not in out


def test_json_has_the_keys_that_were_promised(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["audit", "--equation", "22", "--equation", "(9)", "--json", "-"]) == 1
    data = json.loads(capsys.readouterr().out)
    components = {component["quantity"]: component for component in data["components"]}
    assert list(components) == ["vC1x", "vC1y", "vC1z", "F5z"]
    wrong = components["F5z"]
    assert {"equation", "quantity", "printed_terms", "derived_terms", "verdict", "findings"} <= set(wrong)
    assert (wrong["equation"], wrong["printed_terms"], wrong["derived_terms"]) == (22, 25, 25)
    assert wrong["verdict"] == "differs" and components["vC1x"]["verdict"] == "match"
    assert all({"id", "kind", "printed", "derived", "dimension_ok"} <= set(finding) for finding in wrong["findings"])
    assert [finding["id"] for finding in wrong["findings"]] == [f"F5z.{k + 1}" for k in range(len(wrong["findings"]))]
    totals = data["totals"]
    assert totals["match"] + totals["differs"] + totals["unparsed"] == totals["components"] == len(components)
    assert sum(totals["kinds"].values()) == totals["findings"] == len(wrong["findings"])


def test_files_are_written_beside_the_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    names = {"--json": "a.json", "--latex": "a.tex", "--html": "a.html", "--markdown": "a.md"}
    words = [word for option, name in names.items() for word in (option, str(folder / name))]
    assert main(["audit", str(TWO_LINK), *words]) == 1
    assert "(tau_1)" in capsys.readouterr().out
    assert sorted(path.name for path in folder.iterdir()) == sorted(names.values())
    assert json.loads((folder / "a.json").read_text())["totals"]["findings"] == 1
    for name in ("a.tex", "a.html", "a.md"):
        assert "tau1.1" in (folder / name).read_text()


@pytest.mark.parametrize(("option", "begins"), [("--latex", "\\documentclass"), ("--html", "<!doctype html>"), ("--markdown", "# Errata")])  # fmt: skip
def test_a_sheet_on_stdout_is_all_there_is(option: str, begins: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["audit", str(TWO_LINK), option, "-"]) == 1
    out, err = capsys.readouterr()
    assert out.startswith(begins) and err == ""
    assert "errata sheet:" not in out


def test_quiet_prints_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["audit", str(TWO_LINK), "--quiet"]) == 1
    assert capsys.readouterr() == ("", "")


def test_the_same_seed_gives_the_same_bytes_and_another_another_state(capsys: pytest.CaptureFixture[str]) -> None:
    texts = []
    for seed in ("4", "4", "5"):
        main(["audit", str(TWO_LINK), "--seed", seed, "--json", "-"])
        texts.append(capsys.readouterr().out)
    assert texts[0] == texts[1]
    values = [[c["evidence"]["pinocchio"] for c in json.loads(text)["components"]] for text in texts]
    assert values[0] != values[2]


def test_one_equation_in_full(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["audit", str(TWO_LINK), "--equation", "tau_1"]) == 1
    out = capsys.readouterr().out
    assert "tau1.1" in out and "Pinocchio gives" in out and "corrected" in out and "tau_2" not in out
    assert main(["audit", str(TWO_LINK), "--equation", "tau_2"]) == 0


def test_a_definition_has_nothing_to_compare(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["audit", "--equation", "3"]) == 0
    assert "(3) only" in capsys.readouterr().out


def test_undeclared_symbols_alone_are_unusable_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = changed(tmp_path, (MISPRINT, MENDED), (r"\tau_2 = m_2", r"\tau_2 = w_2"))
    assert main(["audit", str(path)]) == 2
    assert "w_2" in capsys.readouterr().out


def test_what_cannot_be_read_is_unparsed_and_the_rest_is_judged(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = changed(tmp_path, (MISPRINT, MENDED), (r"\tau_2 = m_2", r"\tau_2 = \frac )( m_2"))
    assert main(["audit", str(path), "--json", "-"]) == 1
    data = json.loads(capsys.readouterr().out)
    assert [component["verdict"] for component in data["components"]] == ["match", "unparsed"]
    assert data["components"][1]["unparsed"] and data["components"][1]["evidence"] is None
    assert main(["audit", str(path)]) == 1
    out = capsys.readouterr().out
    assert f"in full: rttrr-pin audit {path} --equation tau_2" in out
    assert "not read" in out and "1 match, 1 not read; 0 findings" in out
    assert main(["audit", str(path), "--html", "-"]) == 1
    assert "Not read" in capsys.readouterr().out


WRONG = {
    "toml": ("[robot]", "[robot", "is no TOML"),
    "key": ("title =", "titel =", "did you mean title?"),
    "quantity": ('quantity = "tau"', 'quantity = "torque"', "expected vC, F, N, f, n, tau, g, a, M, C or definition"),
    "number": ('number = "tau_1"', "number = 6.10", 'a text such as "6.10"'),
    "joint": ("joint = 2", "joint = 3", "expected 1 to 2"),
    "joint is no number": ("joint = 1", "joint = true", "expected 1 to 2"),
    "twice": ('name = "g"\n', 'name = "m_1"\n', "'m_1' is declared twice"),
    "spelling twice": ("latex = 'g'", "latex = 'l_1'", "spell them differently"),
    "spelling twice in other braces": ("latex = 'g'", "latex = 'l_{1}'", "the same symbol is l_1 already"),
    "spelling of no symbol": ("latex = 'g'", "latex = 'g +'", "is no spelling of a symbol"),
    "spelling without a number": (r"position = '\theta_<k>'", r"position = '\theta'", "or one for each"),
    "name of a sine": ('name = "g"', 'name = "s_1"', "stands for a coordinate"),
    "dimension": ('com = ["l_2"', 'com = ["m_2"', "com has m_2, which measures kg: expected m"),
    "mass": ("[[link]]", "[values]\nm_1 = -1\n[[link]]", "mass is -1.0"),
    "value": ("[[link]]", "[values]\nm_1 = nan\n[[link]]", "expected a finite number"),
    "angles": ('mass = "m_1"', 'mass = "m_1"\nrpy_degrees = ["a", 0, 0]', "expected a number of degrees"),
    "links": ('name = "link_2"', 'name = "link_1"', "give each its own"),
    "payload": ("[coordinates]", '[payload]\nlink = "hand"\n[coordinates]', "expected one of link_1, link_2"),
}


@pytest.mark.parametrize(("old", "new", "told"), WRONG.values(), ids=WRONG)
def test_a_file_that_cannot_be_used_is_told_with_its_name(
    old: str, new: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["audit", str(changed(tmp_path, (old, new)))]) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.startswith("error: equations.toml: ") and told in err


UNUSABLE = {
    "missing": (["nope.toml"], "nope.toml: cannot be read: No such file"),
    "folder": (["."], "Is a directory"),
    "no table": (["list.yaml"], "holds no table"),
    "binary": (["binary.toml"], "is not UTF-8"),
    "no such equation": (["--equation", "99"], "there is no equation (99): there are 1 to 43"),
    "no such equation in a file": ([str(TWO_LINK), "--equation", "1"], "there are tau_1, tau_2"),
    "two on stdout": (["--json", "-", "--html", "-"], "--json and --html both go to stdout"),
    "two in one file": (["--latex", "x", "--html", "./x"], "--latex and --html both go to ./x"),
    "no such folder": ([str(TWO_LINK), "--html", "a/b/c.html"], "cannot be written"),
    "seed": (["--seed", "-1"], "--seed"),
}


@pytest.mark.parametrize(("words", "told"), UNUSABLE.values(), ids=UNUSABLE)
def test_unusable_input_ends_with_2_and_a_reason(
    words: list[str], told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "list.yaml").write_text("- 1\n")
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe")
    before = sorted(tmp_path.iterdir())
    monkeypatch.chdir(tmp_path)
    assert main(["audit", *words]) == 2
    out, err = capsys.readouterr()
    assert out == "" and told in err and "Traceback" not in err
    assert sorted(tmp_path.iterdir()) == before


def test_every_key_of_the_example_is_told_in_the_docs() -> None:
    import tomllib

    from rttrr_pin.auditing.file import EQUATION_KEYS, FILE_KEYS
    from rttrr_pin.derivation.symbol_file import LINK_KEYS
    from rttrr_pin.derivation.templates import KEYS

    text = (TWO_LINK.parents[1] / "docs/audit.md").read_text()
    for key in (*FILE_KEYS, *LINK_KEYS, *EQUATION_KEYS, *KEYS, *tomllib.loads(TWO_LINK.read_text())):
        assert any(shown in text for shown in (f"`{key}", f"[{key}]", f" {key} = [")), key


@pytest.mark.parametrize(("latex", "spelling"), [(True, "m_{10}"), (False, "m_10")])
def test_letters_of_a_tenth_link_are_spelled_in_their_language(latex: bool, spelling: str) -> None:
    from rttrr_pin.derivation.tables import Table
    from rttrr_pin.derivation.templates import declarations

    entry = Table("equations.toml", "[[symbol]] 1", {"name": "m_<i>", "dimension": "mass", "i": [10]})
    (letter,) = declarations(entry, 10, latex)
    assert (letter.symbol.name, letter.spellings) == ("m_10", (spelling,))
