"""A control loop as a file has it, and what a user states about the file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from connectors.exports.cells.times import TimeOptions

if TYPE_CHECKING:
    from pathlib import Path

    from connectors.exports.cells.number_style import Mark
    from connectors.exports.stored_loops import StoredLoops
    from connectors.exports.tables.sheet import FloatArray


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
class ReadOptions:
    """What a user states about a file; what is not stated is recognised."""

    columns: Columns = STANDARD
    times: TimeOptions = field(default_factory=TimeOptions)
    decimal: Mark | None = None
    """Decimal mark of the numbers."""
    pattern: str | None = None
    """How a tag is made of its loop and role, such as ``{loop}.{role}``."""
    loops: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    """Loop -> role -> column or tag; empty: recognised."""
    span: tuple[float, float] | None = None
    """What is read: from, and up to but without, s UTC; None: all."""
    modes: Mapping[str, bool] = field(default_factory=dict)
    """Words of the controller's mode beside those that are known -> whether they mean automatic."""


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
    tags: Mapping[str, str] = field(default_factory=dict)
    """Role (OP, PV, SP, MV, mode) -> column or tag that it was read from."""
    bad: int = 0
    """Values that are no number, or whose quality forbids their use; each is a gap."""
    modes: Mapping[str, bool] = field(default_factory=dict)
    """As ``ReadOptions.modes``."""
    problems: tuple[str, ...] = ()
    """What was left out of its file or may be wrong there, a line each."""


@dataclass(frozen=True, slots=True)
class Export:
    """All that was understood of a file."""

    path: Path
    format: str
    """plain, wide, interleaved or long."""
    kind: str
    """csv, xlsx, parquet or matlab."""
    zone: str
    """Of the times in the file; empty for a count from an unknown start."""
    time_form: str
    """How times are written: calendar, seconds, epoch_ms, excel ..."""
    decimal: str
    """Decimal mark."""
    loops: StoredLoops[RecordedLoop]
    problems: tuple[str, ...] = ()
    """What was left out or may be wrong, a line each."""
