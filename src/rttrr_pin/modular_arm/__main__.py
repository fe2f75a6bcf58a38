"""`python -m rttrr_pin.modular_arm urdf` writes the bundled files."""

from __future__ import annotations

import argparse
from pathlib import Path

from rttrr_pin.modular_arm.readme import write_all

parser = argparse.ArgumentParser(description="Writes the bundled files, and the tables in the directory's README.md.")
parser.add_argument("directory", type=Path, help="where to write, such as urdf")
for written in write_all(parser.parse_args().directory):
    print(written)
