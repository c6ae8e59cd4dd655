"""When the stem stands while OP moves.

Source: M. Kano, H. Maruta, H. Kugemoto and K. Shimizu, "Practical model and detection algorithm for valve
stiction", IFAC DYCOPS 2004; reconstructed from reference ``methods.md`` 3.4. There the stem stands while it
moves by less than a limit from sample to sample; here while it stays within a band of that width, because
noise breaks the former and a slow stem passes it.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.analysis.stiction.shapes.stem import Stem

NOISE = 6.0
"""Width of the band in standard deviations of the noise: three to each side."""
LEAST_BAND = 0.02
"""Least width of the band over the span of the stem: backlash of a sound positioner."""
WIDEST_BAND = 0.25
"""Width over the span from which there is too much noise: a sine is in such a band for 2/3 of its time."""
MAD = 0.6745
"""Median of the absolute value of a standard normal number."""
FREE = 2.0
"""OP moves if it would move a free stem by this many bands."""


@dataclass(frozen=True, slots=True)
class StuckIntervals:
    """What the detectors of Kano measured."""

    stem: Stem
    intervals: tuple[slice, ...]
    """Samples of ``stem`` in which it stands while OP moves."""
    band: float
    """What the stem may move while it stands, unit of the stem."""
    move: float
    """What OP must move meanwhile, OP units."""

    @property
    def share(self) -> float:
        """Part of the time in which the stem is stuck."""
        return sum(int(each.stop - each.start) for each in self.intervals) / len(self.stem.op)


def stuck_intervals(stem: Stem) -> StuckIntervals | str:
    """Return when the stem is stuck, or the reason if noise hides it."""
    op_span, span = float(np.ptp(stem.op)), float(np.ptp(stem.position))
    band = max(LEAST_BAND * span, NOISE * noise_of_stem(stem))
    if band > WIDEST_BAND * span:
        return "too much noise on the position to detect when the stem stands"
    move = FREE * band / span * op_span
    stands = standing(stem.position, band)
    stuck = tuple(each for each in stands if np.ptp(stem.op[each]) >= move)
    return StuckIntervals(stem, stuck, band, move)


def noise_of_stem(stem: Stem) -> float:
    """Return the standard deviation of the noise on the stem's position, in its unit.

    Taken from second differences, a mean's width apart so that their noise is independent; their median does
    not see the few jumps of a sticking stem. A free stem follows the noise of OP, so what OP's own explain is
    taken off where that leaves less.
    """
    of_op, of_stem = (_bends(values, stem.width) for values in (stem.op, stem.position))
    power = float(np.sum(of_op**2))
    free = of_stem - (float(np.sum(of_op * of_stem)) / power if power > 0 else 0.0) * of_op
    return min(float(np.median(np.abs(bends))) for bends in (of_stem, free)) / (MAD * sqrt(6))


def _bends(values: FloatArray, width: int) -> FloatArray:
    return values[2 * width :] - 2 * values[width:-width] + values[: -2 * width]


def standing(position: FloatArray, band: float) -> list[slice]:
    """Cut ``position`` (n,) into stretches, each as long as it stays within ``band``, from the first on."""
    cuts, low, high = [0], position[0], position[0]
    for k, value in enumerate(position):
        low, high = min(low, value), max(high, value)
        if high - low > band:
            cuts.append(k)
            low = high = value
    return [slice(first, last) for first, last in zip(cuts, [*cuts[1:], len(position)], strict=True)]
