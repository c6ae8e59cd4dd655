"""A Parquet file as columns, within a bound that its own header cannot raise."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from connectors.exports.fault import LONGEST_CELL, MOST_CELLS, MOST_COLUMNS, MOST_ROWS, RecordingError
from connectors.exports.tables.sheet import Column, Sheet

if TYPE_CHECKING:
    from pathlib import Path

MAGIC = b"PAR1"
BATCH = 65536
"""Rows that are unpacked at a time."""
MOST_UNPACKED = 8 * MOST_CELLS + (1 << 28)
"""Bytes of a file, unpacked: numbers, and some text."""

TEXT_CELL = 64
"""Bytes that a text takes in memory beside its letters."""


def is_parquet(path: Path, head: bytes) -> bool:
    """Return whether a file is Parquet by its first bytes or by its name."""
    return head.startswith(MAGIC) or path.suffix.lower() in {".parquet", ".pq"}


def sheet_of_parquet(path: Path, content: bytes) -> Sheet:
    """Return the columns of a Parquet file.

    Raises:
        RecordingError: It is no Parquet file, or has more rows or columns than are read.
    """
    import pyarrow as pa  # noqa: PLC0415 - heavy, and most recordings are CSV
    import pyarrow.parquet as pq  # noqa: PLC0415

    try:
        texts = [each.name for each in pq.read_schema(pa.BufferReader(content)) if _is_text(each.type)]
        with pq.ParquetFile(pa.BufferReader(content), read_dictionary=texts) as file:
            rows, columns = file.metadata.num_rows, file.schema_arrow.names
            _bounded(path, rows, len(columns))
            stated = sum(file.metadata.row_group(k).total_byte_size for k in range(file.num_row_groups))
            if stated > MOST_UNPACKED:
                raise _too_large(path)
            table = pa.Table.from_batches(_batches(path, file), schema=file.schema_arrow)
        found = tuple(_column(name, table[k]) for k, name in enumerate(table.column_names))
    except (pa.ArrowException, OSError, ValueError) as error:
        first = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise RecordingError(f"{path}: expected a Parquet file: {first}") from error
    if not table.num_rows:
        raise RecordingError(f"{path}: has column names but no samples")
    return Sheet(path, found, range(1, table.num_rows + 1), "row", 1, "parquet")


def _bounded(path: Path, rows: int, columns: int) -> None:
    if rows > MOST_ROWS or columns > MOST_COLUMNS or rows * columns > MOST_CELLS:
        raise RecordingError(
            f"{path}: has {rows} rows of {columns} columns, at most {MOST_ROWS} rows and {MOST_CELLS} cells "
            "are read: split it by time or by loop"
        )


def _batches(path: Path, file: Any) -> list[Any]:  # noqa: ANN401 - pyarrow has no types
    """Unpack the file piece by piece; stop where there is more than the header states, or much text."""
    batches, rows, size = [], 0, 0
    for batch in file.iter_batches(batch_size=BATCH):
        rows += batch.num_rows
        for name, column in zip(batch.schema.names, batch.columns, strict=True):
            _refuse_long_cells(path, name, column)
            size += _size_as_cells(column)
        if rows > MOST_ROWS or size > MOST_UNPACKED:
            raise _too_large(path)
        batches.append(batch)
    return batches


def _too_large(path: Path) -> RecordingError:
    return RecordingError(
        f"{path}: unpacks to more than {MOST_UNPACKED >> 20} MiB: split it by time or by loop"
    )


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


def _column(name: str, column: Any) -> Column:  # noqa: ANN401 - pyarrow has no types
    import pyarrow as pa  # noqa: PLC0415

    kind = column.type
    if pa.types.is_timestamp(kind) or pa.types.is_date(kind):
        zone = getattr(kind, "tz", None)
        moments = column.cast(pa.timestamp("us", tz=zone), safe=False).cast(pa.int64())
        seconds = np.asarray(moments.cast(pa.float64(), safe=False).to_numpy(), dtype=np.float64) / 1e6
        return Column(name.strip(), seconds, moments=True, local=zone is None)
    if pa.types.is_floating(kind) or pa.types.is_integer(kind) or pa.types.is_decimal(kind):
        return Column(
            name.strip(), np.array(column.cast(pa.float64(), safe=False).to_numpy(), dtype=np.float64)
        )
    if pa.types.is_dictionary(kind):
        return Column(name.strip(), _texts(column))
    return Column(name.strip(), ["" if cell is None else str(cell).strip() for cell in column.to_pylist()])
