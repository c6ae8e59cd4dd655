"""How much does an effect that is not there seem to explain? Simulated, where no formula holds.

A dead band of zero lies on the end of its range, a rate limit of infinity likewise: there the likelihood
ratio and F do not have the distributions of the books (Protassov et al., Astrophys. J. 571 (2002) 545).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Protocol

DRAWS = 199
"""The smallest p is 1 in 200."""
ENOUGH = 10
"""Draws as large as what was seen after which no further are needed (Besag and Clifford 1991)."""
BATCH = 20
"""Draws between two looks at how many were as large."""


class Mapper(Protocol):
    """``map``, or that of a pool."""

    def __call__(self, function: Callable[[int], float], seeds: Iterable[int], /) -> Iterable[float]:
        """Return the function of each seed."""
        ...


def simulated_null_p(
    seen: float,
    statistic: Callable[[int], float],
    draws: int = DRAWS,
    mapper: Mapper = map,
    enough: int = ENOUGH,
) -> float:
    """Return how likely the statistic is at least ``seen`` where the effect is not there.

    Args:
        seen: Error without over error with the effect, on the record.
        statistic: The same on a PV that it simulates without the effect from a seed: the model's PV plus
            its residual resampled (``resampling.py``), both models fitted anew. Picklable where the mapper
            is a pool's.
        draws: Simulations, at most.
        mapper: Spreads them.
        enough: With so many as large as ``seen`` the question is settled, and fewer are drawn.
    """
    drawn = as_large = 0
    while drawn < draws and as_large < enough:
        seeds = range(drawn, min(drawn + BATCH, draws))
        as_large += sum(1 for each in mapper(statistic, seeds) if each >= seen)
        drawn = seeds.stop
    return (1 + as_large) / (1 + drawn)
