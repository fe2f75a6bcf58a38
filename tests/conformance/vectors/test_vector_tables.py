"""Tables of vectors: programs in other languages read them, and one in 60 digits finds each true value inside."""

from __future__ import annotations

import math
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin.conformance import write_vectors
from rttrr_pin.conformance.vectors.vector_tables import steps, widths
from rttrr_pin.conformance.vectors.vectors import BUNDLED
from support.trees import random_tree

ROOT = Path(__file__).parents[3]
READERS = ROOT / "examples" / "vectors"


def run(*words: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(list(map(str, words)), capture_output=True, text=True, check=False, cwd=cwd)


def by_numpy(folder: Path) -> str:
    done = run(sys.executable, READERS / "read_vectors.py", folder)
    assert done.returncode == 0, done.stderr
    return done.stdout


def tool(*names: str) -> str:
    """The program that runs a language."""
    found = next(filter(None, map(shutil.which, names)), None)
    if found is None:
        pytest.fail(f"{names[0]} is not installed")
    return found


@pytest.mark.parametrize("robot", ["arm6", "mimic"])
def test_numpy_reads_them(robot: str) -> None:
    words = dict(word.split("=") for word in by_numpy(BUNDLED / robot).split())
    assert words["difference"] == "0"
    assert words["widest"] == "1"
    assert float(words["error"]) > 1.0


def test_cpp_reads_the_same(tmp_path: Path) -> None:
    program = tmp_path / "reader"
    built = run(tool("g++", "clang++"), "-std=c++17", "-Wall", "-o", program, READERS / "read_vectors.cpp")
    assert built.returncode == 0, built.stderr
    assert run(program, BUNDLED / "arm6").stdout == by_numpy(BUNDLED / "arm6")


@pytest.mark.readers
def test_rust_reads_the_same(tmp_path: Path) -> None:
    program = tmp_path / "reader"
    built = run(tool("rustc"), "-o", program, READERS / "read_vectors.rs", cwd=tmp_path)
    assert built.returncode == 0, built.stderr
    assert run(program, BUNDLED / "arm6").stdout == by_numpy(BUNDLED / "arm6")


@pytest.mark.readers
def test_julia_reads_the_same() -> None:
    assert run(tool("julia"), READERS / "read_vectors.jl", BUNDLED / "arm6").stdout == by_numpy(BUNDLED / "arm6")


@pytest.mark.readers
def test_octave_reads_the_same() -> None:
    call = f"read_vectors('{BUNDLED / 'mimic'}')"
    assert run(tool("octave-cli", "octave"), "--eval", call, cwd=READERS).stdout == by_numpy(BUNDLED / "mimic")


def test_a_program_in_sixty_digits_finds_each_true_value_inside(tmp_path: Path) -> None:
    """And outside where the ends of one enclosure are moved by three doubles."""
    folder = Path(shutil.copytree(BUNDLED, tmp_path / "copy"))
    script = ROOT / "benchmarks" / "vectors_check.py"
    done = run(sys.executable, script, "--folder", folder)
    assert done.returncode == 0, done.stderr
    assert '"outside": 0' in done.stdout
    table = folder / "arm6" / "truth.csv"
    rows = [row.split(",") for row in table.read_text().splitlines()]
    for column, name in enumerate(rows[0]):
        if name in ("hex_lower_tau_link_3_joint", "hex_upper_tau_link_3_joint"):
            x = float.fromhex(rows[2][column])
            rows[2][column] = (x + 3 * math.ulp(x)).hex()
    table.write_text("\n".join(map(",".join, rows)) + "\n")
    assert run(sys.executable, script, "--folder", folder).returncode == 1


@pytest.mark.slow
def test_a_program_in_sixty_digits_finds_those_of_any_tree(tmp_path: Path) -> None:
    types = ("revolute", "prismatic", "continuous", "planar", "fixed")
    robots = []
    for seed in range(4):
        text = random_tree(seed, 6, types).replace('<robot name="', f'<robot name="{seed}_', 1)
        robots.append(rttrr_pin.load(text, base="floating" if seed % 2 else "fixed", friction=True))
    write_vectors(tmp_path / "trees", robots, n_states=2)
    done = run(sys.executable, ROOT / "benchmarks" / "vectors_check.py", "--folder", tmp_path / "trees")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("x", [0.0, -0.0, 5e-324, 1.0, -1.0, 2.0**-1022, -3.5e300])
def test_steps_count_doubles(x: float) -> None:
    up = math.nextafter(x, math.inf)
    lower, upper = np.array([x, x, math.nextafter(x, -math.inf)]), np.array([x, up, up])
    assert steps(lower, upper).tolist() == [0, 1, 2]
    assert list(widths(lower, upper).values()) == [1, 1, 1, 0]


def test_ends_of_both_signs_are_far_apart() -> None:
    assert widths(np.array([-1.0, -1e300]), np.array([1.0, 1e300]))["more, near zero"] == 2
