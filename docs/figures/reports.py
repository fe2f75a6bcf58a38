"""Takes docs/figures/report_validate.png and report_loads.png: reports in Chromium, as docs/reports.md shows them.

Run: python docs/figures/reports.py. Needs the extra browser, and Chromium.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from rttrr_pin import load
from rttrr_pin.urdf.catalogue import bundled

FOLDER = Path(__file__).parent

WRONG = """
from rttrr_pin import load
arm = load("rttrr")

def port(q, v, a):
    tau = arm.inverse_dynamics(q, v, a).tau.copy()
    tau[..., 3] *= 1.0 + 1e-9 * abs(v[..., 3])
    return tau
"""

COMMANDS = {
    "report_validate": (
        ["validate", "--subject", "port:port", "--reference", "kernel", "--states", "2000"],
        1130,
        False,
    ),
    "report_loads": (["loads", "arm.urdf", "motion.csv"], 1130, True),
}
"""By picture: the command, the height of what is shown, whether in the dark."""


def write_inputs(folder: Path) -> None:
    """A program with a small error, an arm with low limits, and a noisy motion of it."""
    (folder / "port.py").write_text(WRONG)
    text = re.sub(r'effort="[^"]*"', 'effort="110"', bundled()["rttrr"].read_text())
    (folder / "arm.urdf").write_text(re.sub(r'velocity="[^"]*"', 'velocity="2.5"', text))
    model, rng, t = load("rttrr").model, np.random.default_rng(1), np.arange(1200) / 100.0
    columns = [t]
    for k, joint in enumerate(model.moving):
        low, high = max(joint.limits.lower, -1.5), min(joint.limits.upper, 1.5)
        swing = 0.3 * (high - low) * np.sin((1.2 + 0.3 * k) * t + k)
        columns.append((low + high) / 2 + swing + 2e-3 * (high - low) * rng.normal(size=len(t)))
    header = ",".join(["time", *(f"q_{name}" for name in model.joint_names)])
    np.savetxt(folder / "motion.csv", np.column_stack(columns), delimiter=",", header=header, comments="", fmt="%.7g")


def main() -> None:
    """Run the commands, and take a picture of the top of each page."""
    from playwright.sync_api import sync_playwright

    program = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))))
    with tempfile.TemporaryDirectory() as name, sync_playwright() as playwright:
        folder = Path(name)
        write_inputs(folder)
        browser = playwright.chromium.launch(executable_path=program)
        for picture, (words, height, dark) in COMMANDS.items():
            page_file = folder / f"{picture}.html"
            command = [sys.executable, "-m", "rttrr_pin", *words, "--quiet", "--html", str(page_file)]
            subprocess.run(command, cwd=folder, check=False)
            scheme = "dark" if dark else "light"
            page = browser.new_page(viewport={"width": 900, "height": height}, color_scheme=scheme)  # type: ignore[arg-type]
            page.goto(page_file.as_uri())
            page.screenshot(path=FOLDER / f"{picture}.png")
        browser.close()


if __name__ == "__main__":
    main()
