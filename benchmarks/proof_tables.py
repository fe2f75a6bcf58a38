"""Tables of what is proven: the paper's equations, the bounds, the umpire, the laws."""

from __future__ import annotations

from saved import machine, result

NAMES = {"example:panda": "Panda with fingers", "example:talos_reduced": "Talos reduced"}


def audit() -> list[str]:
    paper, misprints = result("audit_paper"), result("audit_misprints")
    derived = next(row["n"][1] for row in result("derive")["rows"] if row["robot"] == "rttrr")
    told = ", ".join(f"{count} {kind}" for kind, count in sorted(paper["kinds"].items(), key=lambda pair: -pair[1]))
    found = misprints["copies_with_slips"] - len(misprints["copies_not_reported"])
    return [
        f"Audit of the paper ({machine(paper)}; `python benchmarks/audit_paper.py`, `audit_misprints.py`, "
        f"`derive.py`): of {paper['components']} components with {paper['printed_terms']:,} printed terms, "
        f"**{paper['match']} match, {paper['differs']} differ, {paper['unparsed']} are unparsed**; "
        f"{paper['findings']} findings: {told}. {paper['dimensionally_wrong']} printed terms have the wrong dimension, "
        "which needs no derivation. Every corrected equation is symbolically equal to the derivation and lies in the "
        f"same ball. {paper['seconds_median']:.1f} s; all moments n_i, derived and written, in {derived:.1f} s.",
        "",
        f"Planted misprints: {misprints['slips']:,} slips in {misprints['copies_with_slips']:,} copies, one to three "
        f"in each; {found:,} copies found, {100 * misprints['named_with_kind_and_term']:.1f} % of the slips named with "
        f"kind and term; {len(misprints['clean_components_reported'])} findings in "
        f"{misprints['clean_copies_of_60_components']} clean copies of all 60.",
    ]


def bounds() -> list[str]:
    proven = result("bounds")
    lines = [
        f"The kernel's own rounding bound, proven by balls ({machine(proven)}; `python benchmarks/bounds.py`): "
        f"**{proven['violations']} violations**.",
        "",
        "| | states | bound over true error, median (tau; n) | largest true error of tau, eps | time with bounds, "
        "times plain |",
        "|---|---|---|---|---|",
    ]
    for name, robot in proven["robots"].items():
        tau, n = robot["quantities"]["tau"], robot["quantities"]["n"]
        lines.append(
            f"| {NAMES.get(name, name.upper())} | {robot['states']:,} | {tau['bound_over_error_median']:.0f}; "
            f"{n['bound_over_error_median']:.0f} | {tau['largest_error_eps']:.1f} | "
            f"{robot['time_with_bounds_over_plain']:.1f} |"
        )
    return lines


def errors() -> list[str]:
    adjudicated = result("umpire")
    lines = [
        f"Distance from the true value in eps of the norm of the true vector, of the link that is farthest off, in "
        f"{adjudicated['states']:,} uniform states ({machine(adjudicated)}; `python benchmarks/umpire.py`): "
        "median / 99.9 % / worst.",
        "",
        "| | | ours | Pinocchio | states in which ours is nearer; farther |",
        "|---|---|---|---|---|",
    ]
    for name, robot in adjudicated["robots"].items():
        found = robot["errors_eps"]
        for quantity, ours in found["ours"].items():
            theirs = found["pinocchio"][quantity]
            lines.append(
                f"| {name} | {quantity} | {_row(ours)} | {_row(theirs)} | "
                f"{100 * found['ours_nearer'][quantity]:.0f} %; {100 * found['pinocchio_nearer'][quantity]:.0f} % |"
            )
    return lines


def _row(figures: dict[str, float]) -> str:
    return f"{figures['median']:.2f} / {figures['p999']:,.1f} / {figures['worst']:,.0f}"
