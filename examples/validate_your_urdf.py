"""Is a URDF's dynamics computed alike by our recursion and by Pinocchio? Pass a path; without one, the bundled arm."""

from __future__ import annotations

import sys

import rttrr_pin
from rttrr_pin.validation import compare_state, validate

robot = rttrr_pin.load(sys.argv[1] if len(sys.argv) > 1 else "rttrr")
outcome = validate(robot, states=2000, payload="random")
print("agree" if outcome.agrees else "disagree", "on", outcome.n_states, "states")

worst = outcome.worst
if worst is not None:
    print(f"closest to the gate: {worst.quantity} at {worst.at}, {worst.share.value:.0%} of what rounding can explain")
    report = compare_state(robot, worst.share.state, payload="random")
    print("ours  ", report.ours.tau[0])
    print("theirs", report.theirs.tau[0])
