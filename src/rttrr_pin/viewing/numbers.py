"""The numbers of a state as tables: the same in the panel of the viewer and in a file."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.viewing.evaluation import Numbers
from rttrr_pin.viewing.states import State, displacement

UNITS = {"F": "N", "f": "N", "N": "N m", "n": "N m"}

MEANING = {
    "f": "force by the parent, at the joint",
    "n": "moment by the parent, about the joint's origin",
    "F": "net force, at the centre of mass",
    "N": "net moment, about the centre of mass",
}

STYLE = """<style>
.rp table{border-collapse:collapse;font:11.5px/1.5 ui-monospace,monospace;width:100%}
.rp th{text-align:right;white-space:nowrap;font-weight:600;border-bottom:1px solid currentColor;padding:0 .35em}
.rp td{text-align:right;padding:0 .35em;white-space:nowrap;font-variant-numeric:tabular-nums}
.rp th:first-child,.rp td:first-child{text-align:left;white-space:normal;overflow-wrap:anywhere;min-width:5em}
.rp{padding:0 .6em}
.rp p{margin:.4em 0;font-size:12px;line-height:1.4}
.rp .over{color:#c92a2a;font-weight:600}
.rp .error{color:#c92a2a}
.rp pre{font:11px/1.4 ui-monospace,monospace;white-space:pre-wrap;overflow-wrap:anywhere;margin:.4em 0}
.rp i{display:inline-block;width:.8em;height:.8em;border-radius:2px;margin:0 .3em 0 0}
.rp i:not(:first-child){margin-left:.6em}
.rp br+i{margin-left:0!important}
</style>"""


def digits(x: float) -> str:
    """A number to six digits."""
    return f"{x + 0.0:.6g}"


def text(words: object) -> str:
    """Words of a file, which never become markup."""
    return html.escape(str(words), quote=True)


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table of cells that are markup already; a share above 100 % stands out."""
    top = "".join(f"<th>{cell}</th>" for cell in head)
    body = "".join("<tr>" + "".join(map(_cell, row)) + "</tr>" for row in rows)
    return f"<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"


def _cell(content: str) -> str:
    over = content.endswith("%") and float(content[:-1]) > 100.0
    return f'<td class="over">{content}</td>' if over else f"<td>{content}</td>"


def joint_cells(model: Model, state: State, numbers: Numbers) -> list[list[str]]:
    """For each degree of freedom q, v, a, tau, unit and share of the limit; of several programs q, each tau, unit."""
    q = displacement(model, state.q)
    taus = [own.get("tau") for own in numbers.values.values()]
    limits = [joint.limits.effort for joint in model.moving for _ in range(joint.nv)]
    rows = []
    for k in range(model.nv):
        motion = (q[k], state.v[k], state.a[k]) if len(taus) == 1 else (q[k],)
        row = [*map(digits, motion), *("" if x is None else digits(float(x[k])) for x in taus)]
        row.append("N m" if model.rotations[k] else "N")
        rows.append([*row, _share(taus[0], k, limits[k])] if len(taus) == 1 else row)
    return rows


def joint_table(model: Model, state: State, numbers: Numbers) -> str:
    """The same with the names of the degrees of freedom and of the programs."""
    names, tau = list(numbers.values), "\N{GREEK SMALL LETTER TAU}"
    columns = ["v", "a", tau, "", "of limit"] if len(names) == 1 else [*(f"{tau} {text(own)}" for own in names), ""]
    cells = zip(model.v_names, joint_cells(model, state, numbers), strict=True)
    return table(["joint", "q", *columns], [[text(name), *row] for name, row in cells])


def _share(tau: Array | None, k: int, limit: float) -> str:
    """How much of the limit is used; empty where there is none."""
    if tau is None or not np.isfinite(limit) or limit <= 0.0:
        return ""
    return f"{abs(float(tau[k])) / limit:.0%}"


def link_table(model: Model, link: int, values: Mapping[str, Array], name: str = "") -> str:
    """F, N, f and n of a link in its own axes, with their sizes."""
    rows = []
    for key in ("f", "n", "F", "N"):
        if key in values:
            vector = values[key][link]
            size = float(np.linalg.norm(vector))
            rows.append(
                [f'<b title="{MEANING[key]}">{key}</b>', *map(digits, vector.tolist()), digits(size), UNITS[key]]
            )
    of = f" ({text(name)})" if name else ""
    return f"<p>{text(model.link_names[link])}, in its own axes{of}</p>" + table(["", "x", "y", "z", "size", ""], rows)


def state_in_python(model: Model, state: State) -> str:
    """The call that computes the same numbers."""
    arguments = [f"{name}={(getattr(state, name) + 0.0).tolist()}" for name in "qva"]
    wrenches = [
        f"Wrench(force={load.f.tolist()}, moment={load.n.tolist()}, link={model.link_names[load.link]!r}, "
        f"expressed_in={'base' if load.in_base else 'link'!r})"
        for load in state.loads
    ]
    if wrenches:
        arguments.append(f"payload=[{', '.join(wrenches)}]" if len(wrenches) > 1 else f"payload={wrenches[0]}")
    return "robot.inverse_dynamics(\n    " + ",\n    ".join(arguments) + "\n)"


def quantities_missing(numbers: Numbers) -> str:
    """What a program does not give."""
    lines = []
    for name, own in numbers.values.items():
        missing = [key for key in ("tau", *LINK_QUANTITIES) if key not in own]
        if missing and name != "difference":
            lines.append(f"<p>{text(name)} gives no {', '.join(missing)}</p>")
    return "".join(lines)
