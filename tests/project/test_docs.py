"""What the documents say is true: commands, outputs, tables, equation numbers, links, examples."""

from __future__ import annotations

import inspect
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

import rttrr_pin
from rttrr_pin.cli import main
from rttrr_pin.core import newton_euler

ROOT = Path(__file__).parents[2]
PAGES = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md"), *(ROOT / "urdf").glob("*.md")]

LAST_EQUATION = 43
"""The paper's equations are numbered (1) to (43)."""

NUMBER = re.compile(r"\d+(\.\d+)?(e[-+]\d+)?")


def fenced(text: str, marker: str) -> str:
    """The fenced block that follows a marker."""
    found = re.search(rf"<!-- {re.escape(marker)} -->\n```\w+\n(.*?)```", text, re.DOTALL)
    assert found, marker
    return found.group(1)


def without_numbers(text: str) -> list[str]:
    """Lines with digits, and the spaces and rules that depend on their width, left out."""
    lines = [re.sub(r"[\s━─]+", " ", NUMBER.sub("#", line)).strip() for line in text.splitlines()]
    lines = [re.sub(r"(# eps) \(.*?\)", r"\1 (...)", line) for line in lines]
    return [re.sub(r"^worst state # \(.*?\)", "worst state # (...)", line) for line in lines]


def test_the_shown_output_is_what_validate_prints(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """But for the last digits of sines, the time and the versions."""
    monkeypatch.setattr(sys, "argv", ["rttrr-pin", "validate"])
    monkeypatch.setenv("COLUMNS", "80")
    assert main() == 0
    shown = fenced((ROOT / "README.md").read_text(), "output: rttrr-pin validate")
    assert without_numbers(shown) == without_numbers(capsys.readouterr().out)
    assert shown.count("PASS") == 30


def test_the_tables_come_from_the_results() -> None:
    done = subprocess.run([sys.executable, ROOT / "benchmarks/readme_tables.py", "--check"], check=False)
    assert done.returncode == 0


def test_the_saved_agreement_holds_what_the_issue_asks() -> None:
    result = json.loads((ROOT / "benchmarks/results/agreement.json").read_text())
    assert result["states"] == 1_000_000
    assert result["verdict"] == "agree"
    assert set(result["worst"]) == {"tau", "F", "N", "f", "n"}
    assert max(figure["worst_eps"] for figure in result["worst"].values()) <= result["claim_eps"]


def test_every_equation_number_cited_exists() -> None:
    """And the recursion cites each group that it yields."""
    source = inspect.getsource(newton_euler)
    cited = [int(n) for pair in re.findall(r"\((\d+)\)(?:-\((\d+)\))?", source) for n in pair if n]
    assert cited
    assert all(1 <= n <= LAST_EQUATION for n in cited)
    for needed in ("(9)-(15)", "(16)-(22)", "(23)-(30)", "(31)-(43)", "(8)", "(40)"):
        assert needed in source


def test_the_specification_is_short_and_has_two_loops() -> None:
    assert len(inspect.getsource(newton_euler).splitlines()) <= 200
    body = inspect.getsource(newton_euler.newton_euler)
    assert len(re.findall(r"^    for (?!payload)", body, re.MULTILINE)) == 2


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name if isinstance(page, Path) else "")
def test_relative_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text()):
        assert (page.parent / target).exists(), f"{page.name}: {target}"


@pytest.mark.parametrize("example", sorted((ROOT / "examples").glob("*.py")), ids=lambda path: path.stem)
def test_examples_run_and_are_short(example: Path, tmp_path: Path) -> None:
    assert len(example.read_text().splitlines()) < 60
    done = subprocess.run(
        [sys.executable, example], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("\n") > 2


def test_the_message_in_the_readme_is_the_one_printed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    lines = [
        '<robot name="x">',
        '<link name="base"/>',
        '<link name="arm">',
        "<inertial>",
        '<origin xyz="0 0 0"/>',
        '<mass value="1,5"/>',
    ]
    Path("my_arm.urdf").write_text(
        "\n".join(lines) + '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></robot>'
    )
    assert main(["validate", "my_arm.urdf"]) == 2
    assert capsys.readouterr().err in (ROOT / "README.md").read_text()


def test_the_version_is_in_the_changelog() -> None:
    assert f"## {rttrr_pin.__version__}" in (ROOT / "CHANGELOG.md").read_text()


@pytest.mark.parametrize("name", ["load", "Robot", "Wrench", "LinkWrenches"])
def test_public_docstrings_give_units(name: str) -> None:
    thing = getattr(rttrr_pin, name)
    text = inspect.getdoc(thing) or ""
    members = "" if inspect.isfunction(thing) else inspect.getdoc(getattr(thing, "inverse_dynamics", thing)) or ""
    assert "[" in text + members


def test_the_saved_laws_hold_on_as_many_trees_as_the_issue_asks() -> None:
    result = json.loads((ROOT / "benchmarks/results/laws.json").read_text())
    assert (result["trees"], result["states_per_tree"]) == (1000, 1000)
    assert result["violations"] == []
    assert all(law["violations"] == 0 and law["worst_share_of_bound"] <= 1.0 for law in result["laws"].values())
