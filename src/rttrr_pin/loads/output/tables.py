"""Tables of loads: CSV, Parquet, NPZ, each with its units, written block by block."""

from __future__ import annotations

import io
import json
import shutil
import tempfile
import zipfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.errors import ImplementationError
from rttrr_pin.loads.quantities import Field
from rttrr_pin.reporting.files import writing

Arrays = Mapping[str, NDArray[Any]]
"""By name of a field, (N, *shape)."""

AT_ONCE = 2**22
"""Numbers of a row group of Parquet, about: 32 MiB."""


class Writer(Protocol):
    """What writes blocks of arrays to a file; leaving it ends the file."""

    def write(self, arrays: Arrays) -> None:
        """Rows more."""

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


Opener = Callable[[Path, Path, Sequence[Field], Mapping[str, str]], Writer]
"""From the file to write, what it is called in messages, its fields, and what else is to be said in it."""


class CsvWriter:
    """A header with the units in brackets, and numbers that are read back bit by bit."""

    def __init__(self, path: Path, shown: Path, fields: Sequence[Field], about: Mapping[str, str]) -> None:
        self._shown, self._fields = shown, fields
        names = [f"{name} [{unit}]" if unit else name for own in fields for name, unit in _columns(own)]
        with writing(shown):
            self._file: IO[str] = path.open("w", encoding="utf-8", errors="backslashreplace", newline="")
            self._file.write(",".join(map(_quoted, names)) + "\n")

    def write(self, arrays: Arrays) -> None:
        """Rows more."""
        columns = [_texts(x) for own in self._fields for x in split(own, arrays[own.name])]
        with writing(self._shown):
            self._file.writelines(f"{','.join(row)}\n" for row in zip(*columns, strict=True))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        with writing(self._shown):
            self._file.close()


class ParquetWriter:
    """A column for each number, with its unit in the metadata of its field."""

    def __init__(self, path: Path, shown: Path, fields: Sequence[Field], about: Mapping[str, str]) -> None:
        pyarrow = imported_pyarrow()
        from pyarrow import parquet

        columns = [
            pyarrow.field(
                name,
                getattr(pyarrow, "float64" if own.kind == "float" else own.kind)(),
                nullable=False,
                metadata={"unit": unit} if unit else None,
            )
            for own in fields
            for name, unit in _columns(own)
        ]
        self._schema = pyarrow.schema(columns, metadata=dict(about))
        self._pyarrow, self._shown, self._fields = pyarrow, shown, fields
        text = [name for own in fields if own.kind == "string" for name in own.columns]
        self._waiting: list[Any] = []
        self._numbers = 0
        with writing(shown):
            self._file = parquet.ParquetWriter(path, self._schema, use_dictionary=text, compression="none")

    def write(self, arrays: Arrays) -> None:
        """Rows more; they are written when there are enough for a row group."""
        columns = [x for own in self._fields for x in split(own, arrays[own.name])]
        parts = [self._pyarrow.array(x, field.type) for x, field in zip(columns, self._schema, strict=True)]
        self._waiting.append(self._pyarrow.record_batch(parts, schema=self._schema))
        self._numbers += len(columns) * len(columns[0])
        if self._numbers >= AT_ONCE:
            self._flush()

    def _flush(self) -> None:
        if self._waiting:
            with writing(self._shown):
                self._file.write_table(self._pyarrow.Table.from_batches(self._waiting, self._schema))
        self._waiting, self._numbers = [], 0

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            self._flush()
        with writing(self._shown):
            self._file.close()


class NpzWriter:
    """An array for each quantity, (N, ...); beside them the names of columns, and units."""

    def __init__(self, path: Path, shown: Path, fields: Sequence[Field], about: Mapping[str, str]) -> None:
        self._path, self._shown, self._fields, self._about = path, shown, fields, about
        self._rows = 0
        with writing(shown):  # beside the file, where there is room for it
            self._raw = [tempfile.TemporaryFile(dir=path.parent) for _ in fields]  # noqa: SIM115

    def write(self, arrays: Arrays) -> None:
        """Rows more."""
        with writing(self._shown):
            for own, raw in zip(self._fields, self._raw, strict=True):
                raw.write(np.ascontiguousarray(arrays[own.name], np.float64).data)
        self._rows += len(arrays[self._fields[0].name])

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        try:
            if kind is None:
                with writing(self._shown), zipfile.ZipFile(self._path, "w", allowZip64=True) as archive:
                    self._pack(archive)
        finally:
            for raw in self._raw:
                raw.close()

    def _pack(self, archive: zipfile.ZipFile) -> None:
        for own, raw in zip(self._fields, self._raw, strict=True):
            raw.seek(0)
            header = {"descr": "<f8", "fortran_order": False, "shape": (self._rows, *own.shape)}
            with archive.open(zipfile.ZipInfo(f"{own.name}.npy"), "w", force_zip64=True) as member:
                np.lib.format.write_array_header_2_0(member, header)
                shutil.copyfileobj(raw, member, 2**20)
        columns = {own.name: list(zip(own.columns, own.units, strict=True)) for own in self._fields}
        about = json.dumps({"columns": columns, **self._about})
        text = io.BytesIO()
        np.save(text, np.array(about))
        archive.writestr(zipfile.ZipInfo("about.npy"), text.getvalue())


WRITERS: Mapping[str, Opener] = {".csv": CsvWriter, ".parquet": ParquetWriter, ".npz": NpzWriter}
"""By the end of the file's name."""


def split(own: Field, x: NDArray[Any]) -> list[NDArray[Any]]:
    """The columns of an array, (N, *shape), each (N,)."""
    return list(x.reshape(len(x), own.width).T)


def imported_pyarrow() -> Any:
    """The library that writes Parquet.

    Raises:
        ImplementationError: it is not installed.
    """
    try:
        import pyarrow
    except ImportError as error:
        raise ImplementationError(
            "a Parquet file needs pyarrow, which is not installed: pip install 'rttrr-pin[parquet]'"
        ) from error
    return pyarrow


def _columns(own: Field) -> list[tuple[str, str]]:
    return list(zip(own.columns, own.units, strict=True))


def _texts(x: NDArray[Any]) -> list[str]:
    """The shortest decimals that are read back as the same numbers; texts as CSV has them."""
    values = x.tolist()
    if x.dtype.kind in "OU":
        quoted = {value: _quoted(value) for value in set(values)}
        return [quoted[value] for value in values]
    return [repr(value) for value in values]


def _quoted(text: str) -> str:
    """A cell of CSV, in quotation marks where it needs them."""
    return '"' + text.replace('"', '""') + '"' if {*text} & {*',"\r\n'} else text
