"""Whether a wave is a sine, by its third harmonic.

Square, triangle and every other wave whose second half cycle is the first turned upside down have odd
harmonics only. Tests of nonlinearity are weak on them: the bicoherence couples f1 and f2 to f1 + f2, which
is even, and surrogates of a wave that repeats itself repeat themselves too. So before they call a loop
linear, the third harmonic must be known to be absent. The test is ours.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from agent.analysis.oscillation.spectrum import Spectrum, spectrum

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

ThirdHarmonic = Literal["seen", "absent", "hidden"]

SMALLEST = 1 / 27
"""Third harmonic over the first of a wave of parabolas, as behind a square and two integrators; that of a
triangle is 1/9, of a square 1/3. A smaller one is taken for none."""
ERROR = 0.05
"""How far the period may be off."""
CHANCE = 0.01
"""Part of the records of noise in which some line near the third harmonic stands out."""


def third_harmonic(values: FloatArray, period: float) -> ThirdHarmonic:
    """Return whether the third harmonic stands out, would stand out if it were there, or would be hidden.

    Args:
        values: Signal without gaps and trend, (n,), of at least five periods.
        period: Samples; below 8.5 the surroundings of the harmonic are past the Nyquist frequency, and it is
            hidden.
    """
    found = spectrum(values)
    first, third = (_lines(found, order / period) for order in (1, 3))
    if third.stop > len(found.power):
        return "hidden"
    highest = third.start + int(np.argmax(found.power[third]))
    prominence = found.prominence(highest)
    if prominence == 0:
        return "hidden"
    # The power of a line of noise has an exponential distribution about that of its surroundings.
    around = float(np.mean(found.near(highest))) / prominence
    limit = around * np.log((third.stop - third.start) / CHANCE)
    if found.power[highest] > limit:
        return "seen"
    # Where the period wanders, the line of the third harmonic is three times as wide as that of the first.
    smallest = SMALLEST**2 * float(np.max(found.power[first])) / 3
    return "absent" if smallest > limit else "hidden"


def _lines(found: Spectrum, frequency: float) -> slice:
    """Return the lines near ``frequency``, cycles a sample."""
    apart = found.frequency[1]
    return slice(round((1 - ERROR) * frequency / apart), round((1 + ERROR) * frequency / apart) + 1)
