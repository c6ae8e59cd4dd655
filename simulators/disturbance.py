"""What happens to a loop from outside: load swings, slow drift, noise of the transmitter."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from simulators.parameters import Drift, Noise, Sinusoid


class Load:
    """Load on the process input: a sinusoid, a ramp and a random walk."""

    def __init__(self, sinusoid: Sinusoid, drift: Drift, ts: float, rng: np.random.Generator) -> None:
        self._sinusoid = sinusoid
        self._drift = drift
        self._ts = ts
        self._rng = rng
        self._walk = 0.0

    def over(self, time: float) -> float:
        """Load held over the sampling time that begins at ``time`` s, OP units. To be asked once a sample."""
        wave = self._sinusoid
        phase = 2.0 * math.pi * (time + self._ts / 2.0) / wave.period
        self._walk += self._drift.walk * math.sqrt(self._ts) * self._rng.standard_normal()
        return wave.amplitude * math.sin(phase) + self._drift.ramp * time + self._walk


class TransmitterNoise:
    """Gaussian noise on PV, white or of first order."""

    def __init__(self, noise: Noise, ts: float, rng: np.random.Generator) -> None:
        self._std = noise.std
        self._keep = math.exp(-ts / noise.correlation) if noise.correlation > 0.0 else 0.0
        self._rng = rng
        self._value = noise.std * rng.standard_normal()

    def next(self) -> float:
        """Noise of the next sample, PV units."""
        fresh = self._std * math.sqrt(1.0 - self._keep**2) * self._rng.standard_normal()
        self._value = self._keep * self._value + fresh
        return float(self._value)
