"""How well a signal is predicted by what followed when it looked like now."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray


@kernel
def prediction_error(x: FloatArray, cycle: int, neighbours: int) -> float:
    """Return the sum of squared errors of predicting ``x`` (n,) one cycle ahead, square of its unit.

    Each stretch of one cycle is compared with all others that begin more than a cycle away; the prediction is
    the mean of what followed the nearest ones (Thornhill 2005; reference ``methods.md`` 3.12).

    Args:
        x: Signal without gaps.
        cycle: Samples in a cycle: length of a stretch, horizon, and least distance in time.
        neighbours: How many nearest stretches are averaged.

    Raises:
        ValueError: ``x`` is too short for each stretch to have that many others.
    """
    ahead = 2 * cycle - 1
    count = x.size - ahead
    if count < 2 * cycle + 2 * neighbours:
        raise ValueError("too few stretches")
    distance = np.full((count, neighbours), np.inf)
    followed = np.zeros((count, neighbours))
    for lag in range(cycle + 1, count):
        squared = 0.0
        for t in range(cycle - 1):
            squared += (x[t] - x[t + lag]) ** 2
        for first in range(count - lag):
            # From one pair of stretches to the next with the same lag one sample comes and one goes.
            second = first + lag
            squared += (x[first + cycle - 1] - x[second + cycle - 1]) ** 2
            for one, other in ((first, second), (second, first)):
                if squared < distance[one, neighbours - 1]:
                    place = neighbours - 1
                    while place > 0 and distance[one, place - 1] > squared:
                        distance[one, place] = distance[one, place - 1]
                        followed[one, place] = followed[one, place - 1]
                        place -= 1
                    distance[one, place] = squared
                    followed[one, place] = x[other + ahead]
            squared -= (x[first] - x[second]) ** 2
    total = 0.0
    for t in range(count):
        total += (np.sum(followed[t]) / neighbours - x[t + ahead]) ** 2
    return total
