"""Which of two loops drives the other: whose past helps to predict the other's future.

A loop passes its own noise on to those that follow it, never the reverse; so its past says more of their
future than theirs of its own (Granger, Econometrica 37 (1969) 424; on plant-wide oscillations Yuan and Qin,
AIChE J. 60 (2014) 4021). The wave itself, which all have in common, is in every past and cancels out.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.processes.decimation import block_means

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import FloatArray

SAMPLES = 25.0
"""Samples of a period, at least, after averaging in blocks."""
ORDER = 12
"""Samples of each past: half a period."""
LEAST = 0.005
"""Gain of a prediction, as a logarithm of variances, that says nothing."""


def drives(signals: Sequence[FloatArray], samples: float) -> FloatArray:
    """Return by how much each signal helps to predict the others, more than they it, in the mean, (signals,).

    Args:
        signals: Control errors of the loops of a group, (n,) each, no gaps.
        samples: Period of their wave.
    """
    block = max(int(samples / SAMPLES), 1)
    rows = [block_means(each, block) for each in signals]
    count = len(rows)
    helps = np.zeros((count, count))
    for j, future in enumerate(rows):
        alone = _error(future, ())
        for i, other in enumerate(rows):
            if i != j:
                helps[i, j] = math.log(max(alone / max(_error(future, (other,)), 1e-300), 1.0))
    ratio = np.log((helps + LEAST) / (helps.T + LEAST))
    return np.asarray(ratio.sum(axis=1) / max(count - 1, 1))


def _error(future: FloatArray, others: Sequence[FloatArray]) -> float:
    """Return the variance that the pasts of a signal and of others leave of it."""
    n = len(future)
    columns = [each[ORDER - lag : n - lag] for each in (future, *others) for lag in range(1, ORDER + 1)]
    past = np.stack([*columns, np.ones(n - ORDER)], axis=1)
    target = future[ORDER:]
    weights, *_ = np.linalg.lstsq(past, target, rcond=None)
    return float(np.mean((target - past @ weights) ** 2))
