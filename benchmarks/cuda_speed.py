"""Claim: on a GPU a state takes as long as its bytes take through memory, and a small batch as long as a launch.

Run: pip install -e '.[cuda]', then python benchmarks/cuda_speed.py [--save] [--urdf FILE] on a machine with an NVIDIA
GPU; some minutes. (Of the package's other dependencies it needs numpy, llvmlite and lxml alone.) Driving forces,
float64 and float32, rows and columns. Before anything is timed, values are compared with those of this processor's
kernel: a difference larger than both bounds, exit 1.

    ns at 1e6       by the card's events around many launches of one million states; beside it the share of the rate
                    at which the card copies memory
    ns at 256       likewise for 256 states: launches back to back
    us a call       a bound call and its check, and a whole call of the kernel, for 256 states, from Python

`--variants` also times one million states without shared memory and with other blocks, for whoever tunes. `--on-cpu`
goes through all of it with kernels by the C compiler, few states, and times that mean nothing; it saves nothing.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

import rttrr_pin
from common import arguments, finish
from cuda_cards import Card, OnCard, OnCpu, wall
from rttrr_pin import Robot
from rttrr_pin.compile import Kernel, cache
from rttrr_pin.compile.device import DeviceKernel
from rttrr_pin.compile.emit import cuda_text
from rttrr_pin.errors import InputError
from rttrr_pin.validation.sampling import Sampler

sys.path.append(str(Path(__file__).parents[1] / "tests"))

ROBOTS = ("rttrr", "iiwa14", "example:panda", "example:talos_reduced")

SMALL = 256
"""States of the small batch."""

COMPARED = 4096
"""States whose values are compared."""

VARIANTS: dict[str, dict[str, Any]] = {
    "no shared memory": {"SHARED": 0},
    "256 threads": {"BLOCKS": (256, 128, 64, 32)},
    "64 threads": {"BLOCKS": (64, 32)},
}
"""Of `cuda_text`, for those who tune."""


def robot_of(name: str, urdf: str | None) -> Robot:
    """A robot; iiwa14 from its file, or seven joints placed as its own, with inertias drawn at random."""
    if name != "iiwa14":
        return rttrr_pin.load(name)
    return rttrr_pin.load(urdf if urdf else seven_joints())


def seven_joints() -> str:
    """A chain of seven joints that turn by right angles from each to the next, at the distances of iiwa14."""
    from support.serial_chains import inertial

    rng = np.random.default_rng(14)
    right = "1.5707963267948966"
    places = [
        ("0 0 0.1575", "0 0 0"), ("0 0 0.2025", f"{right} 0 3.141592653589793"),
        ("0 0.2045 0", f"{right} 0 3.141592653589793"), ("0 0 0.2155", f"{right} 0 0"),
        ("0 0.1845 0", f"-{right} 3.141592653589793 0"), ("0 0 0.2155", f"{right} 0 0"),
        ("0 0.081 0", f"-{right} 3.141592653589793 0"),
    ]  # fmt: skip
    parts = ['<link name="link_0"/>']
    for k, (xyz, rpy) in enumerate(places, start=1):
        parts.append(f'<link name="link_{k}">{inertial(rng)}</link>')
        parts.append(
            f'<joint name="joint_{k}" type="revolute"><parent link="link_{k - 1}"/><child link="link_{k}"/>'
            f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="0 0 1"/>'
            '<limit lower="-2" upper="2" velocity="2" effort="100"/></joint>'
        )
    return f'<robot name="seven_joints">{"".join(parts)}</robot>'


@contextmanager
def altered(values: dict[str, Any]) -> Iterator[None]:
    """Other constants of `cuda_text` for a while."""
    kept = {name: getattr(cuda_text, name) for name in values}
    vars(cuda_text).update(values)
    try:
        yield
    finally:
        vars(cuda_text).update(kept)


class Measured:
    """One robot in one type.

    Attributes:
        figures: what was found.
    """

    def __init__(self, card: Card, robot: Robot, dtype: str, states: int) -> None:
        self.card, self.robot, self.dtype, self.states = card, robot, dtype, states
        drawn = Sampler(robot.model, "uniform", 0).draw(0, states)
        self.given = [np.asarray(x, dtype) for x in (drawn.q, drawn.v, drawn.a)]
        self.width = sum(x.shape[1] for x in self.given) + robot.model.nv
        self.figures: dict[str, Any] = {}

    def kernel(self, outputs: str | tuple[str, ...] = "tau") -> DeviceKernel:
        """A new kernel."""
        return DeviceKernel(self.robot.model, outputs, dtype=self.dtype, driver=self.card.driver)

    def compare(self) -> bool:
        """Values and bounds of the card and of this processor."""
        outputs = ("tau", "tau_bound")
        first = [x[:COMPARED] for x in self.given]
        shape = (len(first[0]), self.robot.model.nv)
        out = {name: self.card.empty(shape, self.dtype) for name in outputs}
        self.kernel(outputs)(*map(self.card.copied, first), out=out)
        found = {name: self.card.on_host(x, shape, self.dtype) for name, x in out.items()}
        wanted = Kernel[Any](self.robot.model, outputs, dtype=self.dtype)(*first)
        off = np.abs(found["tau"].astype(float) - wanted["tau"])
        allowed = found["tau_bound"].astype(float) + wanted["tau_bound"]
        self.figures["compared"] = {
            "values": int(off.size),
            "other_bits": int((off > 0).sum()),
            "worst_share_of_bounds": float((off / np.maximum(allowed, 1e-300)).max()),
        }
        return bool((off <= allowed).all())

    def measure(self, rate: float) -> None:
        """Times; `rate` is that of a copy, in bytes a second."""
        start = time.perf_counter()
        kernel = self.kernel()
        kernel._variant(())
        self.figures["compile_s"] = round(time.perf_counter() - start, 1)
        self.figures |= self.card.registers(kernel)
        for layout, placed in (("rows", self.card.copied), ("columns", self.card.columns)):
            ns = self.million(kernel, placed)
            share = self.width * self.given[0].itemsize / (ns * 1e-9) / rate
            small = self.small(kernel, placed)
            self.figures[layout] = {"ns_at_1e6": round(ns, 4), "share_of_copy_rate": round(share, 3), **small}

    def million(self, kernel: DeviceKernel, placed: Callable[[np.ndarray], Any]) -> float:
        """Nanoseconds a state of a large batch."""
        launch = kernel.bind(*map(placed, self.given), out=placed(np.empty_like(self.given[1])))
        seconds = self.card.seconds(launch, 50)
        launch.check()
        return seconds / self.states * 1e9

    def small(self, kernel: DeviceKernel, placed: Callable[[np.ndarray], Any]) -> dict[str, float]:
        """A small batch: nanoseconds a state of launches back to back, microseconds of calls from Python."""
        arrays = [placed(x[:SMALL]) for x in self.given]
        out = placed(np.empty_like(self.given[1][:SMALL]))
        launch = kernel.bind(*arrays, out=out)

        def bound() -> None:
            launch()
            launch.check()

        times = 2000 if isinstance(self.card, OnCard) else 3
        return {
            "ns_at_256": round(self.card.seconds(launch, times) / SMALL * 1e9, 2),
            "us_bound_call": round(wall(bound, times) * 1e6, 2),
            "us_whole_call": round(wall(lambda: kernel(*arrays, out=out), times) * 1e6, 2),
        }

    def vary(self) -> None:
        """Other ways through the states, one million of them."""
        for name, values in VARIANTS.items():
            with altered(values):
                kernel = self.kernel()
                self.figures[f"ns_at_1e6 with {name}"] = {
                    layout: round(self.million(kernel, placed), 4)
                    for layout, placed in (("rows", self.card.copied), ("columns", self.card.columns))
                }


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--on-cpu", action="store_true", help="play the card by this processor, with few states")
    parser.add_argument("--variants", action="store_true", help="also time other blocks, and without shared memory")
    parser.add_argument("--urdf", metavar="FILE", help="the URDF of iiwa14; else seven joints placed as its own")
    parser.add_argument("--robots", nargs="+", default=ROBOTS, help="names, or paths of URDF files")
    options = parser.parse_args()
    cache.folder = lambda: None  # compile times are those of compiling
    try:
        card: Card = OnCpu() if options.on_cpu else OnCard()
    except InputError as error:
        print(f"{error}\n`--on-cpu` goes through this script without a GPU.", file=sys.stderr)
        return 1
    rate = card.copy_rate()
    print(f"{card.driver.name}: copies {rate * 1e-9:.0f} GB/s, read and written", file=sys.stderr)
    rows, holds = [], True
    for name in options.robots:
        robot = robot_of(name, options.urdf)
        for dtype in ("float64", "float32"):
            measured = Measured(card, robot, dtype, 300 if options.on_cpu else 1_000_000)
            same = measured.compare()
            holds &= same
            measured.measure(rate)
            if options.variants:
                measured.vary()
            head = {"robot": name, "dtype": dtype, "within_bounds": same}
            if name == "iiwa14":
                head["made"] = "of its file" if options.urdf else "like it"
            rows.append(head | measured.figures)
            print(rows[-1], file=sys.stderr)
    figures = {
        "card": card.driver.name,
        "compiler": card.driver.identity,
        "copy_gb_per_s": round(rate * 1e-9, 1),
        "rows": rows,
    }
    finish("cuda_speed", figures, options.save and not options.on_cpu)
    return int(not holds)


if __name__ == "__main__":
    sys.exit(main())
