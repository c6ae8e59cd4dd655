"""Where the real recordings are; they are read in place and never copied."""

from __future__ import annotations

import os
from pathlib import Path

ROOT = Path(__file__).parent.parent


def recordings_folder() -> Path | None:
    """Return the folder that SLIPJUMP_DATA names, or None where it is missing."""
    folder = Path(os.environ.get("SLIPJUMP_DATA", ROOT.parent / "shared" / "data"))
    return folder if folder.is_dir() else None
