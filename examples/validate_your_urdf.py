"""Is a URDF's dynamics computed alike by our recursion and by Pinocchio? Pass a path; without one, the bundled arm."""

from __future__ import annotations

import sys

import rttrr_pin

robot = rttrr_pin.load(sys.argv[1] if len(sys.argv) > 1 else "rttrr")
payload = rttrr_pin.RandomPayload()
outcome = rttrr_pin.validate(robot, subject="kernel", reference="pinocchio", n_states=2000, payload=payload)
print(outcome.summary())

worst = outcome.worst
if worst is not None:
    state = worst.of_tolerance.state
    print(f"worst state {state}: {worst.quantity} at {worst.at}, error / tolerance {worst.of_tolerance.value:.2f}")
    report = rttrr_pin.compare_state(robot, state, payload=payload)
    print("kernel   ", report.result.values["tau"][0])
    print("pinocchio", report.comparisons[0].result.values["tau"][0])
