"""What the documents say is true: commands, outputs, tables, equation numbers, links, examples.

A marker before a fenced block says how it came about, on any page:
`<!-- run: NAME -->` a command that `.ci/run` runs; `<!-- run: python -->` Python that runs as it stands;
`<!-- output: rttrr-pin ... -->` what that command prints, `<!-- output: python -->` what the page's Python prints, each
but for digits, and with `...` on a line of its own for lines left out. Tables: benchmarks/tables.py.
"""

from __future__ import annotations

import ast
import inspect
import json
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import rttrr_pin
from rttrr_pin.cli import main
from rttrr_pin.core import newton_euler
from rttrr_pin.urdf.catalogue import bundled

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"
PAGES = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "urdf").glob("*.md")]

BLOCK = re.compile(r"<!-- (run|output): ([^\n]+?) -->\n```\w*\n(.*?)```", re.DOTALL)

LAST_EQUATION = 43
"""The paper's equations are numbered (1) to (43)."""

NUMBER = re.compile(r"\d+(\.\d+)?(e[-+]\d+)?")


def blocks(page: Path, kind: str) -> list[tuple[str, str]]:
    """The marked blocks of a page: what made each, and its text."""
    return [(source, text) for what, source, text in BLOCK.findall(page.read_text()) if what == kind]


OUTPUTS = [(page, command, shown) for page in PAGES for command, shown in blocks(page, "output") if command != "python"]
PROGRAMS = [page for page in PAGES if page == README or ("python" in dict(blocks(page, "run")))]


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The files that the documents call the reader's own: the bundled arm, one with a comma in a mass, one that differs; and the results
    of other programs on small robots.
    """
    text = bundled()["rttrr"].read_text()
    (tmp_path / "my_arm.urdf").write_text(text)
    (tmp_path / "bad_arm.urdf").write_text(re.sub(r'<mass value="(\d+)\.', r'<mass value="\1,', text, count=1))
    other = text.replace('value="3.75387"', 'value="3.9"').replace('ixy="-5.97049e-05"', 'ixy="5.97049e-05"')
    other = other.replace('upper="0.32"', 'upper="0.3"').replace("joint_5", "wrist")
    (tmp_path / "other_arm.urdf").write_text(other)
    shutil.copytree(ROOT / "tests/data/torques_differ", tmp_path, dirs_exist_ok=True)
    shutil.copy(ROOT / "examples/my_dynamics.py", tmp_path)
    monkeypatch.delitem(sys.modules, "my_dynamics", raising=False)  # of another test
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    return tmp_path


def without_numbers(text: str) -> list[str]:
    """Lines with digits, and the spaces and rules that depend on their width, left out."""
    lines = [re.sub(r"[\s━─]+", " ", NUMBER.sub("#", line)).strip() for line in text.splitlines()]
    lines = [re.sub(r"(# eps) \(.*?\)", r"\1 (...)", line) for line in lines]
    return [re.sub(r"^worst state # \(.*?\)", "worst state # (...)", line) for line in lines]


def assert_shown(shown: str, printed: str) -> None:
    """What a document shows was printed, in this order, but for digits and for lines that it leaves out."""
    lines, at = without_numbers(printed), 0
    for k, part in enumerate(re.split(r"^\.\.\.\n", shown, flags=re.MULTILINE)):
        wanted = without_numbers(part)
        places = [i for i in range(at, len(lines) + 1 - len(wanted)) if lines[i : i + len(wanted)] == wanted]
        assert places if k else places[:1] == [0], f"not printed:\n{part}\nprinted:\n{printed}"
        at = places[0] + len(wanted)
    assert at == len(lines) or shown.endswith("...\n"), f"printed too:\n{printed}"


@pytest.mark.parametrize(("page", "command", "shown"), OUTPUTS, ids=[f"{p.name}: {c}" for p, c, _ in OUTPUTS])
def test_a_shown_output_is_what_the_command_prints(
    page: Path, command: str, shown: str, desk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """But for the last digits of sines, the time and the versions."""
    program, *words = shlex.split(command)
    assert program == "rttrr-pin"
    main(words)
    printed = capsys.readouterr()
    assert_shown(shown, printed.err + printed.out)


@pytest.mark.one_in(4)
@pytest.mark.parametrize("page", PROGRAMS, ids=lambda page: page.name)
def test_python_of_the_documents_runs(page: Path, desk: Path) -> None:
    """The marked blocks of a page, one after the other, in one process."""
    code = "\n".join(text for source, text in blocks(page, "run") if source == "python")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    shown = [text for source, text in blocks(page, "output") if source == "python"]
    if shown:
        assert_shown("".join(shown), done.stdout)


def test_the_readme_has_the_commands_that_ci_runs() -> None:
    assert {"main job", "tests"} <= {source for source, _ in blocks(README, "run")}


def test_the_readme_is_short() -> None:
    text = re.sub(r"<!--.*?-->", "", README.read_text(), flags=re.DOTALL)
    assert len(README.read_text().splitlines()) <= 130
    assert len(re.findall(r"\S*\w\S*", text)) <= 700


def test_tables_come_from_the_results() -> None:
    done = subprocess.run(
        [sys.executable, ROOT / "benchmarks/tables.py", "--check"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def saved(name: str) -> dict:  # type: ignore[type-arg]
    return json.loads((ROOT / f"benchmarks/results/{name}.json").read_text())


def test_the_saved_agreement_holds_what_is_claimed() -> None:
    result = saved("agreement")
    assert (result["states"], result["verdict"]) == (1_000_000, "agree")
    assert set(result["worst"]) == {"tau", "F", "N", "f", "n"}
    assert max(figure["worst_eps"] for figure in result["worst"].values()) <= result["claim_eps"]


def test_the_saved_laws_hold_on_a_thousand_trees() -> None:
    result = saved("laws")
    assert (result["trees"], result["states_per_tree"]) == (1000, 1000)
    assert result["violations"] == []
    assert all(law["violations"] == 0 and law["worst_error_over_bound"] <= 1.0 for law in result["laws"].values())


def test_every_equation_number_cited_exists() -> None:
    """And every line of the recursion that the paper has cites its number."""
    source = inspect.getsource(newton_euler)
    cited = [int(n) for pair in re.findall(r"\((\d+)\)(?:-\((\d+)\))?", source) for n in pair if n]
    assert cited and all(1 <= n <= LAST_EQUATION for n in cited)
    lines, citing = source.splitlines(), set()
    for step in (newton_euler.outwards, newton_euler.inwards):
        tree = next(x for x in ast.parse(source).body if isinstance(x, ast.FunctionDef) and x.name == step.__name__)
        for assignment in (x for x in tree.body if isinstance(x, ast.Assign)):
            if re.search(r"#.*\(\d+\)", lines[(assignment.end_lineno or 0) - 1]):
                citing |= {name.id for name in assignment.targets if isinstance(name, ast.Name)}
    assert citing >= {"v_dot_C", "F", "N", "f", "n", "tau"}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_inside_the_repository_lead_somewhere(page: Path) -> None:
    for target, anchor in re.findall(r"\]\(([^)#:\s]*)(?:#([^)\s]*))?\)", page.read_text()):
        aim = page.parent / target if target else page
        assert aim.exists(), f"{page.name}: {target}"
        if anchor and aim.suffix == ".md":
            assert anchor in anchors(aim.read_text()), f"{page.name}: {target}#{anchor}"


def anchors(text: str) -> set[str]:
    """Of the headings of a page, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading).strip().lower().replace(" ", "-") for heading in headings}


@pytest.mark.one_in(2)
@pytest.mark.parametrize("example", sorted((ROOT / "examples").glob("*.py")), ids=lambda path: path.stem)
def test_examples_run_and_are_short(example: Path, tmp_path: Path) -> None:
    assert len(example.read_text().splitlines()) < 60
    done = subprocess.run([sys.executable, example], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("\n") > 2


def test_the_version_is_in_the_changelog() -> None:
    assert f"## {rttrr_pin.__version__}" in (ROOT / "CHANGELOG.md").read_text()


@pytest.mark.parametrize("name", ["load", "Robot", "Wrench", "LinkWrenches"])
def test_public_docstrings_give_units(name: str) -> None:
    thing = getattr(rttrr_pin, name)
    text = inspect.getdoc(thing) or ""
    members = "" if inspect.isfunction(thing) else inspect.getdoc(getattr(thing, "inverse_dynamics", thing)) or ""
    assert "[" in text + members


@pytest.mark.parametrize("script", ["docs/api.py", "docs/figures/link.py"])
def test_generated_pages_are_what_their_scripts_write(script: str) -> None:
    done = subprocess.run([sys.executable, ROOT / script, "--check"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"run python {script}\n{done.stderr}"
