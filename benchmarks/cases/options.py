"""What the command line of the benchmarks chooses."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Options:
    """Handed to every benchmark; each takes what concerns it."""

    full: bool = False
    """More loops, repeats and lengths."""
    loops: int | None = None
    """Simulated sticking loops; None takes the usual number."""
    save: Path | None = None
    """File of the simulated cases; None keeps none."""
