"""The decay ratio of the autocorrelation: its second swing over its first.

Source: T. Miao and D. E. Seborg, "Automatic detection of excessively oscillatory feedback control loops",
IEEE Conference on Control Applications (1999) 359; reference ``methods.md`` 2.4, from memory of the paper.
Reconstructed: an extreme is the largest swing between two zero crossings, so that noise on the
autocorrelation makes none, and the first two must be beyond chance.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.oscillation.acf_zero_crossings import (
    MIN_SAMPLES_PER_PERIOD,
    autocorrelation,
    swing_of_noise,
)
from agent.analysis.record.recording import LoopWindow
from agent.analysis.record.signals import detrended
from agent.analysis.results import Oscillation

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

EXCESSIVE = 0.5
"""Decay ratio above which a loop oscillates excessively (Miao and Seborg 1999)."""


@dataclass(frozen=True, slots=True)
class Decay:
    """The first period of an autocorrelation."""

    ratio: float
    """Height of the first maximum over the depth of the first minimum, each from its neighbours' chord."""
    period: int
    """Lag of the first maximum, samples."""


@dataclass(frozen=True, slots=True)
class MiaoSeborg:
    """Answers with the slower decay of control error and OP; it gives no regularity."""

    name: str = "miao_seborg"
    noise_proof: bool = True

    def detect(self, window: LoopWindow) -> Oscillation:
        """Judge a window of at least six periods: both minima must lie within a quarter of it."""
        decays = [decay_ratio(signal) for signal in (window.error, window.op)]
        known = [decay for decay in decays if decay is not None and decay.period >= MIN_SAMPLES_PER_PERIOD]
        if not known:
            return Oscillation(detected=False, period=None, regularity=None)
        slowest = max(known, key=lambda decay: decay.ratio)
        return Oscillation(slowest.ratio > EXCESSIVE, slowest.period * window.ts, None)


def decay_ratio(signal: FloatArray) -> Decay | None:
    """Return the decay of the ACF of ``signal`` (n,); None without two minima up to a quarter of its length.

    None as well where the first minimum or maximum is no larger than the autocorrelation of noise.
    """
    acf = autocorrelation(detrended(signal))
    if acf is None:
        return None
    r = acf.r[: len(signal) // 4 + 1]
    crossings = np.flatnonzero(np.signbit(r[:-1]) != np.signbit(r[1:])) + 1
    if len(crossings) < 4:
        return None
    first, second, third, fourth = crossings[:4].tolist()
    minimum = first + int(np.argmin(r[first:second]))
    maximum = second + int(np.argmax(r[second:third]))
    again = third + int(np.argmin(r[third:fourth]))
    chance = swing_of_noise(acf)
    if -r[minimum] < chance[minimum] or r[maximum] < chance[maximum]:
        return None
    height = r[maximum] - np.interp(maximum, (minimum, again), (r[minimum], r[again]))
    depth = np.interp(minimum, (0, maximum), (r[0], r[maximum])) - r[minimum]
    return Decay(float(height / depth), maximum)
