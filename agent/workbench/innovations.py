"""Whether a larger model makes what is new in a residual smaller.

See ``agent.identify.noise.autoregression``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

from agent.identify.noise.student import student_likelihood

if TYPE_CHECKING:
    from agent.identify.noise.autoregression import Innovations


def likelihood_ratio(smaller: Innovations, larger: Innovations, least: float = 0.0) -> float:
    """Return twice the logarithm of how much likelier a larger model makes the record.

    Innovations have Student's distribution, as in the diagnosis (``agent.identify.noise.student``).

    Args:
        smaller: Of the smaller model.
        larger: Of the larger one.
        least: Mean square below which innovations are rounding.
    """
    known = np.isfinite(smaller.values) & np.isfinite(larger.values)
    before, after = (student_likelihood(each.values[known], least) for each in (smaller, larger))
    return 2.0 * (after - before)


def by_chance(ratio: float, parameters: int, tries: int) -> float:
    """Return how likely the innovations fall as far where nothing is missing.

    Innovations are white, so that here samples are independent and the likelihood ratio has the distribution
    of the books; at a boundary it has less. The search takes the best of many values: each counts as a try.

    Args:
        ratio: As of ``likelihood_ratio``.
        parameters: That the larger model has more.
        tries: Among which it is the best.
    """
    return float(min(1.0, tries * stats.chi2.sf(ratio, parameters)))
