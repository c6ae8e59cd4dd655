"""Windows of interest: a list with their ids, and one as a recording."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Protocol

import typer

if TYPE_CHECKING:
    from pathlib import Path

    from agent.runtime.store.kept_window import KeptWindow, ListedWindow

NAMES = {"op": "OP", "pv": "PV", "sp": "SP", "mv": "MV"}
"""Columns of a recording, after the time."""
MODES = {1.0: "AUTO", 0.0: "MAN"}
HALF_A_MICROSECOND = 5e-7
"""To this a database keeps times, s."""


class Windows(Protocol):
    """Where windows lie: the agent's file, or the database."""

    def windows(
        self, loop: str | None = None, since: float | None = None, limit: int | None = None
    ) -> tuple[ListedWindow, ...]:
        """Return the newest ``limit`` windows, the oldest first."""
        ...

    def window(self, loop: str, start: float, before: float) -> KeptWindow | None:
        """Return the newest window of a loop that ended from ``start`` to before ``before``, s UTC."""
        ...


def show_windows(windows: Sequence[ListedWindow], *, as_json: bool) -> None:
    """Print what is kept: id, length and sampling time."""
    if as_json:
        for each in windows:
            row = {"window": each.id, "loop": each.loop, "start": each.start, "time": each.end}
            typer.echo(json.dumps(row | {"ts": each.ts, "samples": each.samples}))
        return
    from rich.console import Console
    from rich.table import Table

    table = Table("window", "samples", "every", box=None, padding=(0, 2, 0, 0))
    for each in windows:
        table.add_row(each.id, str(each.samples), f"{each.ts:g} s")
    Console(soft_wrap=True).print(table)


def write_window(windows: Windows, named: str, path: Path) -> None:
    """Write the window of an id as CSV that every command reads; raises ConfigError where it is not there."""
    from connectors.base import ConfigError

    loop, _, text = named.rpartition("@")
    try:
        time = datetime.fromisoformat(text)
    except ValueError as error:
        expected = "is not the id of a window, such as FIC101@2026-11-22T06:00:00Z"
        raise typer.BadParameter(f"{named!r} {expected}", param_hint="'--window'") from error
    end = (time.replace(tzinfo=UTC) if time.tzinfo is None else time).timestamp()
    width = HALF_A_MICROSECOND if time.microsecond else 1.0
    found = windows.window(loop, end - HALF_A_MICROSECOND, end + width)
    if found is None:
        raise ConfigError([f"no window {named} is kept (slipjump history --windows lists what is)"])
    try:
        write_recording(path, found)
    except OSError as error:
        raise ConfigError([f"{path}: {error.strerror}"]) from error


def write_recording(path: Path, window: KeptWindow) -> None:
    """Write time (ISO 8601, UTC), OP, PV and what else is there; a gap is an empty cell. Raises OSError."""
    there = {name: column for name, column in NAMES.items() if name in window.columns}
    mode = window.columns.get("automatic")
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        table.writerow(["time", *there.values(), *([] if mode is None else ["mode"])])
        for k in range(len(window)):
            time = datetime.fromtimestamp(window.start + k * window.ts, UTC).isoformat()
            cells = [cell(float(window.columns[name][k])) for name in there]
            table.writerow([time, *cells, *([] if mode is None else [MODES[float(mode[k])]])])


def cell(value: float) -> str:
    """Return a 32-bit value as a cell from which the same value is read; a gap is empty."""
    return "" if math.isnan(value) else f"{value:.9g}"
