"""A load that oscillates at one frequency, independent of the loop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import find_peaks, periodogram

from agent.physics.effect import Facts, Parameter, Solved, Stage
from agent.physics.signals.waves import waves

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

PADDING = 4
"""Lines of the spectrum for each that the record resolves, so that no wave falls between two."""
FASTEST = 0.2
"""Frequency of a wave, one over samples: five samples a cycle."""
LINES = 6
"""Lines of the spectrum from which a search begins."""


@dataclass(frozen=True, slots=True)
class Sinusoid:
    """A wave of constant frequency, amplitude and phase on PV; the latter two are solved for."""

    name: str = "sinusoid"
    family: str = "disturbance"
    stage: Stage = "disturbance"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the frequency: from three cycles in the record to five samples a cycle."""
        return (Parameter("frequency", "1/s", 3 / facts.duration, FASTEST / facts.ts),)

    def columns(self, time: FloatArray, response: FloatArray, values: FloatArray) -> FloatArray:  # noqa: ARG002
        """Return cosine and sine, (n, 2)."""
        return wave_columns(time, float(values[0]), 1)

    def solved(self, coefficients: FloatArray, gain: float) -> dict[str, Solved]:  # noqa: ARG002
        """Return amplitude and phase of A cos(2 pi f t + phase), t from the start of the record."""
        cosine, sine = (float(each) for each in coefficients)
        amplitude, phase = float(np.hypot(cosine, sine)), float(np.arctan2(-sine, cosine))
        return {"amplitude": (amplitude, "PV"), "phase": (phase, "rad")}

    def spotted(self, residual: FloatArray, facts: Facts) -> FloatArray:
        """Return the frequencies of the highest lines, 1/s, (m, 1), m up to ``LINES``.

        A search of the frequency must begin within about one over the length of the record. Missing samples
        add nothing to the spectrum.
        """
        (searched,) = self.parameters(facts)
        known = np.where(np.isfinite(residual), residual - np.nanmean(residual), 0.0)
        frequency, power = periodogram(known, 1 / facts.ts, nfft=PADDING * len(known), detrend=False)
        power[(frequency < searched.low) | (frequency > searched.high)] = 0.0
        lines, _ = find_peaks(power)
        highest = lines[np.argsort(-power[lines])[:LINES]]
        return np.asarray(frequency[highest, np.newaxis])


def wave_columns(time: FloatArray, frequency: float, harmonics: int) -> FloatArray:
    """Return cosine and sine of a frequency, 1/s, and of its multiples, (n, 2 harmonics).

    ``time``: s, (n,), evenly spaced, n >= 2.
    """
    speed = 2 * np.pi * frequency
    return waves(speed * time[0], speed * (time[1] - time[0]), len(time), harmonics).T
