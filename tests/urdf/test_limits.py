"""Files that are made to exhaust whoever reads them: an error, or a robot, within two seconds and 500 MB."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

SECONDS, MEGABYTES = 10.0, 500.0
# of processor time, on a machine of any speed and load; here no file takes two

READS = """
import json, sys, time
import rttrr_pin
from rttrr_pin.errors import RttrrError
rttrr_pin.load("rttrr")
def peak():
    (line,) = (line for line in open("/proc/self/status") if line.startswith("VmHWM"))
    return int(line.split()[1]) / 1024
before, started, said = peak(), time.process_time(), "a robot"
try:
    rttrr_pin.load(sys.argv[1])
except RttrrError as error:
    said = str(error)
print(json.dumps([time.process_time() - started, peak() - before, said]))
"""

LINK = '<link name="{0}"/>'
JOINT = '<joint name="j{0}" type="continuous"><parent link="{1}"/><child link="{0}"/><axis xyz="0 0 1"/></joint>'


def robot(inside: str) -> str:
    return f'<robot name="x">{LINK.format("l")}{inside}</robot>'


def chain(count: int) -> str:
    links = "".join(map(LINK.format, range(count)))
    return f'<robot name="x">{links}{"".join(JOINT.format(k, k - 1) for k in range(1, count))}</robot>'


def followers(count: int) -> str:
    mimic = '<mimic joint="j{0}"/></joint>'
    return (
        chain(count)
        .replace("</joint>", "{}")
        .format(*("</joint>" if k == 1 else mimic.format(k - 1) for k in range(1, count)))
    )


FLOODS: dict[str, Callable[[], str]] = {
    "links": lambda: robot("".join(LINK.format(k) for k in range(3_000_000))),
    "links of one name": lambda: robot(LINK.format("a") * 19_000),
    "a chain": lambda: chain(3_300),
    "a star": lambda: robot("".join(LINK.format(k) + JOINT.format(k, "l") for k in range(3_300))),
    "a loop": lambda: chain(3_300).replace('<parent link="0"/>', '<parent link="3299"/>'),
    "followers": lambda: followers(2_500),
    "depth": lambda: robot("<visual>" * 1_000_000),
    "elements of others": lambda: robot(f"<gazebo>{'<a/>' * 4_000_000}</gazebo>"),
    "unknown elements": lambda: robot("".join(f"<lnk{k} name='a'/>" for k in range(9_000))),
    "attributes": lambda: robot("<link name='a' " + " ".join(map("a{}=''".format, range(1_000_000))) + "/>"),
    "a long name": lambda: robot(LINK.format("a" * 9_000_000)),
    "long names": lambda: robot("".join(LINK.format(str(k) * 100_000) for k in range(10, 99))),
    "comments": lambda: robot("<!-- -->" * 3_000_000),
    "instructions": lambda: robot("<?p i?>" * 3_000_000),
    "blanks": lambda: robot(" \n" * 7_000_000),
    "characters": lambda: robot("&#65;" * 3_000_000),
    "text": lambda: robot("x" * 15_000_000),
    "half an element": lambda: "<robot name='x'><link name='" + "a" * 30_000_000,
    "digits": lambda: robot(
        f'<link name="a"><inertial><mass value="1.{"1" * 5_000_000}"/>'
        '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>' + JOINT.format("a", "l")
    ),
    "exponents": lambda: robot(
        '<link name="a"><inertial><mass value="1e999999999"/>'
        '<inertia ixx="1e-999999999" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
    ),
    "entities": lambda: (
        "<!DOCTYPE robot [<!ENTITY a0 'ha'>"
        + "".join(f"<!ENTITY a{k + 1} '{f'&a{k};' * 10}'>" for k in range(12))
        + f"]><robot name='&a12;'>{LINK.format('l')}</robot>"
    ),
    "too many bytes": lambda: robot("<!--" + "x" * 80_000_000 + "-->"),
}


@pytest.mark.slow
@pytest.mark.parametrize("flood", FLOODS)
def test_no_file_takes_long_or_much(flood: str, tmp_path: Path) -> None:
    path = tmp_path / "flood.urdf"
    path.write_text(FLOODS[flood]())
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", READS, str(path)],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-500:]
    seconds, megabytes, said = json.loads(done.stdout)
    assert seconds < SECONDS, (seconds, said[:200])
    assert megabytes < MEGABYTES, (megabytes, said[:200])
    assert len(said) < 2000
