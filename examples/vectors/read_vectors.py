"""Reads vectors with NumPy alone, and judges a program by them: python read_vectors.py FOLDER (docs/vectors.md)."""

import sys
from pathlib import Path

import numpy as np


def table(path, blocks):
    """Levels and numbers of a table, (blocks, rows, columns); hexadecimal blocks are the last half."""
    with Path(path).open(encoding="utf-8") as file:
        rows = [line.rstrip("\n").split(",") for line in file][1:]
    half = len(rows[0]) // 2 + 1  # two columns are level and state
    numbers = [[*map(float, row[2:half]), *map(float.fromhex, row[half:])] for row in rows]
    return [row[:2] for row in rows], np.array(numbers).reshape(len(rows), blocks, -1).transpose(1, 0, 2)


def program(states):
    """Your own: from q, v, a and payload, (N, columns), to tau, F, N, f, n in the order of the table; here zeros."""
    return 0.0


keys, (decimal, states) = table(f"{sys.argv[1]}/states.csv", 2)
same, (lower_decimal, upper_decimal, lower, upper) = table(f"{sys.argv[1]}/truth.csv", 4)
assert keys == same
difference = abs(lower - lower_decimal).sum() + abs(upper - upper_decimal).sum() + abs(states - decimal).sum()
widest = ((upper - lower) / np.spacing(np.minimum(abs(lower), abs(upper)))).max()
value = program(states)
error = np.maximum(np.maximum(lower - value, value - upper), 0.0).max()
print(f"rows={len(keys)} numbers={lower.size} difference={difference:g} widest={widest:.0f} error={error:.3f}")
