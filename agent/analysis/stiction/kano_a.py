"""How long the stem stands while OP moves.

Source: M. Kano, H. Maruta, H. Kugemoto and K. Shimizu, "Practical model and detection algorithm for valve
stiction", IFAC DYCOPS 2004, method A; reconstructed from reference ``methods.md`` 3.4, which
gives the limit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.analysis.results import MethodKind, MethodResult, Oscillation
from agent.analysis.stiction.shapes.stem import stem_of
from agent.analysis.stiction.shapes.stuck import stuck_intervals

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow

STICKS = 0.25
"""Part of the time stuck, above which the valve sticks."""
FREE = 0.1
"""Part below which it does not (ours)."""


@dataclass(frozen=True, slots=True)
class KanoA:
    """For loops with a measured valve position."""

    name: str = "kano_a"
    kind: MethodKind = "travel"

    def detect(self, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
        """Judge the part of the time in which the stem is stuck, which is the index."""
        if window.mv is None:
            return MethodResult("not_applicable", None, "no valve position is measured")
        stem = stem_of(window, oscillation)
        seen = stem if isinstance(stem, str) else stuck_intervals(stem)
        if isinstance(seen, str):
            return MethodResult("not_applicable", None, seen)
        found = f"the stem does not move for {seen.share:.0%} of the time while OP moves"
        if seen.share > STICKS:
            return MethodResult("stiction", seen.share, found, seen)
        return MethodResult("no_stiction" if seen.share < FREE else "undecided", seen.share, found, seen)
