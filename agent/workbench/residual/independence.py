"""Test whether a residual follows earlier OP: their cross-correlation at positive lags, with a band.

At negative lags OP follows the residual: that is the action of the controller (Ljung, System Identification,
2nd ed., 16.6). Where the residual is coloured they correlate at positive lags, too, because the residual
still contains the disturbance that OP responded to. So both are filtered until the residual is white (Box and
Jenkins): its innovations correlate with no earlier OP unless the model is incomplete, and the band is that of
white noise.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

from agent.identify.noise.autoregression import innovations
from agent.workbench.residual.whiteness import CONFIDENCE, LAGS, Correlogram

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


def independence(residual: FloatArray, op: FloatArray, lags: int = LAGS) -> Correlogram | None:
    """Return how the innovations of a residual (n,) correlate with OP (n,) 1 to ``lags`` samples before.

    None where the residual is constant or has too few samples in a row, or OP does not move.
    """
    found = innovations(residual)
    if found is None or np.ptp(op) == 0:
        return None
    new, moves = found.values, found.filtered(op)
    pairs = np.empty(lags)
    correlation = np.empty(lags)
    for k in range(1, lags + 1):
        both = np.isfinite(new[k:]) & np.isfinite(moves[:-k])
        pairs[k - 1] = np.count_nonzero(both)
        correlation[k - 1] = np.corrcoef(new[k:][both], moves[:-k][both])[0, 1]
    band = stats.norm.ppf(0.5 + CONFIDENCE / 2) / np.sqrt(pairs)
    alone = 2 * stats.norm.sf(np.max(np.abs(correlation) * np.sqrt(pairs)))
    return Correlogram(correlation, band, float(min(1.0, lags * alone)))
