"""What a command runs on its way to the verdict: files, functions and classes of ours, and modules loaded.

    python benchmarks/main_path.py [--save]

Each command runs in a process of its own, under a profiler that counts what of the package is entered. A file counts as
executed if a function of it runs after it was imported; a class, if one of its methods does.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

from common import arguments, finish

COMMANDS = {
    "inspect": ["inspect"],
    "validate --states 200": ["validate", "--states", "200"],
    "validate": ["validate"],
    "diagnose --subject pinocchio": ["diagnose", "--subject", "pinocchio"],
    "audit --equation 36": ["audit", "--equation", "36"],
}
"""What a user types, by name."""

TRACED = """
import json, sys, threading
import rttrr_pin.cli as cli
from pathlib import Path

package = str(Path(cli.__file__).parent)
files, functions, classes = set(), set(), set()

def importing(frame):
    while frame is not None and frame.f_code.co_name != "<module>":
        frame = frame.f_back
    return frame is not None and frame.f_code.co_filename.startswith(package)

def enter(frame, event, argument):
    code = frame.f_code
    place = (code.co_filename, code.co_firstlineno)
    if event == "call" and place not in functions and code.co_filename.startswith(package) and not importing(frame):
        files.add(code.co_filename)
        functions.add(place)
        owner = code.co_qualname.rpartition(".")[0]
        if owner and "<locals>" not in owner:
            classes.add((code.co_filename, owner))

sys.setprofile(enter)
threading.setprofile(enter)
code = cli.main(sys.argv[1:])
sys.setprofile(None)
loaded = [name for name in sys.modules if name.split(".")[0] == "rttrr_pin"]
Path({target!r}).write_text(json.dumps({{
    "exit": code, "files": len(files), "functions": len(functions), "classes": len(classes), "modules": len(loaded)
}}))
"""


def traced(words: list[str], folder: Path) -> dict[str, int]:
    """The counts of one command, whose compiled programs are on disk already."""
    target = folder / "counts.json"
    for _ in range(2):
        subprocess.run([sys.executable, "-c", TRACED.format(target=str(target)), *words, "--quiet"], check=True)
    counts: dict[str, int] = json.loads(target.read_text())
    return counts


def main() -> None:
    """Trace every command."""
    options = arguments(__doc__.partition("\n")[0]).parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rows = {name: traced(words, Path(folder)) for name, words in COMMANDS.items()}
    finish("main_path", {"commands": rows}, options.save)


if __name__ == "__main__":
    main()
