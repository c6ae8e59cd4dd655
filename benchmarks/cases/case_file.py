"""Cases in a CSV file: it shows single loops, and a stopped run continues from it."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from dataclasses import asdict, fields
from pathlib import Path

from pyarrow import csv as arrow_csv

from benchmarks.cases.case import Case

COLUMNS = [field.name for field in fields(Case)]


def read_cases(path: Path) -> list[Case]:
    """Return the cases of a file; none where it does not exist.

    Raises:
        ValueError: The file has other columns; it was written by another version.
    """
    if not path.exists():
        return []
    table = arrow_csv.read_csv(path)
    if table.column_names != COLUMNS:
        raise ValueError(f"{path}: columns are not those of this version; give another file")
    return [Case(**(row | {"failure": row["failure"] or None})) for row in table.to_pylist()]


def append_cases(path: Path, cases: Iterable[Case]) -> None:
    """Write cases to the end of a file, which gets its header first."""
    fresh = not path.exists()
    with path.open("a", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        if fresh:
            writer.writeheader()
        writer.writerows(asdict(case) for case in cases)
