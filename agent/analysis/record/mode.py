"""Which words of a controller's mode mean that the loop was closed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import FloatArray

MANUAL_WORDS = frozenset(
    {
        "0",
        "hand",
        "iman",
        "init",
        "initman",
        "lo",
        "m",
        "man",
        "manual",
        "manuale",
        "manuel",
        "manuell",
        "o/s",
        "off",
        "oos",
        "out",
        "rout",
        "shutdown",
    }
)
"""Lower case. Everything else counts as automatic: makers have their own words for cascade and program."""


def automatic_share(modes: Sequence[str]) -> FloatArray:
    """Return 1 where the mode is automatic, 0 where manual and NaN where it was not recorded, shape (n,)."""
    words = [mode.strip().casefold() for mode in modes]
    return np.array([np.nan if not word else float(word not in MANUAL_WORDS) for word in words], np.float64)
