"""Results as JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from rttrr_pin.validation import ReferenceSummary, Row, StateComparison, StateReport, Validation
from rttrr_pin.validation.report_adjudication import adjudicated_data, adjudication_data

GATE = (
    "|ours - oracle| <= |bound| + (|bound of x| + 4 eps |x| + cancelled); "
    "bound: running error bound of our own operations; "
    "x: the whole vector, for tau the n or f of its joint; cancelled: rounding of terms that only the oracle has"
)


def validation_data(result: Validation) -> dict[str, Any]:
    """The outcome of a run: robot, versions, seed, n_states, per quantity the worst and where, verdict.

    Of several oracles, `oracles` has what belongs to each.
    """
    seen = [_against(other) for other in result.against]
    worst = max(seen, key=lambda one: one["worst"]["share"])
    apart = seen[0] if len(seen) == 1 else {"worst": worst["worst"] | {"oracle": worst["oracle"]}, "oracles": seen}
    return {
        "robot": result.robot,
        "base": result.base,
        "gravity": result.gravity,
        "drives": {name: asdict(effects) for name, effects in result.effects.items()},
        "ours": result.ours,
        "versions": result.versions,
        "seed": result.seed,
        "n_states": result.n_states,
        "sampling": result.sampling,
        "payload": result.payload,
        "gate": GATE,
        **apart,
        "oracle": result.oracle,
        "verdict": _verdict(result.agrees),
        "failing_states": result.failing,
        "settled": [adjudicated_data(adjudicated) for adjudicated in result.adjudicated_states],
        "seconds": result.seconds,
    }


def _against(other: ReferenceSummary) -> dict[str, Any]:
    """What was seen of one oracle."""
    quantities: dict[str, dict[str, Any]] = {}
    for row in other.rows:
        quantities.setdefault(row.quantity, {})[row.at] = _row(row)
    worst = other.worst
    return {
        "oracle": f"{other.name} {other.version}",
        "verdict": _verdict(other.agrees),
        "worst": {
            "quantity": worst.quantity,
            "at": worst.at,
            "state": worst.share.state,
            "share": worst.share.value,
        },
        "normwise": {quantity: asdict(seen) for quantity, seen in other.whole.items()},
        "quantities": quantities,
    }


def state_data(report: StateReport) -> dict[str, Any]:
    """One state in full; of several oracles, `oracles` has what belongs to each."""
    states = report.states
    views = [_view(view) for view in report.views]
    return {
        "robot": report.robot,
        "state": report.index,
        "q_names": report.q_names,
        "v_names": report.v_names,
        "links": report.ours.links,
        **{name: getattr(states, name)[0].tolist() for name in "qva"},
        "payload": [
            {
                "link": report.ours.links[load.link],
                "force": load.f.ravel().tolist(),
                "moment": load.n.ravel().tolist(),
                "expressed_in": "base" if load.in_base else "link",
            }
            for load in states.loads
        ],
        "ours": {key: x[0].tolist() for key, x in report.ours.items()},
        "bound": {key: x[0].tolist() for key, x in report.bound.items()},
        "gate": GATE,
        **(views[0] if len(views) == 1 else {"oracles": views}),
        "oracle": ", ".join(view.oracle for view in report.views),
        "verdict": _verdict(report.agrees),
    }


def _view(view: StateComparison) -> dict[str, Any]:
    """What one oracle says of the state."""
    given = {row.quantity for row in view.rows}
    return {
        "oracle": view.oracle,
        "theirs": {key: x[0].tolist() for key, x in view.theirs.items() if key in given},
        "gaps": [
            {
                "quantity": row.quantity,
                "at": row.at,
                "unit": row.unit,
                "difference": float(gap.difference[0]),
                "eps": float(gap.relative[0]),
                "share": float(gap.share[0]),
            }
            for row, gap in zip(view.rows, view.gaps, strict=True)
        ],
        "settled": adjudication_data(view.adjudicated),
        "verdict": _verdict(view.agrees),
    }


def _verdict(agrees: bool) -> str:
    return "agree" if agrees else "disagree"


def _row(row: Row) -> dict[str, Any]:
    return {
        "unit": row.unit,
        "worst_absolute": asdict(row.absolute),
        "worst_eps": asdict(row.relative),
        "worst_share_of_gate": asdict(row.share),
        "failures": row.failures,
        "verdict": "pass" if row.passed else "fail",
    }
