"""One line of the spectrum that holds most of the power.

Source: reference ``methods.md`` 2.5: share of the highest peak behind a Hann window, more than two cycles
in the record. The limit on the share is ours, from simulation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.oscillation.acf_zero_crossings import MIN_SAMPLES_PER_PERIOD
from agent.analysis.oscillation.spectrum import bridged, spectrum
from agent.analysis.record.recording import LoopWindow
from agent.analysis.record.signals import detrended
from agent.analysis.results import Oscillation

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

LEAST_SHARE = 0.7
"""Share of the power from which one peak is an oscillation. Noise of any colour up to a random walk exceeds
it in at most 5 % of 480 simulated records, 95 % of the sticking loops of ``simulators.draws.random_plants``
(seeds 0 to 39) do."""
CYCLES = 2
"""More cycles than this must be in the record."""


@dataclass(frozen=True, slots=True)
class SpectralPeak:
    """Answers with the higher peak of control error and OP; it gives no regularity."""

    name: str = "spectral_peak"
    noise_proof: bool = True

    def detect(self, window: LoopWindow) -> Oscillation:
        """Judge a window of more than two periods."""
        peaks = [highest_peak(signal) for signal in (window.error, window.op)]
        known = [peak for peak in peaks if peak is not None]
        if not known:
            return Oscillation(detected=False, period=None, regularity=None)
        share, period = max(known)
        return Oscillation(share > LEAST_SHARE, period * window.ts, None, share)


def highest_peak(signal: FloatArray) -> tuple[float, float] | None:
    """Return share of power and period (samples) of the highest peak of ``signal`` (n,); None without one."""
    values = bridged(detrended(signal))
    if values is None:
        return None
    found = spectrum(values)
    eligible = found.power[: int(len(values) / MIN_SAMPLES_PER_PERIOD) + 1].copy()
    eligible[: CYCLES + 1] = 0.0
    if not eligible.any():
        return None
    line = int(np.argmax(eligible))
    return found.share(line), found.period(line)
