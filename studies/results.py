"""Tables of results as files: results.csv, and results.parquet with units and meanings."""

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa  # type: ignore[import-untyped]
import pyarrow.parquet as pq  # type: ignore[import-untyped]

from studies.point import Value
from studies.whole_file import write_whole

CSV = "results.csv"
PARQUET = "results.parquet"


@dataclass(frozen=True)
class Column:
    """A column: its name, its unit (empty for a ratio, a count or a text) and what it means."""

    name: str
    unit: str = ""
    help: str = ""

    @property
    def heading(self) -> str:
        """Name and unit, for people: no unit twice where the name ends with it."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


def write_results(
    folder: Path, rows: Sequence[Mapping[str, Value]], columns: Sequence[Column]
) -> list[Path]:
    """The same of rows; one may lack what it does not have."""
    cells = {column.name: [row.get(column.name) for row in rows] for column in columns}
    return write_columns(folder, cells, columns)


def write_csv(path: Path, rows: Sequence[Mapping[str, Value]], columns: Sequence[Column]) -> Path:
    """A table beside the results, as CSV alone. Returns the file."""
    cells = {column.name: [row.get(column.name) for row in rows] for column in columns}
    write_whole(path, _csv(cells, columns))
    return path


def write_columns(
    folder: Path, cells: Mapping[str, Sequence[Value]], columns: Sequence[Column]
) -> list[Path]:
    """Write both files, each beside its name and renamed; `cells` has those of each column.

    Equal cells give equal bytes. Returns the files.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files = {CSV: _csv(cells, columns), PARQUET: _parquet(cells, columns)}
    written = []
    for name, data in files.items():
        path = folder / name
        write_whole(path, data)
        written.append(path)
    return written


def _csv(cells: Mapping[str, Sequence[Value]], columns: Sequence[Column]) -> bytes:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([column.name for column in columns])
    for row in zip(*(cells[column.name] for column in columns), strict=True):
        writer.writerow(map(_csv_cell, row))
    return text.getvalue().encode()


def _csv_cell(value: Value) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):  # as the program's own files have it
        return "true" if value else "false"
    return repr(value) if isinstance(value, float) else str(value)


def _parquet(cells: Mapping[str, Sequence[Value]], columns: Sequence[Column]) -> bytes:
    arrays = []
    fields = []
    for column in columns:
        values = cells[column.name]
        kind = _kind(values)
        if kind == pa.string():
            values = [None if value is None else _csv_cell(value) for value in values]
        arrays.append(pa.array(values, type=kind))
        metadata = {"unit": column.unit, "help": column.help}
        fields.append(pa.field(column.name, kind, metadata=metadata))
    sink = io.BytesIO()
    pq.write_table(pa.table(arrays, schema=pa.schema(fields)), sink, compression="zstd")
    return sink.getvalue()


def _kind(values: Sequence[Value]) -> pa.DataType:
    """The narrowest type that holds all of a column; text where numbers and texts are mixed."""
    kinds = {type(value) for value in values if value is not None}
    if kinds == {bool}:
        return pa.bool_()
    if kinds == {int}:
        return pa.int64()
    if kinds and kinds <= {int, float}:
        return pa.float64()
    return pa.string()
