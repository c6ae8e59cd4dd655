"""How much does an effect that is not there seem to explain? Simulated, where no formula holds.

A dead band of zero lies on the end of its range, a rate limit of infinity likewise: there the likelihood
ratio and F do not have the distributions of the books (Protassov et al., Astrophys. J. 571 (2002) 545).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Protocol

DRAWS = 199
"""The smallest p is 1 in 200."""


class Mapper(Protocol):
    """``map``, or that of a pool."""

    def __call__(self, function: Callable[[int], float], seeds: Iterable[int], /) -> Iterable[float]:
        """Return the function of each seed."""
        ...


def simulated_null_p(
    seen: float, statistic: Callable[[int], float], draws: int = DRAWS, mapper: Mapper = map
) -> float:
    """Return how likely the statistic is at least ``seen`` where the effect is not there.

    Args:
        seen: Error without over error with the effect, on the record.
        statistic: The same on a PV that it simulates without the effect from a seed: the model's PV plus
            its residual resampled (``resampling.py``), both models fitted anew. Picklable where the mapper
            is a pool's.
        draws: Simulations.
        mapper: Spreads them.
    """
    as_large = sum(1 for each in mapper(statistic, range(draws)) if each >= seen)
    return (1 + as_large) / (1 + draws)
