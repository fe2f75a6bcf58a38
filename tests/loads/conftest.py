"""A robot that all tests of loads share, so that its kernels are compiled once."""

from __future__ import annotations

import pytest

from rttrr_pin import Robot, load
from support.trees import random_tree


@pytest.fixture(scope="session")
def tree() -> Robot:
    """Floating, planar, revolute and prismatic joints, two of which follow others."""
    return load(random_tree(16, 5))
