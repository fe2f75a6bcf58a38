"""Tables of results: every format, few digits, and files that are damaged."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import RandomPayload, Wrench, validate
from rttrr_pin.errors import ImplementationError, InputError, RttrrError
from rttrr_pin.implementations import Batch
from rttrr_pin.implementations.table import Table
from rttrr_pin.implementations.text_results import column_names
from support.pendulum import moment, pendulum

HEADER = "q_pivot,v_pivot,a_pivot,tau_pivot\n"


def written(folder: Path, text: str, name: str = "results.csv") -> Path:
    path = folder / name
    path.write_text(text)
    return path


def swings(
    folder: Path, state: str = "%.17g", result: str = "%.17g", error: float = 0.0, rows: int = 200, separator: str = ","
) -> Path:
    """A table of the pendulum in some format, whose writer knew all digits."""
    q, v, a = np.random.default_rng(3).uniform(-3, 3, (3, rows))
    tau = moment(q, v, a) + error
    form = separator.join([state, state, state, result]) + "\n"
    text = "".join(form % row for row in zip(*(x.tolist() for x in (q, v, a, tau)), strict=True))
    return written(folder, HEADER.replace(",", separator) + text)


@pytest.mark.parametrize(
    ("state", "result", "digits", "error"),
    [
        ("%.17g", "%.17g", None, 1e-12),
        ("%r", "%r", None, 1e-12),
        ("%.17g", "%.6g", 6, 1e-3),
        ("%.17g", "%.4f", 6, 1e-3),
        ("%.6g", "%.6g", 6, 1e-3),
        ("%.6f", "%.6f", 8, 1e-4),
        ("%.9e", "%.9e", 10, 1e-7),
        ("%.3f", "%.3f", 5, 2e-2),
    ],
)
def test_tables_are_judged_at_their_digits(
    tmp_path: Path, state: str, result: str, digits: int | None, error: float
) -> None:
    """Right ones pass, and an error of some units in the last place is found."""
    right = validate(pendulum(), swings(tmp_path, state, result), "recursion")
    assert right.passed and right.n_states == 200
    assert Table(swings(tmp_path, state, result), pendulum().model).digits == digits
    assert bool(right.notes) == (digits is not None)
    assert not validate(pendulum(), swings(tmp_path, state, result, error), "recursion").passed


@pytest.mark.parametrize(("form", "told"), [("%.1f", True), ("%.3f", False), ("%.17g", False)])
def test_torques_without_a_digit_are_told(tmp_path: Path, form: str, told: bool) -> None:
    """The fourth joint of the arm takes some hundredths of 1 N m: at one decimal nothing of it is left, right or wrong."""
    robot = rttrr_pin.load("rttrr")
    q, v, a = (0.1 * x for x in np.random.default_rng(4).uniform(-1, 1, (3, 20, 5)))
    tau = robot.inverse_dynamics(q, v, a).tau
    names = column_names(robot.model)
    rows = [",".join(name for key in ("q", "v", "a", "tau") for name in names[key])]
    rows += [
        ",".join([*(f"{x!r}" for x in row[:15]), *(form % x for x in row[15:])])
        for row in np.hstack([q, v, a, tau]).tolist()
    ]
    table = Table(written(tmp_path, "\n".join(rows)), robot.model)
    assert ("tau of joint_4 is nowhere printed as more than 0.05: no more is judged" in table.notes) == told


def test_states_printed_to_few_digits_are_exact_where_results_have_all(tmp_path: Path) -> None:
    rows = "".join(f"{q},0,1,{moment(np.float64(q), 0, 1)!r}\n" for q in (0.5, 1.25, -2.0))  # type: ignore[arg-type]
    path = written(tmp_path, HEADER + rows.replace("np.float64(", "").replace(")", ""))
    assert validate(pendulum(), path, "recursion").passed
    assert Table(path, pendulum().model).digits is None


def test_round_numbers_of_a_state_are_exact_beside_others_of_all_digits(tmp_path: Path) -> None:
    """An acceleration of 1 beside coordinates of 17 digits and results of six is not one between 0.5 and 1.5."""
    states = [(0.123456789012345678, 1.0), (1.25, -1.0), (-2.000000000000001, 1.0)]
    for factor in (1.0, 1.3):
        tau = [float(moment(np.float64(q), 0, factor * a)) for q, a in states]
        rows = "".join(f"{q!r},0,{a:g},{x:.6g}\n" for (q, a), x in zip(states, tau, strict=True))
        assert validate(pendulum(), written(tmp_path, HEADER + rows), "recursion").passed == (factor == 1.0)


@pytest.mark.parametrize("separator", [",", ";", "\t", " , "])
def test_separators(tmp_path: Path, separator: str) -> None:
    assert validate(pendulum(), swings(tmp_path, separator=separator), "recursion").passed


def test_other_columns_rows_at_the_end_and_numpys_header(tmp_path: Path) -> None:
    text = '\ufeff# time,tau_pivot,a_pivot,v_pivot,"q_pivot"\n0.1,0.60,1,0,0\r\n0.2,1.20,2,0,0\n\n'
    assert validate(pendulum(), written(tmp_path, text), "recursion").n_states == 2


@pytest.mark.parametrize("form", [repr, "{:.6g}".format])
def test_json_lines_of_all_quantities(tmp_path: Path, form: object) -> None:
    robot = rttrr_pin.load("rttrr")
    q, v, a = np.random.default_rng(4).uniform(-1, 1, (3, 20, 5))
    result = robot.inverse_dynamics(q, v, a)

    def short(x: np.ndarray) -> list[object]:
        return np.vectorize(lambda y: float(form(float(y))))(x).tolist()  # type: ignore[operator]

    lines = [
        json.dumps(
            {"q": dict(zip(robot.joint_names, short(q[k]), strict=True)), "v": short(v[k]), "a": short(a[k])}
            | {key: short(x[k]) for key, x in result.items()}
        )
        for k in range(20)
    ]
    path = written(tmp_path, "\n".join(lines), "results.jsonl")
    judged = validate(robot, path, "recursion")
    assert judged.passed and len({row.quantity for row in judged.references[0].rows}) == 5


def test_a_floating_base_at_few_digits(tmp_path: Path) -> None:
    """A quaternion of six digits is of length 1 to six digits."""
    robot = rttrr_pin.load("rttrr", base="floating")
    rng = np.random.default_rng(5)
    q, v, a = rng.uniform(-1, 1, (30, robot.model.nq)), *rng.uniform(-1, 1, (2, 30, robot.model.nv))
    q[:, 3:7] /= np.linalg.norm(q[:, 3:7], axis=1)[:, None]
    tau = robot.inverse_dynamics(q, v, a).tau
    names = column_names(robot.model)
    header = ",".join(names["q"] + names["v"] + names["a"] + names["tau"])
    np.savetxt(tmp_path / "x.csv", np.hstack([q, v, a, tau]), "%.6f", ",", header=header)
    assert validate(robot, tmp_path / "x.csv", "recursion").passed
    np.savetxt(tmp_path / "x.csv", np.hstack([q, v, a, tau + 1e-3]), "%.6f", ",", header=header)
    assert not validate(robot, tmp_path / "x.csv", "recursion").passed


def test_results_that_are_no_number_are_deviations(tmp_path: Path) -> None:
    path = written(tmp_path, HEADER + "0,0,1,0.6\n0,0,1,nan\n0,0,1,inf\n")
    assert validate(pendulum(), path, "recursion").references[0].rows[0].failures == 2


def test_the_payload_is_the_tables_own(tmp_path: Path) -> None:
    payload = Wrench((0, 0, 0), (0, 5, 0))
    assert validate(pendulum(), swings(tmp_path, error=5.0), "recursion", payload=payload).passed
    assert not validate(pendulum(), swings(tmp_path), "recursion", payload=payload).passed
    with pytest.raises(InputError, match="no random payload"):
        validate(pendulum(), swings(tmp_path), "recursion", payload=RandomPayload())


def test_a_table_has_its_own_states_alone(tmp_path: Path) -> None:
    table = Table(swings(tmp_path), pendulum().model)
    whole = table.states()
    part = Batch(whole.model, whole.q[50:60], whole.v[50:60], whole.a[50:60], first=50)
    assert np.array_equal(table.evaluate(part).values["tau"], table.evaluate(whole).values["tau"][50:60])
    with pytest.raises(ImplementationError, match="at its own states and no others"):
        table.evaluate(Batch(whole.model, whole.q[:10] + 1, whole.v[:10], whole.a[:10]))


def loaded(folder: Path, form: str = "%.17g", state: str = "%.17g", error: float = 0.0) -> Path:
    """A table of the arm, two of whose links exert forces; its writer knew all digits."""
    robot = rttrr_pin.load("rttrr")
    rng = np.random.default_rng(8)
    q, v, a = rng.uniform(-1, 1, (3, 30, 5))
    wrenches = [Wrench(*rng.uniform(-20, 20, (2, 30, 3)), link=link) for link in ("link_3", "tool")]
    tau = robot.inverse_dynamics(q, v, a, wrenches).tau + error
    names = column_names(robot.model)
    header, columns = names["q"] + names["v"] + names["a"] + names["tau"], [q, v, a, tau]
    for wrench in wrenches:
        header += [f"payload_{key}_{wrench.link}_{axis}" for key in "fn" for axis in "xyz"]
        columns += [np.asarray(wrench.force), np.asarray(wrench.moment)]
    forms = [state] * 15 + [form] * 17
    np.savetxt(folder / "x.csv", np.hstack(columns), forms, ",", header=",".join(header), comments="")  # type: ignore[arg-type]
    return folder / "x.csv"


@pytest.mark.one_in(2)
@pytest.mark.parametrize("reference", ["recursion", "pinocchio", "lagrange", "kernel"])
def test_a_payload_of_columns_is_another_in_each_row(tmp_path: Path, reference: str) -> None:
    robot = rttrr_pin.load("rttrr")
    right = validate(robot, loaded(tmp_path), reference)
    assert right.passed and right.payload == "the table's, at link_3, tool"
    assert not validate(robot, loaded(tmp_path, error=1e-9), reference).passed


@pytest.mark.parametrize(("state", "form"), [("%.17g", "%.4f"), ("%.17g", "%.5g"), ("%.6g", "%.6g"), ("%.3f", "%.3f")])
def test_the_digits_of_a_payload_count(tmp_path: Path, state: str, form: str) -> None:
    robot = rttrr_pin.load("rttrr")
    path = loaded(tmp_path, form, state)
    assert validate(robot, path, "recursion").passed
    if state == "%.17g":  # all of the difference comes from the digits of payload and results
        table = Table(path, robot.model)
        table._payloads = [(load, np.zeros_like(halves)) for load, halves in table._payloads]
        assert not validate(robot, table, "recursion").passed
    assert not validate(robot, loaded(tmp_path, form, state, error=0.1), "recursion").passed


def test_one_row_of_a_table_with_payloads_is_that_of_the_run(tmp_path: Path) -> None:
    robot = rttrr_pin.load("rttrr")
    report = rttrr_pin.compare_state(robot, 7, loaded(tmp_path), "recursion")
    assert report.passed
    assert [load.f.shape for load in report.batch.loads] == [(1, 3), (1, 3)]


def test_a_payload_that_is_zero_is_none(tmp_path: Path) -> None:
    names = ",".join(f"payload_{key}_rod_{axis}" for key in "fn" for axis in "xyz")
    path = written(tmp_path, HEADER.replace("\n", f",{names}\n") + "0,0,1,0.6,0,0,0,0,0,0\n")
    assert Table(path, pendulum().model).states().loads == ()
    assert validate(pendulum(), path, "recursion", payload=Wrench((0, 0, 0))).passed


@pytest.mark.parametrize("payload", [Wrench((0, 0, 5)), RandomPayload()])
def test_a_table_with_a_payload_takes_no_other(tmp_path: Path, payload: Wrench | RandomPayload) -> None:
    with pytest.raises(InputError, match="x.csv has its own payload at link_3.*expected one of the two; pass none"):
        validate(rttrr_pin.load("rttrr"), loaded(tmp_path), "recursion", payload=payload)


def test_two_tables_have_the_same_payload(tmp_path: Path) -> None:
    first = loaded(tmp_path).rename(tmp_path / "first.csv")
    assert validate(rttrr_pin.load("rttrr"), first, loaded(tmp_path)).passed
    text = first.read_text().splitlines()
    first.write_text("\n".join([text[0], text[1].rpartition(",")[0] + ",1", *text[2:]]))
    with pytest.raises(InputError, match="have different payloads"):
        validate(rttrr_pin.load("rttrr"), first, loaded(tmp_path))


def test_results_with_a_payload_are_those_of_no_other(tmp_path: Path) -> None:
    table = Table(loaded(tmp_path), rttrr_pin.load("rttrr").model)
    whole = table.states()
    with pytest.raises(ImplementationError, match="no others"):
        table.evaluate(Batch(whole.model, whole.q, whole.v, whole.a))


@pytest.mark.parametrize("axes", ["link", "base"])
def test_json_lines_have_the_payload_of_their_requests(tmp_path: Path, axes: str) -> None:
    """A request beside its reply: what a program was asked, and what it said."""
    robot = rttrr_pin.load("rttrr")
    rng = np.random.default_rng(9)
    lines = []
    for q, v, a, f, n in zip(*rng.uniform(-1, 1, (3, 10, 5)), *rng.uniform(-1, 1, (2, 10, 3)), strict=True):
        wrench = Wrench(f, n, link="tool", expressed_in=axes)  # type: ignore[arg-type]
        entry = {"payload": [{"link": "tool", "f": f.tolist(), "n": n.tolist(), "axes": axes}]}
        state = {"q": q.tolist(), "v": v.tolist(), "a": a.tolist()}
        lines.append(json.dumps(state | entry | {"tau": robot.inverse_dynamics(q, v, a, wrench).tau.tolist()}))
    path = written(tmp_path, "\n".join(lines), "x.jsonl")
    assert validate(robot, path, "recursion").passed
    assert [load.in_base for load in Table(path, robot.model).states().loads] == [axes == "base"]


class FakeParquet:
    """Stands for pyarrow's table: columns with names and NumPy types."""

    def __init__(self, columns: dict[str, np.ndarray]) -> None:
        self.columns, self.column_names = columns, list(columns)
        self.num_rows = len(next(iter(columns.values())))

    def column(self, name: str) -> SimpleNamespace:
        return SimpleNamespace(to_numpy=lambda: self.columns[name])


@pytest.mark.parametrize(("dtype", "digits"), [(np.float64, None), (np.float32, 6)])
def test_parquet_has_the_digits_of_its_types(
    tmp_path: Path, dtype: type, digits: int | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    q, v, a = np.random.default_rng(6).uniform(-3, 3, (3, 100))
    columns = {"q_pivot": q, "v_pivot": v, "a_pivot": a, "tau_pivot": moment(q, v, a).astype(dtype)}
    monkeypatch.setitem(sys.modules, "pyarrow", package := ModuleType("pyarrow"))
    package.parquet = SimpleNamespace(read_table=lambda path: FakeParquet(columns))  # type: ignore[attr-defined]
    assert validate(pendulum(), tmp_path / "x.parquet", "recursion").passed
    assert Table(tmp_path / "x.parquet", pendulum().model).digits == digits
    columns["tau_pivot"] = columns["tau_pivot"].astype(str)
    with pytest.raises(InputError, match="column tau_pivot: <U.* is no type of real numbers"):
        Table(tmp_path / "x.parquet", pendulum().model)


def test_parquet_needs_pyarrow(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ImplementationError, match=r"pip install 'rttrr-pin\[parquet\]'"):
        Table(tmp_path / "x.parquet", pendulum().model)


DAMAGED = {
    "empty": ("", "is empty"),
    "no-row": (HEADER, "has a header and no row"),
    "word": (HEADER + "0,0,0,0\n0,zero,0,0\n", "line 3, column v_pivot: 'zero' is no number"),
    "blank-cell": (HEADER + "0,0,0,\n", "line 2, column tau_pivot: '' is no number"),
    "underscore": (HEADER + "0,1_0,0,0\n", "'1_0' is no number"),
    "fortran": (HEADER + "0,0,1.0D+00,0\n", "'1.0D+00' is no number"),
    "comma": (HEADER.replace(",", ";") + "0;0;1,5;0\n", "'1,5' is no number: write a point for the comma"),
    "long-row": (HEADER + "0,0,0,0,0\n", "line 2: 5 cells, and the header has 4"),
    "short-row": (HEADER + "0,0,0,0\n\n0,0,0\n", "line 4: 3 cells"),
    "twice": (HEADER.replace("v_", "q_") + "0,0,0,0\n", "has the column 'q_pivot' 2 times"),
    "no-rates": ("q_pivot,a_pivot,tau_pivot\n0,0,0\n", "lacks the columns v_pivot"),
    "no-result": ("q_pivot,v_pivot,a_pivot\n0,0,0\n", "has no column of results: add tau_pivot"),
    "half-a-vector": ("q_pivot,v_pivot,a_pivot,F_rod_x\n0,0,0,0\n", "lacks the columns F_rod_y, F_rod_z"),
    "half-a-payload": (HEADER.replace("\n", ",payload_f_rod_x\n") + "0,0,0,0,0\n", "lacks the columns payload_f_rod_y"),
    "payload-at-no-link": (HEADER.replace("\n", ",payload_f_rode_x\n") + "0,0,0,0,0\n", "did you mean payload_f_rod_x"),
    "payload-nan": (
        HEADER.replace("\n", "".join(f",payload_{key}_rod_{axis}" for key in "fn" for axis in "xyz") + "\n")
        + "0,0,0,0,0,0,0,0,nan,0\n",
        "payload_n_rod_y[0] is nan",
    ),
    "joint": (HEADER.replace("tau_pivot", "tau_pivto") + "0,0,0,0\n", "did you mean tau_pivot"),
    "infinite-state": (HEADER + "0,0,0,0\n0,inf,0,0\n", "v[1, 0], joint 'pivot', is inf"),
    "many-times": (",".join(["q_pivot"] * 200_000) + "\n", "has the column 'q_pivot' 200000 times"),
    "unknown-and-long": ("q_" + "x" * 100_000 + "\n0\n", "no column is called 'q_xxx"),
    "no-end-of-line": (HEADER + "1" * 4_000_001, "line 2: it has more than 4,000,000 characters"),
    "huge-cell": (HEADER + "0,0,0," + "1" * 200000 + "\n", "field larger than field limit"),
}


@pytest.mark.parametrize("case", DAMAGED)
def test_a_damaged_table_names_line_and_column(tmp_path: Path, case: str) -> None:
    text, message = DAMAGED[case]
    with pytest.raises(RttrrError) as caught:
        Table(written(tmp_path, text), pendulum().model)
    assert message in str(caught.value) and "results.csv" in str(caught.value)
    assert len(str(caught.value)) < 1000


@pytest.mark.parametrize("exponent", ["9" * 400, "9" * 5000], ids=len)
@pytest.mark.parametrize("sign", ["", "-"])
def test_exponents_of_any_length_are_numbers(tmp_path: Path, sign: str, exponent: str) -> None:
    """0 and infinity, as float64 has them."""
    table = Table(written(tmp_path, HEADER + f"0,0,0,0e{sign}{exponent}\n0,0,0,1e{sign}{exponent}\n"), pendulum().model)
    values = table.evaluate(table.states()).values["tau"].ravel()
    assert values.tolist() == [0.0, 0.0 if sign else np.inf]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("\n", "is empty"),
        ("{}", "lacks the columns q_pivot"),
        ('{"q": 0, "v": 0, "a": 0, "tau": 0}\n{"q": 0', "line 2: '{\"q\": 0' is no JSON"),
        ('{"q": 0, "v": 0, "a": 0, "tau": 0}\n{"q": 0, "v": 0, "a": 0, "f": [1, 2, 3]}', "line 2: other quantities"),
        ('{"q": 0, "v": 0, "a": 0, "tau": [1, 2]}', "line 1, tau has 2 numbers, expected 1"),
        ('{"q": 0, "v": 0, "a": 0, "f": {"rode": [1, 2, 3]}}', "did you mean rod"),
        ('{"q": null, "v": 0, "a": 0, "tau": 0}', "is nan"),
        ("[1, 2]", "lacks the columns"),
        ('{}\n{"q": 0, "v": 0, "a": 0, "tau": 0}', "lacks the columns"),
        ('{"q": 0, "v": 0, "a": 0, "tau": 0, "payload": 5}', "line 1, payload has '5': expected an object"),
        ('{"q": 0, "v": 0, "a": 0, "payload": [{"link": "rode", "f": [0, 0, 0], "n": [0, 0, 0]}]}', "did you mean rod"),
        (
            '{"q": 0, "v": 0, "a": 0, "payload": [{"link": "rod", "f": [0, 0], "n": [0, 0, 0]}]}',
            "line 1, payload, f at rod has 2 numbers, expected 3",
        ),
        (
            '{"q": 0, "v": 0, "a": 0, "payload": [{"link": "rod", "f": [0, 0, 1], "n": [0, 0, 0], "axes": "world"}]}',
            "expected 'link' or 'base'",
        ),
        (f'{{"q": 0, "v": 0, "a": 0, "tau": {"[" * 900}0{"]" * 900}}}', "lists in each other, more than 8 deep"),
    ],
)
def test_damaged_json_lines_name_their_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(RttrrError) as caught:
        Table(written(tmp_path, text, "results.jsonl"), pendulum().model)
    assert message in str(caught.value)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    for path, message in ((tmp_path / "no.csv", "No such file"), (tmp_path, "Is a directory")):
        with pytest.raises(InputError, match=message):
            Table(path if path.suffix else path.rename(tmp_path.with_suffix(".csv")), pendulum().model)
    latin = tmp_path.with_suffix(".csv") / "latin.csv"
    latin.write_bytes(HEADER.encode() + b"0,0,0,\xe9\n")
    with pytest.raises(InputError, match="no UTF-8 text"):
        Table(latin, pendulum().model)
