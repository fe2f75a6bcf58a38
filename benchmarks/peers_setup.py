"""Make the environments of kernel_speed.py and conform/run.py, as benchmarks/peers/requirements.toml lists them.

Run: python benchmarks/peers_setup.py [--envs FOLDER] [--only NAME ...]. What fails is told, and the rest goes on;
exit 1 if something failed. They need about 10 GB together, and the peers gcc and g++ for those that are compiled.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import venv
from collections.abc import Sequence
from pathlib import Path

from peers_run import ENVIRONMENTS, environments, python_of


def main() -> int:
    wanted = environments()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--envs", type=Path, default=ENVIRONMENTS, help="folder of the environments")
    parser.add_argument("--only", nargs="+", choices=wanted, default=list(wanted), metavar="NAME")
    parser.add_argument("--timeout", type=float, default=900.0, help="for one installation [s]")
    chosen = parser.parse_args()
    failed = {}
    for name in chosen.only:
        print(f"{name}: pip install {' '.join(wanted[name])} ...", file=sys.stderr, flush=True)
        problem = install(chosen.envs / name, wanted[name], chosen.timeout)
        if problem:
            failed[name] = problem
        print(f"{name}: {'failed' if problem else 'ready'}", file=sys.stderr, flush=True)
    for name, problem in failed.items():
        print(f"\n{name} cannot be installed, and its peers will be left out:\n{problem}", file=sys.stderr)
    return int(bool(failed))


def install(folder: Path, packages: Sequence[str], timeout: float) -> str:
    """Make an environment and fill it; "" if that worked, else what pip said last."""
    try:
        if not python_of(folder).exists():
            venv.create(folder, with_pip=True)
        command = [str(python_of(folder)), "-m", "pip", "install", "-q", *packages]
        done = subprocess.run(command, capture_output=True, text=True, timeout=timeout)
    except subprocess.TimeoutExpired:
        return f"pip took longer than {timeout:.0f} s: try again, or raise --timeout"
    except (OSError, subprocess.CalledProcessError) as error:
        return f"the environment cannot be made: {error}"
    said = [line for line in done.stderr.splitlines() if not line.startswith(("WARNING", "["))]
    return "" if done.returncode == 0 else "\n".join(said[-8:]) or f"pip ended with {done.returncode}"


if __name__ == "__main__":
    sys.exit(main())
