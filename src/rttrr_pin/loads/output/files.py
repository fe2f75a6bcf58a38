"""The files that a run writes row by row, all of them whole or not at all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

import numpy as np

from rttrr_pin.core.conventions import Convention
from rttrr_pin.core.model import Model
from rttrr_pin.errors import UnknownNameError
from rttrr_pin.loads.evaluation import Values
from rttrr_pin.loads.output import wrench_stamped
from rttrr_pin.loads.output.tables import WRITERS, CsvWriter, Opener, ParquetWriter, Writer
from rttrr_pin.loads.quantities import CROSSING, ERROR, TIME, Field, field, with_error, written
from rttrr_pin.reporting.files import whole_file
from rttrr_pin.trajectories import Block

ROS: Mapping[str, Opener] = {
    ".csv": CsvWriter,
    ".parquet": ParquetWriter,
    ".mcap": wrench_stamped.BagWriter,
}
"""What writes messages, by the end of the file's name."""


def opener(option: str, path: Path, openers: Mapping[str, Opener]) -> Opener:
    """What writes a file with this end of its name.

    Raises:
        UnknownNameError: nothing does.
    """
    if path.suffix.lower() not in openers:
        raise UnknownNameError(f"kind of {option}", path.suffix or path.name, openers, f"in {path}")
    return openers[path.suffix.lower()]


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is to be written.

    Attributes:
        output: the table of quantities; None for none.
        wrench_stamped: the table or bag of messages; None for none.
        asked: the quantities, as `compute_loads` takes them.
        convention: of f and n; None for this package's.
        banded: whether there are half widths of bands.
        about: what else is to be said in files.
    """

    output: Path | None
    wrench_stamped: Path | None
    asked: tuple[str, ...]
    convention: Convention | None
    banded: bool
    about: Mapping[str, str]

    @property
    def quantities(self) -> tuple[str, ...]:
        """By the names of their arrays."""
        return written(self.asked, self.convention)

    @property
    def crossing(self) -> tuple[str, ...]:
        """What messages are made of."""
        return written(CROSSING, self.convention)

    @property
    def paths(self) -> tuple[Path, ...]:
        """Of all files."""
        return tuple(path for path in (self.output, self.wrench_stamped) if path is not None)


class Outputs:
    """Open files; leaving it puts them in their places, or, where something was raised, leaves nothing."""

    def __init__(self, model: Model, wanted: Wanted) -> None:
        self._model, self._wanted = model, wanted
        own = [field(name, model) for name in wanted.quantities]
        errors = [with_error(one) for one in own if one.name != "energy"] if wanted.banded else []
        self._fields: list[Field] = [TIME, *own, *errors]
        self._stack = ExitStack()
        self._table: Writer | None = None
        self._messages: Writer | None = None

    def __enter__(self) -> Outputs:
        with ExitStack() as stack:
            table, messages = self._wanted.output, self._wanted.wrench_stamped
            if table is not None:
                self._table = self._opened(stack, table, opener("output", table, WRITERS), self._fields)
            if messages is not None:
                how = opener("wrench_stamped", messages, ROS)
                self._messages = self._opened(stack, messages, how, wrench_stamped.FIELDS)
            self._stack = stack.pop_all()
        return self

    def _opened(self, stack: ExitStack, path: Path, how: Opener, fields: Sequence[Field]) -> Writer:
        own = stack.enter_context(whole_file(path))
        return stack.enter_context(how(own, path, fields, self._wanted.about))

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.__exit__(kind, error, trace)

    def write(self, rows: Block, values: Values, half_widths: Values | None) -> None:
        """Rows more, with what was computed of them."""
        if self._table is not None:
            arrays = {"time": rows.time, **values}
            for own in self._fields:
                if own.name.endswith(ERROR):
                    name = own.name.removesuffix(ERROR)
                    arrays[own.name] = np.zeros_like(values[name]) if half_widths is None else half_widths[name]
            self._table.write(arrays)
        if self._messages is not None:
            force, torque = (values[name] for name in self._wanted.crossing)
            self._messages.write(wrench_stamped.messages(self._model, rows, force, torque))
