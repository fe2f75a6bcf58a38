"""The suite has teeth: slips that others shipped, put into the specification, turn it red.

Each slip is made in a copy of the source, and the tests that read the copy are run as a user would run them.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

SLIPS: dict[str, list[tuple[str, str]]] = {
    # In Robotics Toolbox's readable recursion, unnoticed because no test named it (see docs/references.md).
    "p x f and r x F exchanged": [
        ("body.r_C.cross(F)", "joint.p.cross(F)"),
        ("joint.p.cross(R_f)", "body.r_C.cross(R_f)"),
    ],
    "R for R^T": [("carried = R.T @ w_p", "carried = R @ w_p")],
    "gyroscopic term dropped": [(" + w.cross(body.I @ w)", "")],
    "Coriolis factor 2 dropped": [("carried.cross(joint.v) * 2", "carried.cross(joint.v)")],
    "w x v of a twist dropped": [("        + joint.w.cross(joint.v)  # of joints that turn and slide at once\n", "")],
    "branches lose their moment arm": [("joint.R @ n + joint.p.cross(R_f)", "joint.R @ n")],
}

TESTS = ["test_newton_euler.py", "test_paper.py", "test_published_torques.py"]


@pytest.fixture
def copy(repository: Path, tmp_path: Path) -> Path:
    shutil.copytree(repository / "src", tmp_path / "src")
    shutil.copytree(repository / "urdf", tmp_path / "urdf")
    return tmp_path


def run_suite(repository: Path, copy: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--no-header", *words],
        cwd=repository / "tests",
        env=os.environ | {"PYTHONPATH": str(copy / "src"), "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )


def mutate(copy: Path, slip: str) -> None:
    path = copy / "src" / "rttrr_pin" / "newton_euler.py"
    text = path.read_text()
    for old, new in SLIPS[slip]:
        assert text.count(old) == 1, f"{old!r} must stand once in newton_euler.py: bring the slip up to date"
        text = text.replace(old, new)
    path.write_text(text)


@pytest.mark.parametrize("test", TESTS)
@pytest.mark.parametrize("slip", list(SLIPS)[:2])
def test_a_deliberate_slip_turns_the_suite_red(repository: Path, copy: Path, slip: str, test: str) -> None:
    """Where the module can see it: the paper prints no moments n, so the exchange is seen by the other two."""
    mutate(copy, slip)
    done = run_suite(repository, copy, "-x", test)
    blind = slip.startswith("p x f") and test == "test_paper.py"
    assert done.returncode == (0 if blind else 1), done.stdout[-2000:]
    assert blind or "1 failed" in done.stdout


@pytest.mark.parametrize("slip", list(SLIPS)[2:])
def test_a_dropped_term_turns_the_suite_red(repository: Path, copy: Path, slip: str) -> None:
    mutate(copy, slip)
    done = run_suite(repository, copy, "-x", "test_newton_euler.py", "test_joints.py")
    assert done.returncode == 1, done.stdout[-2000:]


def test_the_copy_without_a_slip_is_green(repository: Path, copy: Path) -> None:
    """Else the reds above would prove nothing."""
    done = run_suite(repository, copy, "-x", "test_published_torques.py", "test_newton_euler.py")
    assert done.returncode == 0, done.stdout[-2000:]
    where = f"import rttrr_pin; assert {str(copy)!r} in rttrr_pin.__file__"
    environment = os.environ | {"PYTHONPATH": str(copy / "src")}
    subprocess.run([sys.executable, "-c", where], env=environment, check=True)
