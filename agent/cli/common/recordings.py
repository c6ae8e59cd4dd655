"""Recordings as arguments of a command, and as windows for the analysis."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from collections.abc import Iterable

    from agent.analysis.record.recording import LoopHints, LoopWindow
    from connectors.recording import RecordedLoop

PANEL = "Columns of the recordings"

SUFFIXES = {".csv", ".parquet"}
"""Of the files of a folder that are recordings."""

Recordings = Annotated[
    list[Path], typer.Argument(metavar="RECORDING...", help="CSV or Parquet files, or folders of them.")
]
Time = Annotated[str, typer.Option("--time", metavar="NAME", help="Time column.", rich_help_panel=PANEL)]
Op = Annotated[str, typer.Option("--op", metavar="NAME", help="Controller output.", rich_help_panel=PANEL)]
Pv = Annotated[str, typer.Option("--pv", metavar="NAME", help="Process variable.", rich_help_panel=PANEL)]
Sp = Annotated[str, typer.Option("--sp", metavar="NAME", help="Set point, if any.", rich_help_panel=PANEL)]
Mv = Annotated[
    str, typer.Option("--mv", metavar="NAME", help="Valve position or flow, if any.", rich_help_panel=PANEL)
]
Mode = Annotated[str, typer.Option("--mode", metavar="NAME", help="Mode, if any.", rich_help_panel=PANEL)]
Ts = Annotated[
    float | None,
    typer.Option(
        "--ts", metavar="SECONDS", help="Sampling time where there is no time column.", rich_help_panel=PANEL
    ),
]


def in_folders(paths: Iterable[Path]) -> list[Path]:
    """Return the files, those of a folder in its place, by name.

    Raises:
        BadParameter: A folder holds no recording.
    """
    files: list[Path] = []
    for path in paths:
        found = [path]
        if path.is_dir():
            found = sorted(each for each in path.iterdir() if each.suffix.lower() in SUFFIXES)
        if not found:
            raise typer.BadParameter(f"{path}: a folder without CSV or Parquet files", param_hint="RECORDING")
        files += found
    return files


def positive(ts: float | None) -> float | None:
    """Return the sampling time of ``--ts``; raises BadParameter unless it is a positive time (s)."""
    if ts is not None and not 0 < ts < float("inf"):
        raise typer.BadParameter(f"{ts:g} is not a positive number of seconds", param_hint="'--ts'")
    return ts


def loop_window(loop: RecordedLoop, hints: LoopHints) -> LoopWindow:
    """Return the whole recording on a uniform grid.

    Raises:
        RecordingError: the times cannot be put on a grid.
    """
    from agent.analysis.record.grid import uniform_grid
    from agent.analysis.record.mode import automatic_share
    from agent.analysis.record.recording import LoopWindow
    from connectors.recording import RecordingError

    columns = {"op": loop.op, "pv": loop.pv}
    if loop.sp is not None:
        columns["sp"] = loop.sp
    if loop.mv is not None:
        columns["mv"] = loop.mv
    if loop.mode is not None:
        columns["automatic"] = automatic_share(loop.mode)
    try:
        grid = uniform_grid(loop.time, columns)
    except ValueError as error:
        raise RecordingError(f"{loop.path}: {error}") from error
    automatic = grid.columns.get("automatic")
    return LoopWindow(
        loop=loop.name,
        start=grid.start,
        ts=grid.ts,
        op=grid.columns["op"],
        pv=grid.columns["pv"],
        sp=grid.columns.get("sp"),
        mv=grid.columns.get("mv"),
        automatic=None if automatic is None else automatic != 0,  # a mode that was not recorded is no manual
        hints=hints,
        duplicates=loop.duplicates + grid.duplicates,
    )
