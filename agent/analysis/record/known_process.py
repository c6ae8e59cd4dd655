"""What is known of the process and the valve of a loop before a window of it is looked at."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class KnownProcess:
    """A process as other windows of the valve show it."""

    gain: float
    """PV units per OP unit; per OP unit and second where it integrates."""
    tau: float | None
    """s; None: it integrates."""
    delay: float
    """s"""
    log_gain_sd: float
    """Standard deviation of the logarithm of the gain."""


@dataclass(frozen=True, slots=True)
class KnownValve:
    """A valve that sticks, as other windows of it show it, with the process behind it."""

    s: float
    """OP units."""
    process: KnownProcess
    """Its gain may be less sure than that of a process that is known by itself."""
