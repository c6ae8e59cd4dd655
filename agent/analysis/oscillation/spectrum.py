"""Power of a record by frequency, and what a peak of it stands above.

Source: reference ``methods.md`` 2.3 and 2.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft, signal

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

CORE = 2**0.25
"""A peak reaches a quarter of an octave to each side."""
FLANKS = (2**-1.0, 2**-0.5), (2**0.5, 2**1.0)
"""Where its surroundings are, in parts of its frequency: half an octave below and above it."""


@dataclass(frozen=True, slots=True)
class Spectrum:
    """Periodogram behind a Hann window; both arrays have shape (n // 2 + 1,)."""

    frequency: FloatArray
    """Cycles a sample."""
    power: FloatArray
    """Square of the signal's unit; only ratios matter."""

    def near(self, line: int) -> FloatArray:
        """Return the power within ``CORE`` of ``line``, and at least of the two lines beside it."""
        return self.power[self._lines(line, 1 / CORE, CORE, least=1)]

    def share(self, line: int) -> float:
        """Return the part of the whole power that is near ``line``, 0 to 1."""
        whole = float(np.sum(self.power))
        return float(np.sum(self.near(line))) / whole if whole > 0 else 0.0

    def period(self, line: int) -> float:
        """Return the period of the peak at ``line`` > 0, samples: mean over its main lobe."""
        lobe = slice(line - 1, line + 2)
        return float(np.sum(self.power[lobe]) / np.sum(self.power[lobe] * self.frequency[lobe]))

    def prominence(self, line: int) -> float:
        """Return the density of power near ``line`` over that of its surroundings, their geometric mean.

        A spectrum that falls with any power of the frequency has 1 everywhere; 0 where the surroundings
        hold no line.
        """
        core = float(np.mean(self.near(line)))
        below, above = (self.power[self._lines(line, *ends, least=0)] for ends in FLANKS)
        if not below.size or not above.size:
            return 0.0
        around = float(np.sqrt(np.mean(below) * np.mean(above)))
        return core / max(around, np.finfo(float).tiny)

    def _lines(self, line: int, low: float, high: float, least: int) -> slice:
        """Return the lines from ``low`` to ``high`` times ``line``, and at least ``least`` to each side."""
        first, last = int(np.ceil(line * low)), int(np.floor(line * high))
        if least:
            first, last = min(first, line - least), max(last, line + least)
        return slice(max(first, 0), last + 1)


def spectrum(values: FloatArray) -> Spectrum:
    """Return the spectrum of ``values`` (n,), n >= 3, without gaps and with its line taken off."""
    window = signal.windows.hann(len(values), sym=False)
    power = np.abs(fft.rfft(values * window)) ** 2
    return Spectrum(fft.rfftfreq(len(values)), np.asarray(power, dtype=np.float64))


def bridged(values: FloatArray) -> FloatArray | None:
    """Return ``values`` (n,) with straight lines across its gaps; None where nothing moves.

    For a filter or a transform only: put the gaps back after.
    """
    known = np.flatnonzero(np.isfinite(values))
    if known.size < 3 or not values[known].any():
        return None
    return np.interp(np.arange(len(values)), known, values[known])
