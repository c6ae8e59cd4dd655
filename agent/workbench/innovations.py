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


def lowers_innovations(
    smaller: Innovations, larger: Innovations, parameters: int, least: float = 0.0
) -> bool:
    """Return whether a larger model lowers the innovations of its residual by more than its size would.

    In closed loop this distinguishes a better model from one that answers to the disturbance. OP holds the
    controller's reaction to it, so that a wrong effect can lower the free-run error below that of the true
    model, as a dead band does that hides the small moves of OP. But no effect that is not there lowers the
    innovations (Ljung, System Identification, 2nd ed., 13.4), but for chance: Schwarz's criterion.

    Args:
        smaller: Of the smaller model.
        larger: Of the larger one.
        parameters: That it has more. 0: it need only be no worse.
        least: As in ``likelihood_ratio``.
    """
    count = np.count_nonzero(np.isfinite(smaller.values))
    return bool(likelihood_ratio(smaller, larger, least) >= parameters * np.log(count))


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
