"""A Parquet file as columns, within a bound that its own header cannot raise."""

from __future__ import annotations

import weakref
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from connectors.exports.fault import LONGEST_CELL, MOST_CELLS, MOST_COLUMNS, MOST_ROWS, RecordingError
from connectors.exports.tables.sheet import Column, Sheet

if TYPE_CHECKING:
    from pathlib import Path

    from connectors.exports.tables.sheet import FloatArray

MAGIC = b"PAR1"
BATCH = 1 << 20
"""Cells that are unpacked at a time."""
MOST_TEXT = 1 << 30
"""Bytes of text of a file, each cell counted, however often one is the same."""
MOST_UNPACKED = 8 * MOST_CELLS + MOST_TEXT
"""Bytes of a file, unpacked: numbers, and some text."""

TEXT_CELL = 64
"""Bytes that a text takes in memory beside its letters."""


def is_parquet(path: Path, head: bytes) -> bool:
    """Return whether a file is Parquet by its first bytes or by its name."""
    return head.startswith(MAGIC) or path.suffix.lower() in {".parquet", ".pq"}


def sheet_of_parquet(path: Path, content: IO[bytes]) -> Sheet:
    """Return the columns of a Parquet file; each is read when it is needed.

    Raises:
        RecordingError: It is no Parquet file, or has more rows or columns than are read.
    """
    import pyarrow as pa  # noqa: PLC0415 - heavy, and most recordings are CSV
    import pyarrow.parquet as pq  # noqa: PLC0415

    try:
        texts = [each.name for each in pq.read_schema(content) if _is_text(each.type)]
        file = pq.ParquetFile(content, read_dictionary=texts)
        rows, names = file.metadata.num_rows, file.schema_arrow.names
        _bounded(path, rows, len(names))
        stated = sum(file.metadata.row_group(k).total_byte_size for k in range(file.num_row_groups))
        if stated > MOST_UNPACKED:
            raise _too_large(path, MOST_UNPACKED)
        rows = _checked(path, file)
        found = tuple(_column(file, k) for k in range(len(names)))
    except (pa.ArrowException, OSError, ValueError) as error:
        first = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise RecordingError(f"{path}: expected a Parquet file: {first}") from error
    if not rows:
        raise RecordingError(f"{path}: has column names but no samples")
    weakref.finalize(file, content.close)
    return Sheet(path, found, range(1, rows + 1), "row", 1, "parquet")


def _bounded(path: Path, rows: int, columns: int) -> None:
    if rows > MOST_ROWS or columns > MOST_COLUMNS or rows * columns > MOST_CELLS:
        raise RecordingError(
            f"{path}: has {rows} rows of {columns} columns, at most {MOST_ROWS} rows and {MOST_CELLS} cells "
            "are read: split it by time or by loop"
        )


def _checked(path: Path, file: Any) -> int:  # noqa: ANN401 - pyarrow has no types
    """Unpack the file piece by piece, return its rows; stop where there is more than the header states."""
    import pyarrow as pa  # noqa: PLC0415

    rows, size, text = 0, 0, 0
    width = len(file.schema_arrow.names)
    for batch in file.iter_batches(batch_size=max(BATCH // max(width, 1), 1)):
        rows += batch.num_rows
        for name, column in zip(batch.schema.names, batch.columns, strict=True):
            _refuse_long_cells(path, name, column)
            cells = _size_as_cells(column)
            size += cells
            text += cells if pa.types.is_dictionary(column.type) else 0
        if rows > MOST_ROWS or size > MOST_UNPACKED or text > MOST_TEXT:
            raise _too_large(path, MOST_TEXT if text > MOST_TEXT else MOST_UNPACKED)
    return rows


def _too_large(path: Path, limit: int) -> RecordingError:
    return RecordingError(f"{path}: unpacks to more than {limit >> 20} MiB: split it by time or by loop")


def _is_text(kind: Any) -> bool:  # noqa: ANN401 - pyarrow has no types
    import pyarrow as pa  # noqa: PLC0415

    return bool(pa.types.is_string(kind) or pa.types.is_large_string(kind) or pa.types.is_dictionary(kind))


def _refuse_long_cells(path: Path, name: str, column: Any) -> None:  # noqa: ANN401 - pyarrow has no types
    import pyarrow as pa  # noqa: PLC0415
    import pyarrow.compute as pc  # noqa: PLC0415

    if not pa.types.is_dictionary(column.type):
        return
    longest = pc.max(pc.utf8_length(column.dictionary.cast(pa.large_string()))).as_py() or 0
    if longest > LONGEST_CELL:
        raise RecordingError(
            f"{path}: {name} has a cell of {longest} characters, at most {LONGEST_CELL} are read"
        )


def _texts(column: Any) -> list[str]:  # noqa: ANN401 - pyarrow has no types
    """Return the cells of a column of text; a text that comes often is held once."""
    cells: list[str] = []
    for chunk in column.chunks:
        words = ["" if each is None else str(each).strip() for each in chunk.dictionary.to_pylist()]
        words.append("")  # of a missing cell
        cells += [words[k] for k in chunk.indices.fill_null(len(words) - 1).to_pylist()]
    return cells


def _size_as_cells(column: Any) -> int:  # noqa: ANN401 - pyarrow has no types
    """Return the bytes of a column as cells; the file may hold a long text once for millions of rows."""
    import pyarrow as pa  # noqa: PLC0415
    import pyarrow.compute as pc  # noqa: PLC0415

    kind = column.type
    if pa.types.is_dictionary(kind):
        words = column.dictionary.cast(pa.large_string())
        text = pc.sum(pc.take(pc.binary_length(words), column.indices)).as_py() or 0
        return int(text) + TEXT_CELL * len(column)
    if pa.types.is_nested(kind):
        raise ValueError(f"numbers, times or text belong in each column, not {kind}")
    number = pa.types.is_primitive(kind) or pa.types.is_decimal(kind) or pa.types.is_null(kind)
    return int(column.nbytes) + (0 if number else TEXT_CELL * len(column))


def _column(file: Any, place: int) -> Column:  # noqa: ANN401 - pyarrow has no types
    """Return a column of a file that stays open as long as one of its columns is there."""
    import pyarrow as pa  # noqa: PLC0415

    field = file.schema_arrow.field(place)
    name, kind = field.name.strip(), field.type

    def read() -> Any:  # noqa: ANN401 - pyarrow has no types
        there = file.read(columns=[field.name], use_threads=False)  # and those of which it is a part
        same = [k for k, each in enumerate(file.schema_arrow.names) if each == field.name].index(place)
        return there.column([k for k, each in enumerate(there.column_names) if each == field.name][same])

    if pa.types.is_timestamp(kind) or pa.types.is_date(kind):
        zone = getattr(kind, "tz", None)
        return Column(name, lambda: _seconds(read(), zone), moments=True, local=zone is None)
    if pa.types.is_floating(kind) or pa.types.is_integer(kind) or pa.types.is_decimal(kind):
        return Column(name, lambda: _numbers(read()))
    if _is_text(kind):
        return Column(name, lambda: _texts(read()))
    return Column(name, lambda: ["" if cell is None else str(cell).strip() for cell in read().to_pylist()])


def _seconds(column: Any, zone: str | None) -> FloatArray:  # noqa: ANN401 - pyarrow has no types
    import pyarrow as pa  # noqa: PLC0415

    moments = column.cast(pa.timestamp("us", tz=zone), safe=False).cast(pa.int64())
    return np.asarray(moments.cast(pa.float64(), safe=False).to_numpy(), dtype=np.float64) / 1e6


def _numbers(column: Any) -> FloatArray:  # noqa: ANN401 - pyarrow has no types
    import pyarrow as pa  # noqa: PLC0415

    return np.array(column.cast(pa.float64(), safe=False).to_numpy(), dtype=np.float64)
