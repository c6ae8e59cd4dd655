"""Test whether a residual is white: its autocorrelation, with a band.

The residual of a free run is not white where the noise is not, so this test alone does not judge the model;
the test for a missing effect is ``independence.py`` (Ljung, System Identification, 2nd ed., 16.6).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

from agent.analysis.oscillation.acf_zero_crossings import autocorrelation

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

LAGS = 25
CONFIDENCE = 0.99
"""Of the band at each lag, as is usual with residuals."""


@dataclass(frozen=True, slots=True)
class Correlogram:
    """Correlations at lags 1 to K."""

    correlation: FloatArray
    """(K,)."""
    band: FloatArray
    """Where nothing correlates, a correlation is within plus or minus this in 99 of 100 lags, (K,)."""
    p: float
    """Probability that all lags together show as much by chance."""


def whiteness(residual: FloatArray, lags: int = LAGS) -> Correlogram | None:
    """Return the autocorrelation of a residual (n,), NaN where there is none; p by Ljung and Box (1978).

    None where it is constant or shorter than twice the lags.
    """
    found = autocorrelation(residual - np.nanmean(residual))
    if found is None or len(found.r) <= lags:
        return None
    correlation, pairs = found.r[1 : lags + 1], found.pairs[1 : lags + 1]
    samples = found.pairs[0]
    statistic = samples * (samples + 2) * float(np.sum(correlation**2 / pairs))
    band = stats.norm.ppf(0.5 + CONFIDENCE / 2) / np.sqrt(pairs)
    return Correlogram(correlation, band, float(stats.chi2.sf(statistic, lags)))
