"""Quantiles of a number that is one of several normal ones, each with its probability."""

from __future__ import annotations

import math
from statistics import NormalDist
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence

CLOSE = 1e-4
"""A quantile is as good as exact."""


class Normal(NamedTuple):
    """A part of a mixture."""

    share: float
    """Its probability; those of all parts add up to one."""
    mean: float
    """May be minus infinity: below everything."""
    variance: float


def quantile(parts: Sequence[Normal], probability: float) -> float:
    """Return below what the number is with a probability; minus infinity where no lower one is known."""
    nothing = sum(each.share for each in parts if each.mean == -math.inf)
    if nothing >= probability:
        return -math.inf
    known = [each for each in parts if each.mean > -math.inf]
    z = NormalDist().inv_cdf((probability - nothing) / (1 - nothing))
    ends = [each.mean + z * math.sqrt(each.variance) for each in known]
    low, high = min(ends), max(ends)
    while high - low > CLOSE:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if below(known, middle) < probability - nothing else (low, middle)
    return 0.5 * (low + high)


def below(parts: Sequence[Normal], value: float) -> float:
    """Return the probability that the number is below a value."""
    away = ((share, (mean - value) / math.sqrt(2 * variance)) for share, mean, variance in parts)
    return sum(0.5 * share * math.erfc(each) for share, each in away)
