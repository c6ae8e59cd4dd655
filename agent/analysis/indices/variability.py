"""Variability of PV: two standard deviations over the mean."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow

LEAST_MEAN = 0.01
"""|mean| of PV over its span below which a ratio to the mean says nothing: a level around zero."""


@dataclass(frozen=True, slots=True)
class Variability:
    """100 x 2 sigma / |mean| (W. L. Bialkowski, Pulp and Paper Canada 93(11), 1992)."""

    name: str = "variability"
    unit: str = "%"
    meaning: str = "two standard deviations of PV over its mean"

    def of(self, window: LoopWindow, delay: float | None) -> float | None:
        """Return the variability, %; None where PV is near zero."""
        del delay
        pv = window.pv[np.isfinite(window.pv)]
        if pv.size < 2 or abs(pv.mean()) <= LEAST_MEAN * np.ptp(pv):
            return None
        return float(200 * pv.std() / abs(pv.mean()))
