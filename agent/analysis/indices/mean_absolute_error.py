"""Integral of the absolute control error over the time it was taken: IAE a second."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow


@dataclass(frozen=True, slots=True)
class MeanAbsoluteError:
    """IAE / T = mean |SP - PV| (ISA-TR5.9; Haegglund 1995 integrates it between zero crossings)."""

    name: str = "mean_absolute_error"
    unit: str = "PV"
    meaning: str = "mean distance of PV from the set point: the integral of the absolute error over its time"

    def of(self, window: LoopWindow, delay: float | None) -> float | None:
        """Return the mean absolute error, PV units; None without a set point."""
        del delay
        if window.sp is None:
            return None
        error = np.abs(window.error)
        known = error[np.isfinite(error)]
        return float(known.mean()) if known.size else None
