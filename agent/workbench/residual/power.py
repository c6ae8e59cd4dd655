"""The smallest effect that could have been confirmed on a record.

The verdict ``none`` means little where the blocks scatter so much that nothing could have been confirmed.
"""

from __future__ import annotations

from bisect import bisect_left
from math import ceil
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.decision import LEAST_PERCENT
from agent.workbench.paired_blocks import reduction, sign_flip_p
from agent.workbench.residual.holm import LEVEL

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

STEPS = range(ceil(LEAST_PERCENT), 101)
"""Reductions that are tried, %."""


def smallest_reduction(
    losses_base: FloatArray, losses: FloatArray, candidates: int, rng: np.random.Generator
) -> float | None:
    """Return the smallest reduction of the held-out error, %, that would have been confirmed.

    Injection and recovery on the blocks: the factor by which the effect changed the error scatters from block
    to block; this scatter is kept, and the mean of the factors is replaced by a reduction of the whole.

    Args:
        losses_base: Squared error of each block without the effect, (b,), > 0.
        losses: With it, (b,).
        candidates: How many were tried: the first step of Holm multiplies p by it.
        rng: Of the bootstrap.

    Returns:
        None where the blocks are too few to confirm anything: not even an effect that explains all.
    """
    known = np.isfinite(losses_base) & np.isfinite(losses) & (losses_base > 0)
    base, other_base = losses_base[known], losses[known]
    scattered = other_base * base.sum() / max(other_base.sum(), np.finfo(float).tiny)

    def confirmed(percent: int) -> bool:
        other = scattered * (1 - percent / 100)
        return candidates * sign_flip_p(base, other) < LEVEL and reduction(base, other, rng).low > 0

    at = bisect_left(STEPS, True, key=confirmed)
    return float(STEPS[at]) if at < len(STEPS) else None
