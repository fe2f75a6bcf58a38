"""Why links differ: a slip made in one of two files is told, of the right file; anything else is not."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest

from rttrr_pin.conformance import level_robots
from rttrr_pin.diagnosis import Comparison, compare_robots

ARM = level_robots()["arm6"].read_text()
AT = ARM.index('<link name="link_3">')


def altered(pattern: str, change: Callable[[re.Match[str]], str]) -> str:
    """The arm, another number in its third link."""
    return ARM[:AT] + re.sub(pattern, change, ARM[AT:], count=1)


def compared(a: str, b: str) -> Comparison:
    return compare_robots(a, b, n_states=5)


@pytest.mark.parametrize("which", ["first", "second"])
def test_a_rotation_that_one_file_lacks_is_told_of_that_file(which: str) -> None:
    lacking = altered(r'rpy="[^"]*"', lambda found: 'rpy="0 0 0"')
    both = (lacking, ARM) if which == "first" else (ARM, lacking)
    (reason,) = compared(*both).reasons
    assert reason == f"in the {which}, the tensor of link_3 is not turned by the rpy of its inertial frame"


def test_what_is_its_own_opposite_is_told_of_either() -> None:
    iyz = altered(r'ixy="[^"]*" ixz="[^"]*" iyy="[^"]*" iyz="[^"]*"', lambda found: products_negated(found[0]))
    (reason,) = compared(ARM, iyz).reasons
    assert reason == "in one of them, the products of inertia of link_3 have the opposite sign"


def products_negated(text: str) -> str:
    return re.sub(r'(ixy|ixz|iyz)="(-?)([^"]*)"', lambda own: f'{own[1]}="{"" if own[2] else "-"}{own[3]}"', text)


def test_digits_that_were_printed_are_no_obstacle() -> None:
    lacking = altered(r'rpy="[^"]*"', lambda found: 'rpy="0 0 0"')
    rounded = re.sub(r'i(xx|yy|zz)="([^"]*)"', lambda own: f'i{own[1]}="{float(own[2]) * (1 + 2e-6):.9g}"', lacking)
    assert [own for own in compared(ARM, rounded).reasons if "link_3" in own]


def test_any_other_number_has_no_reason() -> None:
    heavier = altered(r'<mass value="([^"]*)"', lambda found: f'<mass value="{1.02 * float(found[1])}"')
    both = re.sub(r'rpy="[^"]*"', 'rpy="0 0 0"', heavier[AT:], count=1)
    for other in (heavier, ARM[:AT] + both):
        assert not compared(ARM, other).passed
        assert not compared(ARM, other).reasons
    assert not compared(ARM, ARM).reasons
