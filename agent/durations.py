"""Durations as people say them."""

from __future__ import annotations

UNITS = ((2 * 86400.0, 86400.0, "days"), (2 * 3600.0, 3600.0, "h"), (120.0, 60.0, "min"), (0.0, 1.0, "s"))
"""From the first number (s) on they are printed in units of the second, named by the third."""


def duration_words(seconds: float) -> str:
    """Return a duration, at least 0 s, with its unit, e.g. ``12 s``, ``3.5 h``."""
    scale, unit = next((scale, unit) for least, scale, unit in UNITS if seconds >= least)
    return f"{seconds / scale:.3g} {unit}"
