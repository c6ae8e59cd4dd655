"""Recordings as arguments of a command, and as windows for the analysis."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from agent.cli.common.errors import complain

if TYPE_CHECKING:
    from collections.abc import Iterable

PANEL = "Columns of the recordings"

SUFFIXES = {".csv", ".mat", ".parquet", ".pq", ".tsv", ".xlsx", ".xls", ".xlsm", ".ods", ".gz", ".zip"}
"""Of the files of a folder that are recordings."""
MAYBE = {".txt", ".dat", ".asc", ".prn"}
"""Of files that may be recordings or notes: they are named, and read where they are given by name."""


class Bus(StrEnum):
    """Buses with servers for recorded and simulated loops."""

    OPCUA = "opcua"
    MODBUS = "modbus"
    MQTT = "mqtt"


Recordings = Annotated[
    list[Path],
    typer.Argument(metavar="RECORDING...", help="CSV, Parquet, Excel or MAT-files, or folders of them."),
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
Loop = Annotated[
    str | None,
    typer.Option("--loop", metavar="NAME", help="Which loop of a file with several.", rich_help_panel=PANEL),
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
            inside = sorted(path.iterdir())
            found = [each for each in inside if each.suffix.lower() in SUFFIXES]
            others = [each.name for each in inside if each.suffix.lower() in MAYBE]
            if others:
                complain(f"{path}: not read unless you name them: {', '.join(others)}")
        if not found:
            raise typer.BadParameter(
                f"{path}: a folder without recordings (CSV, Parquet, Excel, MAT)", param_hint="RECORDING"
            )
        files += found
    return files


def positive(ts: float | None) -> float | None:
    """Return the sampling time of ``--ts``; raises BadParameter unless it is a positive time (s)."""
    if ts is not None and not 0 < ts < float("inf"):
        raise typer.BadParameter(f"{ts:g} is not a positive number of seconds", param_hint="'--ts'")
    return ts
