"""Recordings of control loops: OP, PV and what else there is, from CSV or Parquet."""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import numpy as np

from connectors.historian import is_gap
from connectors.table import RecordingError, Table, read_table

if TYPE_CHECKING:
    from pathlib import Path

    from connectors.table import Column, FloatArray

__all__ = ["Columns", "RecordedLoop", "RecordingError", "read_recording"]


@dataclass(frozen=True, slots=True)
class Columns:
    """Names of the columns of a recording."""

    time: str = "time"
    op: str = "OP"
    pv: str = "PV"
    sp: str = "SP"
    mv: str = "MV"
    mode: str = "mode"
    ts: float | None = None
    """Sampling time of a recording without a time column, s; None: there is one."""


STANDARD = Columns()


@dataclass(frozen=True, slots=True)
class RecordedLoop:
    """A recording as it stands in the file, on its own times. Arrays have shape (n,)."""

    name: str
    path: Path
    time: FloatArray
    """s UTC, rising; counted from 0 where the file has no time column."""
    op: FloatArray
    """OP units; NaN is a gap here and below."""
    pv: FloatArray
    """PV units."""
    sp: FloatArray | None
    """PV units."""
    mv: FloatArray | None
    """Measured valve position or flow, its own unit."""
    mode: tuple[str, ...] | None
    """As written; empty where it was not recorded."""
    duplicates: int
    """Samples dropped because their timestamp was there already; the first is kept."""


def read_recording(path: Path, columns: Columns = STANDARD) -> RecordedLoop:
    """Read one loop.

    Empty cells, words of a historian and infinite values are gaps, NaN. SP, MV and mode may be absent,
    unless their column was named otherwise than by the standard.

    Raises:
        RecordingError: one line that names the file, the line and what was expected.
    """
    table = read_table(path)
    op = _required(table, columns.op, "--op")
    pv = _required(table, columns.pv, "--pv")
    if not len(table.lines):
        raise RecordingError(f"{path}: has column names but no samples")
    sp = _optional(table, columns.sp, STANDARD.sp, "--sp")
    mv = _optional(table, columns.mv, STANDARD.mv, "--mv")
    mode = _mode(table, columns.mode)
    if columns.ts is None:
        time = _times(table, columns.time)
    else:
        time = columns.ts * np.arange(len(op), dtype=np.float64)
    keep = np.concatenate(([True], np.diff(time) > 0))
    return RecordedLoop(
        name=path.stem,
        path=path,
        time=time[keep],
        op=op[keep],
        pv=pv[keep],
        sp=None if sp is None else sp[keep],
        mv=None if mv is None else mv[keep],
        mode=None if mode is None else tuple(word for word, kept in zip(mode, keep, strict=True) if kept),
        duplicates=int(np.count_nonzero(~keep)),
    )


def _column(table: Table, name: str, option: str) -> Column:
    if name in table.columns:
        return table.columns[name]
    there = ", ".join(ascii(known)[1:-1] for known in table.columns)
    raise RecordingError(
        f"{table.path}, line {table.header}: expected a column {name!r} (or name it by {option}), "
        f"the file has: {there[:200]}"
    )


def _required(table: Table, name: str, option: str) -> FloatArray:
    return _numbers(table, name, _column(table, name, option))


def _optional(table: Table, name: str, standard: str, option: str) -> FloatArray | None:
    if name == standard and name not in table.columns:
        return None
    return _required(table, name, option)


def _numbers(table: Table, name: str, column: Column) -> FloatArray:
    if isinstance(column, np.ndarray):
        numbers = column.copy()
    else:
        numbers = np.array([_number(table, name, row, cell) for row, cell in enumerate(column)], np.float64)
    numbers[~np.isfinite(numbers)] = np.nan
    return numbers


def _number(table: Table, name: str, row: int, cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        if is_gap(cell):
            return math.nan
    raise RecordingError(f"{table.where(row)}: {name} is {_shown(cell)}, expected a number or an empty cell")


def _mode(table: Table, name: str) -> list[str] | None:
    if name == STANDARD.mode and name not in table.columns:
        return None
    column = _column(table, name, "--mode")
    if isinstance(column, np.ndarray):
        return ["" if math.isnan(value) else f"{value:g}" for value in column]
    return [cell.strip() for cell in column]


def _times(table: Table, name: str) -> FloatArray:
    column = _column(table, name, "--time, or give the sampling time by --ts")
    if isinstance(column, np.ndarray):
        times = column
    else:
        read = _seconds if _is_number(column[0]) else _iso_seconds
        times = np.array([read(table, name, row, cell) for row, cell in enumerate(column)], np.float64)
    lost = np.flatnonzero(~np.isfinite(times))
    if lost.size:
        raise RecordingError(
            f"{table.where(int(lost[0]))}: {name} is missing, expected a time for each sample"
        )
    backward = np.flatnonzero(np.diff(times) < 0)
    if backward.size:
        row = int(backward[0]) + 1
        step = times[row - 1] - times[row]
        raise RecordingError(f"{table.where(row)}: {name} runs backward by {step:g} s, expected rising times")
    return times


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _seconds(table: Table, name: str, row: int, cell: str) -> float:
    try:
        return math.nan if is_gap(cell) else float(cell)
    except ValueError:
        raise RecordingError(
            f"{table.where(row)}: {name} is {_shown(cell)}, expected seconds as in the first sample"
        ) from None


def _iso_seconds(table: Table, name: str, row: int, cell: str) -> float:
    try:
        moment = datetime.fromisoformat(cell.strip())
        return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()
    except (ValueError, OverflowError):
        if is_gap(cell):
            return math.nan
    raise RecordingError(
        f"{table.where(row)}: {name} is {_shown(cell)}, expected seconds or an ISO 8601 time"
    )


def _shown(cell: str) -> str:
    """Return the cell short and on one line."""
    return repr(cell if len(cell) <= 40 else cell[:40] + "...")
