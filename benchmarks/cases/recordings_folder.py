"""Where the real recordings are; they are read in place and never copied."""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).parent.parent.parent


def recordings_folder() -> Path | None:
    """Return the folder that SLIPJUMP_DATA names, or None where it is missing."""
    folder = Path(os.environ.get("SLIPJUMP_DATA", ROOT.parent / "shared" / "data"))
    return folder if folder.is_dir() else None


def indexed(folder: Path) -> list[dict[str, str]]:
    """Return the rows of the folder's index."""
    with (folder / "index.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def base_of(row: Mapping[str, str]) -> str:
    """Return the base with which the workbench begins a recording of the index."""
    return "integrator" if row["integrating"] == "True" else "fopdt"
