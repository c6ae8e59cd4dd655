"""Two models on the same held-out blocks: whether one makes less error, and how much less.

Neighbouring blocks share slow disturbances, so stretches of blocks are resampled; there are at most
``STRETCHES`` of them in a record.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

STRETCHES = 14
"""So few that all ways to change their signs can be counted."""
CONFIDENCE = 0.9
RESAMPLES = 1999
LEAST_PERCENT = 5.0
"""Smaller reductions of the held-out error are no effect, however significant."""
ROUND_OFF = 1e-12
"""Part of the sum of differences; sums equal but for rounding count as equal."""


@dataclass(frozen=True, slots=True)
class Reduction:
    """How much less error a model makes than another, % of the other's; negative where it makes more."""

    percent: float
    low: float
    """Lower end of the 90 % interval."""
    high: float


def stretches(losses: FloatArray) -> FloatArray:
    """Return the sums (s,) of ``losses`` (b,) over stretches of neighbouring blocks, as many in each."""
    parts = np.array_split(losses, min(STRETCHES, len(losses)))
    return np.array([part.sum() for part in parts])


def sign_flip_p(losses: FloatArray, other: FloatArray) -> float:
    """Return how likely ``other`` (b,) is smaller than ``losses`` (b,) by as much if neither model is better.

    If neither is, the difference of a stretch is as likely positive as negative: p is the part of all
    changes of signs that give at least the observed mean difference. One-sided and exact; an F-test would
    count samples of a coloured residual as independent (Fisher 1935; Protassov et al. 2002).
    """
    differences = stretches(losses - other)
    seen = differences.sum() - ROUND_OFF * np.abs(differences).sum()
    return float(np.mean(_signs(len(differences)) @ differences >= seen))


def reduction(losses: FloatArray, other: FloatArray, rng: np.random.Generator) -> Reduction:
    """Return by how much ``other`` (b,) reduces the sum of ``losses`` (b,), with its bootstrap interval.

    Stretches are drawn with replacement, the same for both models.
    """
    pair = stretches(losses), stretches(other)
    low, high = _interval(pair, _percent, rng)
    return Reduction(float(_percent(*pair)), low, high)


def known_blocks(*losses: FloatArray) -> list[FloatArray]:
    """Return the losses (b,) of several models without the blocks that are NaN for one of them."""
    known = np.all(np.isfinite(losses), axis=0)
    return [each[known] for each in losses]


def lowers_error(losses: FloatArray, other: FloatArray, level: float) -> bool:
    """Return whether ``other`` (b,) reduces the error by as much as counts, and surely.

    ``level``: p of the signs is below it.
    """
    base, new = known_blocks(losses, other)
    found = reduction(base, new, np.random.default_rng(0))
    return found.percent >= LEAST_PERCENT and found.low > 0 and sign_flip_p(base, new) < level


def error_interval(losses: FloatArray, rng: np.random.Generator) -> tuple[float, float]:
    """Return the 90 % interval of the root of the mean of ``losses`` (b,), NaN where a block has none."""
    known = losses[np.isfinite(losses)]
    parts = np.array_split(known, min(STRETCHES, len(known)))
    low, high = _interval((np.array([part.mean() for part in parts]),), np.mean, rng)
    return math.sqrt(low), math.sqrt(high)


def _interval(
    samples: tuple[FloatArray, ...], statistic: Callable[..., FloatArray], rng: np.random.Generator
) -> tuple[float, float]:
    found = stats.bootstrap(
        samples,
        statistic,
        paired=True,
        vectorized=True,
        n_resamples=RESAMPLES,
        confidence_level=CONFIDENCE,
        method="percentile",
        rng=rng,
    ).confidence_interval
    return float(found.low), float(found.high)


def _percent(base: FloatArray, new: FloatArray, axis: int = -1) -> FloatArray:
    return np.asarray(100 * (1 - new.sum(axis=axis) / base.sum(axis=axis)), dtype=np.float64)


@lru_cache(maxsize=4)
def _signs(count: int) -> FloatArray:
    """Return all ways to sign ``count`` numbers, (2**count, count)."""
    bits = np.arange(2**count)[:, np.newaxis] >> np.arange(count) & 1
    return np.asarray(1.0 - 2.0 * bits, dtype=np.float64)
