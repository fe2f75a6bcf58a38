"""States for a diagnosis: what each kind shows, limits, round numbers, seeds; and the file that `sample` writes."""

from __future__ import annotations

import json
import shlex
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import RandomPayload, Robot, validate
from rttrr_pin.cli import main
from rttrr_pin.diagnosis.states import FIRST, PARTS, ROUND, Sample, sample_states
from rttrr_pin.errors import InputError
from rttrr_pin.implementations.program import Program
from rttrr_pin.implementations.table import Table
from rttrr_pin.implementations.text_results import column_names
from rttrr_pin.validation.sampling import Ranges
from support.pendulum import URDF, pendulum, program
from support.trees import random_tree

BRANCHED = """<robot name="y"><link name="base"/>
<link name="trunk"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<link name="left"/><link name="right"/>
<joint name="a" type="revolute"><parent link="base"/><child link="trunk"/><axis xyz="0 0 1"/>
<limit lower="-3.07" upper="-0.07" velocity="0.3" effort="1"/></joint>
<joint name="b" type="prismatic"><parent link="trunk"/><child link="left"/><axis xyz="0 0 1"/>
<limit lower="0" upper="0.04" velocity="2" effort="1"/></joint>
<joint name="c" type="continuous"><parent link="trunk"/><child link="right"/><axis xyz="1 0 0"/></joint></robot>"""


def rows(sample: Sample, kind: str) -> list[int]:
    return [k for k, own in enumerate(sample.kinds) if own == kind]


def loaded_rows(sample: Sample) -> np.ndarray:
    """Whether each state has a payload."""
    wrenches = [np.hstack([load.f, load.n]) for load in sample.states.loads]
    return np.any(np.hstack([np.zeros((len(sample), 1)), *wrenches]), axis=1)


@pytest.mark.parametrize("base", ["fixed", "floating"])
@pytest.mark.parametrize("source", ["rttrr", BRANCHED, URDF], ids=["arm", "branched", "pendulum"])
def test_each_kind_shows_what_it_is_called_for(source: str, base: Any) -> None:
    sample = sample_states(rttrr_pin.load(source, base=base))
    v, a = (np.count_nonzero(x, axis=1) for x in (sample.states.v, sample.states.a))
    assert len(sample) == 500 and {*sample.kinds} <= {*PARTS}
    for kind, of_v, of_a in (("gravity", 0, 0), ("one rate", 1, 0), ("one acceleration", 0, 1), ("two rates", 2, 0)):
        here = rows(sample, kind)
        assert {*v[here]} <= {of_v} and {*a[here]} <= {of_a}
    with_payload = loaded_rows(sample)
    assert {k for k in range(500) if with_payload[k]} == {*rows(sample, "payload")}
    assert (v[rows(sample, "random")] == sample.states.model.nv).all()


def test_each_joint_and_each_pair_runs() -> None:
    sample = sample_states(rttrr_pin.load("rttrr", base="floating"))
    running = sample.states.v != 0
    singles = {int(np.flatnonzero(running[k])[0]) for k in rows(sample, "one rate")}
    pairs = {tuple(np.flatnonzero(running[k]).tolist()) for k in rows(sample, "two rates")}
    assert singles == {*range(11)} and len(pairs) == 55


@pytest.mark.parametrize("source", ["rttrr", "trttr", BRANCHED])
def test_states_are_within_the_limits_of_the_file(source: str) -> None:
    robot = rttrr_pin.load(source)
    ranges, sample = Ranges.of(robot.model), sample_states(robot, 1000)
    assert (sample.states.q >= ranges.lower).all() and (sample.states.q <= ranges.upper).all()
    assert (np.abs(sample.states.v) <= ranges.rate).all()


@pytest.mark.parametrize("kind", PARTS)
def test_the_first_states_of_each_kind_are_round(kind: str) -> None:
    """As many as there are joints, at least three; of few digits where the limits leave out the round numbers."""
    for source in ("rttrr", BRANCHED):
        sample = sample_states(rttrr_pin.load(source))
        first = rows(sample, kind)[:3]
        wrenches = [x[first] for load in sample.states.loads for x in (load.f, load.n)]
        for x in (sample.states.q[first], sample.states.v[first], sample.states.a[first], *wrenches):
            assert all(float(f"{number:.1g}") == number for number in x.ravel().tolist())
    free = sample_states(pendulum())
    x = (
        np.hstack([x[rows(free, kind)[:1]] for x in (free.states.q, free.states.v, free.states.a)])
        if kind in free.kinds
        else 0
    )
    assert np.isin(x, [0, *ROUND]).all()


def test_gravity_alone_is_seen_at_zero_and_elsewhere() -> None:
    sample = sample_states(rttrr_pin.load("rttrr"))
    assert not sample.states.q[0].any()
    assert len({tuple(row) for row in sample.states.q[rows(sample, "gravity")].tolist()}) == 80


@pytest.mark.parametrize("n", [1, 2, 5, 6, 7, 13, 100])
@pytest.mark.parametrize("source", ["rttrr", "pendulum"])
def test_so_many_states_as_are_asked_for_of_as_many_kinds_as_can_be(n: int, source: str) -> None:
    robot = rttrr_pin.load("rttrr") if source == "rttrr" else pendulum()
    possible = [kind for kind in FIRST if source == "rttrr" or kind != "two rates"]
    sample = sample_states(robot, n)
    assert len(sample) == n == len(sample.states.q)
    assert {*sample.kinds} == {*possible[:n]}


def test_the_seed_decides() -> None:
    robot = rttrr_pin.load("rttrr")
    first, again, other = (sample_states(robot, 50, seed) for seed in (3, 3, 4))
    assert np.array_equal(first.states.q, again.states.q) and np.array_equal(
        first.states.loads[0].n, again.states.loads[0].n
    )
    assert not np.array_equal(first.states.q, other.states.q)


def test_payloads_are_at_each_last_link_or_at_one_or_at_none() -> None:
    robot = rttrr_pin.load(BRANCHED)
    names = lambda sample: [robot.link_names[load.link] for load in sample.states.loads]
    assert names(sample_states(robot)) == ["left", "right"]
    assert not any(np.logical_and(*(load.f.any(axis=1) for load in sample_states(robot).states.loads)))
    assert names(sample_states(robot, payload=RandomPayload("trunk"))) == ["trunk"]
    small = sample_states(robot, payload=RandomPayload(force=2.0, moment=0.5))
    assert max(np.abs(load.f).max() for load in small.states.loads) <= 2.0
    none = sample_states(robot, payload=None)
    assert none.states.loads == () and "payload" not in none.kinds and len(none) == 500


def test_of_wrong_arguments_is_said_what() -> None:
    with pytest.raises(InputError, match="there is nothing to sample"):
        sample_states(rttrr_pin.load('<robot name="x"><link name="a"/></robot>'))
    with pytest.raises(InputError, match="expected None or a RandomPayload"):
        sample_states(pendulum(), payload="none")  # type: ignore[arg-type]


@pytest.mark.one_in(4)
@pytest.mark.parametrize("seed", range(4))
def test_any_tree_can_be_asked_at_its_states(seed: int) -> None:
    robot = rttrr_pin.load(random_tree(seed, 6), base="floating" if seed % 2 else "fixed")
    sample = sample_states(robot, 60, seed)
    assert len(sample) == 60
    robot.inverse_dynamics(sample.states.q, sample.states.v, sample.states.a, list(sample.states.loads))


# The file


def with_results(path: Path, robot: Robot, error: float = 0.0) -> Path:
    """The table with a column of results for each joint, as a user adds them."""
    header, *lines = path.read_text().splitlines()
    sample = sample_states(robot, len(lines))
    tau = robot.inverse_dynamics(sample.states.q, sample.states.v, sample.states.a, list(sample.states.loads)).tau
    names = ",".join(column_names(robot.model)["tau"])
    cells = [",".join(f"{x:.17g}" for x in row) for row in (tau + error).tolist()]
    path.write_text("\n".join([f"{header},{names}", *(f"{a},{b}" for a, b in zip(lines, cells, strict=True))]))
    return path


@pytest.mark.one_in(2)
@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_results_that_are_added_to_the_table_are_judged(
    base: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """All digits are there, and `kind` is passed over."""
    robot, path = rttrr_pin.load("rttrr", base=base), tmp_path / "states.csv"
    assert main(["sample", "-n", "40", "-o", str(path), "--base", base]) == 0
    assert validate(robot, with_results(path, robot), "recursion").passed
    states = Table(path, robot.model).states()
    again = sample_states(robot, 40)
    assert np.array_equal(states.q, again.states.q) and np.array_equal(states.loads[0].f, again.states.loads[0].f)
    assert path.read_text().splitlines()[1].count("gravity") == 1
    assert main(["sample", "-n", "40", "-o", str(path), "--base", base, "--force", "-q"]) == 0
    assert not validate(robot, with_results(path, robot, 1e-9), "recursion").passed


def test_json_lines_are_requests(tmp_path: Path) -> None:
    path = tmp_path / "states.jsonl"
    assert main(["sample", "-n", "20", "-o", str(path), "-q"]) == 0
    model = rttrr_pin.load("rttrr").model
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    sample = sample_states(rttrr_pin.load("rttrr"), 20)
    assert [line["q"] for line in lines] == sample.states.q.tolist()
    assert [line["payload"][0]["n"] for line in lines] == sample.states.loads[0].n.tolist()
    path.write_text("\n".join(json.dumps(line | {"tau": [0] * 5}) for line in lines))
    assert np.array_equal(Table(path, model).states().loads[0].n, sample.states.loads[0].n)


def test_a_program_reads_them(tmp_path: Path) -> None:
    sample = sample_states(pendulum(), 30, payload=None)
    asked = Program(program(tmp_path, 'print(json.dumps({"tau": [tau]}), flush=True)'), pendulum().model)
    own = asked.evaluate(sample.states).values["tau"]
    np.testing.assert_allclose(own, pendulum().inverse_dynamics(sample.states.q, sample.states.v, sample.states.a).tau)


def test_parquet_has_the_same_columns(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = ModuleType("pyarrow")
    package.table = dict  # type: ignore[attr-defined]
    package.parquet = SimpleNamespace(  # type: ignore[attr-defined]
        write_table=lambda columns, sink: sink.write(",".join(columns).encode())
    )
    monkeypatch.setitem(sys.modules, "pyarrow", package)
    assert main(["sample", "-n", "8", "-o", str(tmp_path / "x.parquet"), "-q"]) == 0
    assert main(["sample", "-n", "8", "-o", str(tmp_path / "x.csv"), "-q"]) == 0
    assert (tmp_path / "x.parquet").read_text() == (tmp_path / "x.csv").read_text().splitlines()[0]
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    assert main(["sample", "-n", "8", "-o", str(tmp_path / "y.parquet"), "-q"]) == 2
    assert not (tmp_path / "y.parquet").exists()


def test_the_next_command_has_the_options_that_are_no_states(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my arm.urdf").write_text(URDF)
    options = ["--gravity", "0,0,-1.62", "--base", "floating", "--friction"]
    assert main(["sample", "my arm.urdf", "-o", "s.csv", "-n", "9", "--seed", "5", *options]) == 0
    last = capsys.readouterr().out.splitlines()[-1]
    assert shlex.split(last.partition("then: ")[2]) == ["rttrr-pin", "diagnose", "my arm.urdf", "s.csv", *options]


def test_results_that_somebody_added_are_not_overwritten(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "states.csv"
    path.write_text("mine")
    assert main(["sample", "-n", "5", "-o", str(path)]) == 2
    assert "add --force" in capsys.readouterr().err and path.read_text() == "mine"
    assert main(["sample", "-n", "5", "-o", str(path), "--force"]) == 0
    assert path.read_text() != "mine"


def test_stdout_gets_the_table_and_nothing_else(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sample", "-n", "7"]) == 0
    out, err = capsys.readouterr()
    assert len(out.splitlines()) == 8 and err == ""
