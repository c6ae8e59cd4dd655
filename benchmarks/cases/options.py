"""Options of the command line of the benchmarks."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Options:
    """Passed to every benchmark; each uses those that concern it."""

    full: bool = False
    """More loops, repeats and lengths."""
    loops: int | None = None
    """Simulated sticking loops; None takes the usual number."""
    save: Path | None = None
    """File of the simulated cases; None keeps none."""
    seconds: float | None = None
    """How long it is measured where that can be chosen, s; None takes the usual time."""
