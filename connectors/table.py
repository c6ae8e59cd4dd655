"""A file of named columns, CSV or Parquet: cells as they stand there, with the line each came from."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from connectors.exports.fault import RecordingError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]
    Column = Sequence[str] | FloatArray

DELIMITERS = ",;\t"
PARQUET_MAGIC = b"PAR1"
MEGABYTE = 1 << 20


@dataclass(frozen=True, slots=True)
class Table:
    """Columns of one file, all of the same length."""

    path: Path
    columns: dict[str, Column]
    """Text as it stands in the file, or float64 where the file itself has types (times in s UTC)."""
    lines: Sequence[int]
    """Line of the file (row of a Parquet file) that each row came from, counted from 1."""
    place: str
    """What ``lines`` counts: ``line`` or ``row``."""
    header: int = 1
    """Line that holds the names of the columns."""

    def where(self, row: int) -> str:
        """Return file and line of a row, to open a message with."""
        return f"{self.path}, {self.place} {self.lines[row]}"


def read_table(path: Path) -> Table:
    """Read the columns of ``path``; Parquet is known by its first bytes or its name.

    Raises:
        RecordingError: the file cannot be read or holds no table.
    """
    try:
        with path.open("rb") as file:
            parquet = file.read(len(PARQUET_MAGIC)) == PARQUET_MAGIC or path.suffix == ".parquet"
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read: {error.strerror or error}") from error
    return _read_parquet(path) if parquet else _read_csv(path)


def _read_csv(path: Path) -> Table:
    csv.field_size_limit(MEGABYTE)
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            text = file.read()
    except UnicodeDecodeError as error:
        raise RecordingError(f"{path}: expected CSV text in UTF-8, found other bytes") from error
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read: {error.strerror or error}") from error
    first = next((line for line in text.splitlines() if line.strip()), "")
    if not first:
        raise RecordingError(f"{path}: is empty, expected a line of column names and one line a sample")
    if "\0" in text:
        raise RecordingError(f"{path}: expected CSV text, found a binary file")
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=max(DELIMITERS, key=first.count))
    try:
        return _split(path, reader)
    except csv.Error as error:
        raise RecordingError(f"{path}, line {reader.line_num}: expected CSV, {error}") from error


def _split(path: Path, reader: Any) -> Table:  # noqa: ANN401 - the reader's type has no public name
    names: list[str] = []
    header = 0
    rows: list[list[str]] = []
    lines: list[int] = []
    for cells in reader:
        if not any(cell.strip() for cell in cells):
            continue
        if not names:
            names, header = [cell.strip() for cell in cells], reader.line_num
            continue
        if len(cells) != len(names) and any(cell.strip() for cell in cells[len(names) :]):
            fault = f"{len(cells)} cells, expected {len(names)} (is there a decimal comma?)"
            raise RecordingError(f"{path}, line {reader.line_num}: {fault}")
        if len(cells) < len(names):
            fault = f"{len(cells)} cells, expected {len(names)}: {', '.join(names)}"
            raise RecordingError(f"{path}, line {reader.line_num}: {fault}")
        rows.append(cells)
        lines.append(reader.line_num)
    repeated = {name for name in names if name and names.count(name) > 1}
    if repeated:
        raise RecordingError(f"{path}, line {header}: column {min(repeated)!r} is there twice")
    columns: dict[str, Column] = {name: [row[i] for row in rows] for i, name in enumerate(names) if name}
    return Table(path, columns, lines, "line", header)


def _read_parquet(path: Path) -> Table:
    import pyarrow as pa  # noqa: PLC0415 - heavy, and most recordings are CSV
    import pyarrow.parquet as pq  # noqa: PLC0415

    try:
        with path.open("rb") as file:
            table = pq.read_table(file)
            columns = {name: _parquet_column(table[name]) for name in table.column_names}
    except (pa.ArrowException, OSError) as error:
        first = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise RecordingError(f"{path}: expected a Parquet file: {first}") from error
    return Table(path, columns, range(1, table.num_rows + 1), "row")


def _parquet_column(column: Any) -> Column:  # noqa: ANN401 - pyarrow has no types
    import pyarrow as pa  # noqa: PLC0415

    kind = column.type
    if pa.types.is_timestamp(kind):
        microseconds = column.cast(pa.timestamp("us", tz=kind.tz), safe=False).cast(pa.int64())
        return np.asarray(microseconds.cast(pa.float64(), safe=False).to_numpy(), dtype=np.float64) / 1e6
    if pa.types.is_floating(kind) or pa.types.is_integer(kind) or pa.types.is_decimal(kind):
        return np.array(column.cast(pa.float64(), safe=False).to_numpy(), dtype=np.float64)
    return ["" if cell is None else str(cell) for cell in column.to_pylist()]
