"""How far apart two results are, as a formula over scalars: what `Comparison.differences` has on arrays, compiled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rttrr_pin.compile.formula import Formula, Sizes
from rttrr_pin.core.arrays import Array, flat
from rttrr_pin.core.model import Model
from rttrr_pin.implementations import Evaluation
from rttrr_pin.implementations.allowance import Carrier

NEEDED = {"f", "n"}
"""What a reference must give, beside `tau_joint`, so that the sizes of its driving forces follow."""


class DifferenceFormula:
    """Errors, sizes and tolerances of two programs, compiled for the shape of a robot."""

    def __init__(self, model: Model, quantities: Sequence[str], carriers: Sequence[Sequence[Carrier]]) -> None:
        self._quantities, self._carriers = tuple(quantities), carriers
        self._counts = {key: model.nv if key == "tau" else len(model.links) for key in (*quantities, *NEEDED)}
        widths = {f"y_{key}": 3 * self._counts[key] for key in sorted(NEEDED.difference(quantities))}
        for key in quantities:
            count = self._counts[key]
            widths |= dict.fromkeys((f"x_{key}", f"y_{key}"), count if key == "tau" else 3 * count)
            widths |= dict.fromkeys((f"a_{key}", f"b_{key}"), count)
        if "tau" in quantities:
            widths["tau_joint"] = model.nv
        rows = sum(self._counts[key] for key in quantities)
        self._inputs = widths
        identity = repr(("differences", self._quantities, carriers))
        self._formula = Formula(
            self._differences, widths, dict.fromkeys(("error", "size", "tolerance"), rows), identity
        )

    def __call__(
        self, subject: Evaluation, reference: Evaluation, allowance: Mapping[str, Array], other: Mapping[str, Array]
    ) -> tuple[Array, Array, Array]:
        """|subject - reference|, |reference| and the sum of both allowances, (rows, N) each."""
        sides = {"x": subject.values, "y": reference.values, "a": allowance, "b": other}
        arrays = {}
        for name in self._inputs:
            side, _, key = name.partition("_")
            x = sides[side][key] if side in sides else reference.tau_joint
            assert x is not None
            arrays[name] = flat(x)
        results = self._formula(len(next(iter(arrays.values()))), arrays)
        return results["error"], results["size"], results["tolerance"]

    def _differences(self, sizes: Sizes, x: Mapping[str, Sequence[Any]]) -> dict[str, list[Any]]:
        lengths = {
            name: [sizes.norm(numbers[k : k + 3]) for k in range(0, len(numbers), 3)]
            for name, numbers in x.items()
            if name[0] == "y" and name != "y_tau"
        }
        out: dict[str, list[Any]] = {"error": [], "size": [], "tolerance": []}
        for key in self._quantities:
            apart = [a - b for a, b in zip(x[f"x_{key}"], x[f"y_{key}"], strict=True)]
            if key == "tau":
                out["error"] += [sizes.size(error) for error in apart]
                for own, parts in zip(x["tau_joint"], self._carriers, strict=True):
                    carried = sum((lengths[f"y_{of}"][link] * weight for weight, of, link in parts), 0.0)
                    out["size"].append(sizes.size(own) + carried)
            else:
                out["error"] += [sizes.norm(apart[k : k + 3]) for k in range(0, len(apart), 3)]
                out["size"] += lengths[f"y_{key}"]
            out["tolerance"] += [a + b for a, b in zip(x[f"a_{key}"], x[f"b_{key}"], strict=True)]
        return out
