"""Damaged and hostile tables of results, replies of programs, manifests of packages, and words of the command line."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from functools import cache
from typing import Any

from .seeds import SMALL
from .text_cases import DAMAGES, LATEX_PIECES, PYTHON_PIECES

ROBOT = SMALL["free"]
"""Whose results the tables hold: a planar and a floating joint, so a quaternion and columns of several letters."""

NUMBERS = (
    "1e400", "-1e400", "1e-400", "nan", "inf", "-Infinity", "1_0", "1,5", "0x10", "1d5", "0e-" + "9" * 400, "TRUE", " 1 ",
    "1e" + "9" * 5000, "1e-" + "9" * 5000, "9" * 5000, "0." + "0" * 5000 + "1", "", "-", "'", '"', '""', "\x00", "\u0661",
    "1e\u0661", "null", "[1]", "1 2", "1.5kg", "+.5", "5.", ".", "e5", "--1", "\u22121", "x" * 3000, "\x1b[31m", "\ud800",
)  # fmt: skip

TABLE_PIECES = (
    ",", ";", "\t", "\n", "\r", "\r\n", "#", '"', "''", "q_", "v_", "tau_p", "F_a_x", "n_b_z", "f_c_x", "\ufeff", "\u2028",
)  # fmt: skip

JSON_PIECES = (
    "[", "]", "{", "}", ",", ":", '"', "null", "NaN", "nan", "-inf", "Infinity", "true", '"tau"', '"q"', '"F":', '"error":',
    "\\u0000", "\\ud800", "1.", "01", "// x", "\n", "\r", "{}", "[]", '"a": ', '"p_x"', "1e5", "'",
)  # fmt: skip

MANIFEST_PIECES = (
    "<name>", "</name>", "<name ", "<name", " ", "\n", "x", "p", "<package>", "</package>", "<!--", "-->", ">", "<", "\x00",
    "\u4e2d", "&amp;", "<name xml:lang='x'>", "..", "/",
)  # fmt: skip

OPTIONS = {
    "inspect": ("--xacro-arg", "--package", "--select", "--ignore", "--fail-on", "--json", "--fix", "--sarif", "--junit"),
    "state": (
        "--index", "--gravity", "--payload", "--payload-link", "--payload-axes", "--base", "--seed", "--sampling",
        "--xacro-arg", "--package", "--reference", "--json",
    ),
    "diagnose": (
        "--states", "--gravity", "--payload", "--payload-link", "--payload-axes", "--base", "--seed", "--xacro-arg",
        "--package", "--reference", "--json", "--html",
    ),
    "sample": ("--states", "--gravity", "--payload", "--payload-link", "--base", "--seed", "--package", "--output"),
    "compare": ("--states", "--gravity", "--base", "--seed", "--package", "--json", "--html"),
    "new": ("--name", "--output"),
}  # fmt: skip
"""Those that take a word, by command."""

WORDS = (
    "", " ", "=", ":=", "a:=b", ":=b", "a:=", "dof:=7", "a=b", "p=/", "p=.", "=.", "p=\x00", "0,0,-9.81", "0 0 1", "1,2",
    "1,2,3,4,5,6", "0,0,0,0,0,nan", "1e400,0,0", "1e-400,0,0", "0,0,1e200", "-1", "7", "9" * 30, "1e5", "floating", "base",
    "uniform", "mixed", "random", "link_5", "tool", "P", "G201", "recursion", "lagrange", "os:getcwd", "nothing:at_all",
    "a.csv", "a.jsonl", "/", ".", "\x00", "/dev/null/x", "x" * 300, "x" * 5000, "\ud800", "\x1b[31m", "\u202e", "--", "-",
    "--json", "\u0661", "9" * 5000, "1e999999999", "0x10", "1_0", "drake", "Drake",
)  # fmt: skip


@cache
def _names() -> dict[str, list[str]]:
    import rttrr_pin
    from rttrr_pin.implementations.text_results import column_names

    return column_names(rttrr_pin.load(ROBOT).model)


QUANTITIES = (("tau",), ("tau", "F", "N", "f", "n"))
"""Those of a table; few sets, since a kernel is compiled for each."""


def table(quantities: tuple[str, ...]) -> str:
    """A table in three digits."""
    (row,) = _rows(random.Random(0), 1, quantities)
    cells = [[name for key in row for name in _names()[key]], [f"{x:.3f}" for values in row.values() for x in values]]
    return "\n".join(",".join(line) for line in cells)


def _rows(rng: random.Random, count: int, quantities: tuple[str, ...] = ()) -> list[dict[str, list[float]]]:
    """States and what may be results."""
    keys = ["q", "v", "a", *(quantities or rng.choice(QUANTITIES))]
    rows = [{key: [rng.uniform(-2, 2) for _ in _names()[key]] for key in keys} for _ in range(count)]
    for row in rows:
        row["q"][-4:] = [0.0, 0.6, 0.0, 0.8]
    return rows


def _csv(rng: random.Random) -> str:
    rows, form = _rows(rng, rng.choice((1, 3, 20))), rng.choice(("{!r}", "{:.6g}", "{:.3f}", "{:.17e}"))
    separator = rng.choice(",;\t")
    header = [name for key in rows[0] for name in _names()[key]]
    cells = [[form.format(x) for values in row.values() for x in values] for row in rows]
    for _ in range(rng.choice((0, 0, 1, 2))):
        rng.choice(cells)[rng.randrange(len(header))] = rng.choice(NUMBERS)
    return (
        rng.choice(("", "# ")) + "\n".join(separator.join(line) for line in [header, *cells]) + rng.choice(("", "\n"))
    )


def _json_lines(rng: random.Random) -> str:
    """Lines of states and results, some of them by name, some with another word for a number."""
    lines = []
    for row in _rows(rng, rng.choice((1, 3, 20))):
        entry: dict[str, Any] = dict(row)
        if rng.random() < 0.3:
            entry["q"] = {"p": row["q"][:3], "q": row["q"][3:]}
        lines.append(json.dumps(entry))
    text = "\n".join(lines) + "\n"
    for _ in range(rng.choice((0, 0, 1, 2))):
        start = rng.randrange(len(text))
        text = text[:start] + rng.choice((*NUMBERS, *JSON_PIECES)) + text[start + rng.randint(0, 6) :]
    return text


def _replies(rng: random.Random) -> str:
    """What a program may write for the three states that it is tried on."""
    if rng.random() < 0.3:
        return "\n".join("".join(rng.choices(JSON_PIECES, k=rng.choice((1, 5, 20)))) for _ in range(3)) + "\n"
    results = [{key: x for key, x in row.items() if key not in "qva"} for row in _rows(rng, 3)]
    bare = rng.random() < 0.3
    text = "".join(json.dumps(row.get("tau", 1.0) if bare else row) + "\n" for row in results)
    for _ in range(rng.choice((0, 1, 2))):
        text = rng.choice(DAMAGES)(text, rng)
    return text


def _damaged(made: Callable[[random.Random], str], pieces: tuple[str, ...]) -> Callable[[random.Random], str]:
    def damaged(rng: random.Random) -> str:
        text = made(rng)
        for _ in range(rng.choice((0, 0, 1, 3))):
            text = rng.choice(DAMAGES)(text, rng)
        start = rng.randrange(len(text) + 1)
        return text[:start] + rng.choice(("", rng.choice(pieces))) + text[start:]

    return damaged


def _hostile_csv(rng: random.Random) -> str:
    header = ",".join(name for names in _names().values() for name in names)
    width = header.count(",") + 1
    return rng.choice((
        lambda: ",".join(["q_p_x"] * 400_000) + "\n",
        lambda: ",".join(f"q_{k}" for k in range(100_000)) + "\n1\n",
        lambda: header + "\n" + "1" * 2**21 + "\n",
        lambda: header + "\n" + (",".join(["1"] * width) + "\n") * 2_000,
        lambda: header + "\n" + "1\n" * 500_000,
        lambda: header + "\n" + '"' * 2**20,
        lambda: header + "\n" + ",".join([rng.choice(NUMBERS)] * width) + "\n",
        lambda: "q_" + "x" * 2**20 + "\n1\n",
        lambda: "\n" * 2**21,
        lambda: "\r" * 2**20 + header,
        lambda: "," * 2**21 + "\n1",
        lambda: "#" * 2**20 + "\n1",
        lambda: header,
        lambda: "".join(rng.choices((*TABLE_PIECES, *NUMBERS), k=60)),
    ))()  # fmt: skip


def _hostile_json(rng: random.Random) -> str:
    depth = rng.choice((15, 400, 900, 960, 980, 5000, 200_000))
    key = rng.choice(("tau", "q", "F", "x"))
    line = rng.choice((
        lambda: f'{{"{key}": {"[" * depth}1{"]" * depth}}}',
        lambda: "[" * depth + "1" + "]" * depth,
        lambda: '{"tau": ' * depth + "1" + "}" * depth,
        lambda: f'{{"{key}": [{", ".join([rng.choice(NUMBERS[:10])] * 200_000)}]}}',
        lambda: f'{{"{key}": {{{", ".join(f"{chr(34)}{k}{chr(34)}: 1" for k in range(50_000))}}}}}',
        lambda: f'{{"{key}": "{rng.choice(("x", "nan ", "inf", "9")) * 300_000}"}}',
        lambda: "nan " * 300_000,
        lambda: "nan" + "[" * depth,
        lambda: "9" * 2**20,
        lambda: "x" * 2**21,
        lambda: '{"error": "' + "x" * 100_000 + '"}',
        lambda: '{"' + "k" * 300_000 + '": 1}',
        lambda: "{}\n" * 200_000,
        lambda: "".join(rng.choices((*JSON_PIECES, *NUMBERS), k=rng.choice((5, 50, 500)))),
    ))()  # fmt: skip
    return f"{line}\n" * rng.choice((1, 3))


def _manifest(rng: random.Random) -> str:
    pieces = rng.sample(MANIFEST_PIECES, rng.choice((2, 5, 12)))
    text = "".join(rng.choices(pieces, k=rng.choice((5, 50, 40_000))))
    return rng.choice((text, f"<package><name>p</name>{text}</package>", f"<package>{text}<name>p</name></package>"))


def _words(rng: random.Random) -> str:
    """A command line, as a list in JSON."""
    command = rng.choice(list(OPTIONS))
    words = [command, rng.choice(("RT", "TRR", *WORDS[:4])) if command == "new" else "trr"]
    words += {"state": ["--subject", "recursion"], "diagnose": ["--subject", "recursion"], "compare": ["trtr"]}.get(
        command, []
    )
    for _ in range(rng.randint(1, 3)):
        words += [rng.choice(OPTIONS[command]), rng.choice((*WORDS, *NUMBERS, *LATEX_PIECES, *PYTHON_PIECES))]
    return json.dumps(words)


READERS: dict[str, tuple[Callable[[random.Random], str], ...]] = {
    ".csv": (_damaged(_csv, TABLE_PIECES), _hostile_csv),
    ".jsonl": (_damaged(_json_lines, JSON_PIECES), _hostile_json),
    ".replies": (_replies, _hostile_json),
    ".xml": (_manifest,),
    ".words": (_words,),
}
"""By the ending of its file, what makes cases for a reader: damaged ones, and hostile ones."""


def other_case(rng: random.Random) -> tuple[str, bytes]:
    """How the file of a case is called at its end, and what is in it."""
    ending = rng.choice(list(READERS))
    damaged, *hostile = READERS[ending]
    made = rng.choice(hostile) if hostile and rng.random() < 0.2 else damaged
    data = bytearray(made(rng).encode(errors="surrogatepass"))
    if ending != ".words" and data and rng.random() < 0.1:
        data[rng.randrange(len(data))] = rng.randrange(256)
    return ending, bytes(data)
