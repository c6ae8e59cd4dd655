"""How much the valve is moved and how often the loop crosses its set point, an hour."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.indices.index import HOUR
from agent.analysis.record.reversals import noise_hides_reversals, significant_reversals

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow


def hours(window: LoopWindow) -> float:
    """Return the length of a window, hours."""
    return len(window) * window.ts / HOUR


@dataclass(frozen=True, slots=True)
class Travel:
    """Sum of |change of the valve| an hour; of MV where it is measured, else of OP (ISA-75.25 counts it)."""

    name: str = "travel"
    unit: str = "OP/h"
    meaning: str = "way of the valve an hour: what wears packing and actuator"

    def of(self, window: LoopWindow, delay: float | None) -> float | None:
        """Return the travel, OP units an hour."""
        del delay
        steps = np.abs(np.diff(window.op))
        known = steps[np.isfinite(steps)]
        return float(known.sum() / (known.size * window.ts / HOUR)) if known.size else None


@dataclass(frozen=True, slots=True)
class Reversals:
    """Reversals of OP that its noise does not explain, an hour."""

    name: str = "reversals"
    unit: str = "1/h"
    meaning: str = "reversals of OP an hour, those of its noise left out"

    def of(self, window: LoopWindow, delay: float | None) -> float | None:
        """Return the reversals an hour; None where noise may hide them, as at few samples a period."""
        del delay
        known = np.count_nonzero(np.isfinite(window.op)) > 2 and not noise_hides_reversals(window.op)
        return significant_reversals(window.op) / hours(window) if known else None


@dataclass(frozen=True, slots=True)
class SetPointCrossings:
    """Changes of the sign of SP - PV, an hour."""

    name: str = "set_point_crossings"
    unit: str = "1/h"
    meaning: str = "how often PV crosses its set point an hour: rarely in a sluggish loop, often in noise"

    def of(self, window: LoopWindow, delay: float | None) -> float | None:
        """Return the crossings an hour; None without a set point."""
        del delay
        if window.sp is None:
            return None
        signs = np.sign(window.error[np.isfinite(window.error)])
        signs = signs[signs != 0]
        return float(np.count_nonzero(np.diff(signs))) / hours(window) if signs.size > 1 else None
