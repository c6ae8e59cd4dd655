"""How long it takes after each fault on each bus until data flow again, with the waits that a user gets."""

from __future__ import annotations

import asyncio
import shutil
import tempfile
from pathlib import Path

import pytest

from benchmarks.cases.options import Options
from benchmarks.tables.markdown import table
from tests.faults.matrix import BUSES, LASTS, measured

ALLOWED = 5.0
"""From the peer's return until a window with new data was judged, s (issue 6)."""


def run(_options: Options) -> None:
    """Print a row for each fault, a column for each bus."""
    mosquitto = shutil.which("mosquitto") or "/usr/sbin/mosquitto"
    took: dict[str, dict[str, float]] = {}
    for bus in BUSES:
        with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
            took[bus] = asyncio.run(measured(bus, mosquitto, Path(folder), patch))
    faults = dict.fromkeys(fault for seconds in took.values() for fault in seconds)
    lines = [(fault, *(cell(took[bus].get(fault)) for bus in BUSES)) for fault in faults]
    print(table(f"### Faults of {LASTS:g} s: seconds until data flow again", ("fault", *BUSES), lines))


def cell(seconds: float | None) -> str:
    """Return a time, and whether it is too long."""
    if seconds is None:
        return "-"
    return f"{seconds:.1f}" if seconds <= ALLOWED else f"**{seconds:.1f}**"
