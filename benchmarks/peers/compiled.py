"""C and C++ compiled for this processor and loaded; what was compiled stays in the peer's environment."""

from __future__ import annotations

import ctypes
import hashlib
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.ctypeslib import ndpointer

FLAGS = ("-O3", "-march=native", "-fopenmp", "-fPIC", "-shared")
"""No -ffast-math: results are those of IEEE arithmetic."""

ROWS = ndpointer(dtype=np.float64, flags="C_CONTIGUOUS")


def build(source: str, options: Sequence[str] = (), compiler: str = "gcc") -> ctypes.CDLL:
    """Compile a program and load it.

    Args:
        source: C or C++.
        options: include folders, libraries.
        compiler: gcc or g++.

    Raises:
        SystemExit: the compiler is missing, or refuses the source.
    """
    command = [compiler, *FLAGS]
    key = hashlib.sha256("\0".join([_processor(), *command, *options, source]).encode()).hexdigest()[:16]
    library = Path(sys.prefix, "compiled-peers", f"{key}.so")
    if not library.exists():
        library.parent.mkdir(exist_ok=True)
        with tempfile.TemporaryDirectory(dir=library.parent) as folder:
            file, made = Path(folder, "peer.c" if compiler == "gcc" else "peer.cpp"), Path(folder, "peer.so")
            file.write_text(source)
            _compile([*command, str(file), "-o", str(made), *options, "-lm"])
            made.replace(library)
    return ctypes.CDLL(str(library))


def _compile(command: Sequence[str]) -> None:
    try:
        subprocess.run(command, check=True, capture_output=True, text=True)
    except FileNotFoundError:
        raise SystemExit(f"{command[0]} is not installed, and this peer is compiled on the spot") from None
    except subprocess.CalledProcessError as error:
        raise SystemExit(f"{command[0]} refuses the peer's source: {error.stderr.strip()[-2000:]}") from error


def _processor() -> str:
    """What -march=native stands for here."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    return next((line for line in lines if line.startswith("flags")), "")
