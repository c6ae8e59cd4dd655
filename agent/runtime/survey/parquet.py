"""The results of a survey as a Parquet file, a row a loop, written piece by piece."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from agent.report.flat import ColumnType, column_type, flat, standard_columns

if TYPE_CHECKING:
    import pyarrow as pa

ROWS = 1000
"""Of one piece: they are in memory together."""


def write_parquet(path: Path, rows: Callable[[], Iterator[Mapping[str, Any]]]) -> int:
    """Write the rows; the file is there whole or not at all. Return how many they are.

    Args:
        path: Of the file.
        rows: Gives the results, nested as ``diagnose --json`` prints them; called twice.

    Raises:
        OSError: It cannot be written.
    """
    import pyarrow as pa  # noqa: PLC0415 - heavy
    import pyarrow.parquet as pq  # noqa: PLC0415

    columns = standard_columns()
    for row in rows():
        columns |= {name: column_type(name) for name in flat(row) if name not in columns}
    schema = pa.schema([(name, _arrow(kind)) for name, kind in columns.items()])
    count = 0
    part = path.with_name(f"{path.name}.part")
    with pq.ParquetWriter(part, schema) as writer:
        coming = rows()
        while piece := list(islice(coming, ROWS)):
            full = [{**dict.fromkeys(columns), **flat(row)} for row in piece]
            writer.write_table(pa.Table.from_pylist(full, schema=schema))
            count += len(full)
    part.replace(path)
    return count


def _arrow(kind: ColumnType) -> pa.DataType:
    import pyarrow as pa  # noqa: PLC0415 - heavy

    match kind:
        case "number":
            return pa.float64()
        case "truth":
            return pa.bool_()
        case "text":
            return pa.string()
        case "texts":
            return pa.list_(pa.string())
        case "numbers":
            return pa.list_(pa.float64())
        case "shares":
            return pa.list_(pa.struct([("cause", pa.string()), ("share", pa.float64())]))
