"""The tables of docs/table.md: how far each library gets through the levels, what it fails, and its speed."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from typing import Any

from common import Lines, machine_of, result, table

Entry = dict[str, Any]

URDF = {"rttrr": "urdf/rttrr.urdf", "floating": "urdf/levels/tree.urdf"}
"""Files of robots that are not urdf/levels/NAME.urdf."""

NUMBER = re.compile(r"-?\d+\.\d+(?:e[-+]?\d+)?")

TEN = re.compile(r"\(parameters \{(.*?)\}, parameters in the file \{(.*?)\}\)")

PAIR = re.compile(r"'([^']+)': ([^,}]+)")
"""Of a dictionary as it is printed."""

OWN = ("recursion", "kernel")


def standings() -> Lines:
    """One row for each library and float type: the level reached, and each level."""
    data = result("conform")
    ids = list(data["levels"])
    rows = [
        (_name(entry), entry["float"], _passed(entry), entry["reached"], *(_cell(entry, level) for level in ids))
        for entry in data["entries"]
    ]
    libraries = {entry["name"] for entry in data["entries"]} - set(OWN)
    return [
        f"{len(libraries)} libraries and our own two programs, {data['states']} states of each case "
        f"({machine_of(data)}; `python benchmarks/conform/run.py --save`). A number is the largest error of a level "
        "that was passed, in eps of the float type; **fail** is one that rounding cannot explain; – is not offered.",
        "",
        *table(["", "float", "passed", "reached", *(f"{k} {level}" for k, level in enumerate(ids, 1))], rows),
        "",
        *(f"{k}. {level}: {sentence}" for k, (level, sentence) in enumerate(data["levels"].items(), 1)),
        *(
            ["", *(f"- {name} is left out: {why}" for name, why in data["left_out"].items())]
            if data["left_out"]
            else []
        ),
    ]


def _name(entry: Entry) -> str:
    """The library and its version; our own by their names in `rttrr-pin`."""
    own = f"rttrr-pin, {entry['name']}" if entry["name"] in OWN else entry["name"]
    return f"{own} {next(iter(entry['versions'].values()), '')}".rstrip()


def _passed(entry: Entry) -> int:
    """How many levels were passed with all their robots."""
    levels = {case["level"] for case in entry["cases"]}
    return len(levels - {case["level"] for case in entry["cases"] if case["outcome"] != "pass"})


def _cell(entry: Entry, level: str) -> str:
    """The outcome of a level with all its robots."""
    own = [case for case in entry["cases"] if case["level"] == level]
    outcomes = {case["outcome"] for case in own}
    if outcomes & {"fail", "error"}:
        return "**fail**"
    if "not offered" in outcomes:
        return "–"
    eps = max((case.get("eps", 0.0) for case in own), default=0.0)
    return f"{eps:.1f}" if eps < 10 else f"{eps:,.0f}"


def times() -> Lines:
    """Nanoseconds a state, and the call that is timed."""
    data = result("conform")
    counts = data["counts"]
    rows = [
        (_name(entry), entry["float"], *(_nanoseconds(entry["ns"], count) for count in counts), f"`{entry['call']}`")
        for entry in data["entries"]
    ]
    return [
        f"Nanoseconds of processor time a state for tau of `{data['timed']}`, all threads together, the least of three "
        f"runs ({machine_of(data)}):",
        "",
        *table(["", "float", *(f"N = {count:,}" for count in counts), "call"], rows),
    ]


def _nanoseconds(times: dict[str, Any], count: int) -> str:
    own = times.get(str(count))
    if not own:
        return ""
    fewer = "" if own["states"] == count else f" (of {own['states']:,})"
    return f"{own['ns']:,.0f}{fewer}"


def conversions() -> Lines:
    """What the adapters convert."""
    rows: dict[str, tuple[str, ...]] = {}
    for entry in result("conform")["entries"]:
        if entry["name"] not in OWN:
            rows[entry["name"]] = (
                entry["name"],
                ", ".join(f"{package} {version}" for package, version in entry["versions"].items()),
                entry["conventions"].replace("<inertial>", "`<inertial>`"),
            )
    return table(["", "versions", "what the adapter converts"], rows.values())


def missing() -> Lines:
    """What is not offered, and what was refused, in the library's words."""
    lines: Lines = []
    for entry in result("conform")["entries"]:
        words: dict[str, list[str]] = {}
        for case in entry["cases"]:
            if case["outcome"] == "not offered":
                text = re.sub("^not offered: ", "", case["message"]).replace("refused: ", "refuses: ", 1)
                words.setdefault(text, []).append(case["id"])
        told = "; ".join(f"{text} ({', '.join(ids)})" for text, ids in words.items())
        lines += [f"- **{_name(entry)}**, {entry['float']}: {told}."] if words else []
    return lines


def failures() -> Lines:
    """A section for each library that fails: cause by cause, with one state."""
    lines: Lines = []
    for entry in result("conform")["entries"]:
        broken = [case for case in entry["cases"] if case["outcome"] == "error"]
        if not entry["failures"] and not broken:
            continue
        lines += [f"### {_name(entry)}, {entry['float']}", ""]
        causes: dict[str, list[dict[str, Any]]] = {}
        for one in entry["failures"]:
            causes.setdefault(_shorter(one["cause"]), []).append(one)
        for cause, those in causes.items():
            lines += [*_failure(entry, cause, those), ""]
        lines += [f"- {case['id']}: {case['message']}" for case in broken] + ([""] if broken else [])
    return lines[:-1]


OF_CENTRES = (
    "with all centres of mass at the origins of their links, accelerations agree to rounding, and rates to 2e-10, "
    "which is more than rounding"
)

BY_HAND = {
    (
        "Pinocchio",
        "fixed-fixed",
    ): "`computeSupportedForceByFrame` adds all moving joints of the rigid body to each of its "
    "frames, whichever link of it they hang on: it is right where the body does not branch. tau, and f and n of moving "
    "joints, pass",
    (
        "PyBullet",
        "gravity-arm6",
    ): "with an `<inertial>` of the root that has no rpy all torques at rest agree: gravity is "
    "taken in the axes of the root's `<inertial>`",
    ("PyBullet", "prismatic-rttrr"): "a link without `<inertial>` gets 1 kg: on `rttrr` its torques are those of DART",
    ("Robotics Toolbox", "gravity-arm6"): "with all joint axes along z all torques of arm6 agree",
    ("ManipulaPy", "rates-arm6"): OF_CENTRES,
    ("ManipulaPy", "prismatic-rttrr"): OF_CENTRES,
}
"""What was found by trying, where `diagnose` names no cause."""


def _failure(entry: Entry, cause: str, those: list[dict[str, Any]]) -> Lines:
    """What fails for one cause: the cases, one number, and how to see it."""
    one = those[0]
    levels = ", ".join(own["id"] for own in those)
    beyond, count = sum(own["beyond"] for own in those), sum(own["count"] for own in those)
    symbol, unit = one["quantity"], one["unit"]
    notes = dict.fromkeys(BY_HAND[key] for own in those if (key := (entry["name"], own["id"])) in BY_HAND)
    hand = f" By hand: {'; '.join(notes)}." if notes else ""
    return [
        f"**{cause}** ({levels}; {beyond:,} of {count:,} numbers beyond rounding).{hand} In {one['id']}, {symbol} of "
        f"`{one['at']}` is {_vector(one['given'])} {unit}; the true value lies in {_between(one)} {unit}:",
        "",
        "```",
        f"echo '{_request(one)}' |",
        f"  {_command(entry, one)}",
        "```",
    ]


def _request(one: dict[str, Any]) -> str:
    state = {key: json.loads(text.replace("'", '"')) for key, text in one["state"].items()}
    for load in state.get("payload", []):
        load["axes"] = "link"
    return json.dumps(state)


def _command(entry: Entry, one: dict[str, Any]) -> str:
    robot = one["id"].partition("-")[2]
    path = URDF.get(robot, f"urdf/levels/{robot}.urdf")
    if entry["name"] in OWN:
        return f"rttrr-pin conform {entry['name']} --levels {one['id'].partition('-')[0]}"
    base = ["floating"] if robot == "floating" else []
    real = ["--float", "float32"] if entry["float"] == "float32" else []
    return " ".join(["python", f"benchmarks/conform/adapters/{entry['adapter']}", path, *base, *real])


def _vector(text: str) -> str:
    own = json.loads(text.replace("nan", "NaN").replace("inf", "Infinity"))
    shown = [f"{x:.9g}" for x in own]
    return shown[0] if len(shown) == 1 else f"({', '.join(shown)})"


def _between(one: dict[str, Any]) -> str:
    lower, upper = json.loads(one["lower"]), json.loads(one["upper"])
    shown = [f"[{a!r}, {b!r}]" if a != b else f"{a!r}" for a, b in zip(lower, upper, strict=True)]
    return shown[0] if len(shown) == 1 else " x ".join(shown)


def _shorter(cause: str) -> str:
    """A cause with its numbers to six digits, and of ten parameters those that differ by then."""

    def six(match: re.Match[str]) -> str:
        return f"{float(match[0]):.6g}"

    def differing(match: re.Match[str]) -> str:
        own, file = (dict(PAIR.findall(text)) for text in match.groups())
        return "(" + ", ".join(f"{key} {x}, file {file[key]}" for key, x in own.items() if x != file.get(key)) + ")"

    return TEN.sub(differing, NUMBER.sub(six, cause))


CONFORM: dict[str, Callable[[], Lines]] = {
    "conform": standings, "conform times": times, "conform conversions": conversions, "conform missing": missing,
    "conform failures": failures,
}  # fmt: skip
"""By the name in the marker."""
