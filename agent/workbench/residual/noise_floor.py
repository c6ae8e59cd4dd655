"""The lowest error that a model can reach, as an interval: slow noise may look like a missing effect.

A flexible regression from OP to PV cannot be used: in closed loop OP contains the disturbance, and such a
model fits below the true noise. Source: reference ``missing_effect.md`` 2.5 and section 4, step 9.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

from agent.analysis.record.signals import noise_level
from agent.identify.noise.autoregression import innovations
from agent.workbench.paired_blocks import CONFIDENCE, error_interval

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


LOST_TO_DIFFERENCES = 35 / 18
"""Samples for one degree of freedom of a variance from second differences (Gasser, Sroka and
Jennen-Steinmetz, Biometrika 73 (1986) 625)."""


@dataclass(frozen=True, slots=True)
class NoiseFloor:
    """Interval of the least error that a model of the loop can reach, RMSE, PV units."""

    low: float
    """White part of the residual, which no model can follow; lower end of its own interval."""
    high: float
    """Held-out error that a model has reached; upper end of its own interval."""


def noise_floor(residual: FloatArray, losses: FloatArray, rng: np.random.Generator) -> NoiseFloor:
    """Return the interval of the noise floor.

    Args:
        residual: Of the richest model that the record confirms or suggests, PV units, (n,), NaN where there
            is none. The smaller of two estimates counts: its innovations, and white noise that would
            explain its second differences (Rice 1984), which slow noise hardly affects.
        losses: Mean squared error of each held-out block of that model, (b,), NaN where there is none.
        rng: Of the bootstrap over blocks behind the upper end.
    """
    found = innovations(residual)
    rice = noise_level(residual)
    white = rice if found is None else min(rice, float(np.sqrt(found.variance)))
    freedom = np.count_nonzero(np.isfinite(residual)) / LOST_TO_DIFFERENCES
    low = (
        white * float(np.sqrt(freedom / stats.chi2.ppf(0.5 + CONFIDENCE / 2, freedom))) if white > 0 else 0.0
    )
    return NoiseFloor(low, max(low, error_interval(losses, rng)[1]))
