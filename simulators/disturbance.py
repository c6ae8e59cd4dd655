"""Disturbances of a loop: loads that oscillate, step, wander or drift; noise of the transmitter."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from simulators.parameters import Bursts, Drift, LoadStepParameters, SinusoidParameters, Wander

PULSE = 0.2
"""Part of the period that a pulse lasts."""
SHAPES: Mapping[str, Callable[[float], float]] = {
    "sine": math.sin,
    "square": lambda phase: math.copysign(1.0, math.sin(phase)),
    "sawtooth": lambda phase: (phase / math.pi) % 2.0 - 1.0,
    "pulses": lambda phase: 2.0 * ((phase / (2.0 * math.pi)) % 1.0 < PULSE) - 2.0 * PULSE,
}
"""Waves of amplitude about one, of the phase, rad."""


class Load:
    """Load on the process input: a sinusoid, steps, a ramp, a random walk, and what wanders about zero."""

    def __init__(
        self,
        sinusoid: SinusoidParameters,
        drift: Drift,
        steps: Sequence[LoadStepParameters],
        wander: Wander,
        bursts: Bursts,
        ts: float,
        rng: np.random.Generator,
    ) -> None:
        self._sinusoid = sinusoid
        self._drift = drift
        self._steps = steps
        self._of_walk, strength = (strength_of(bursts, ts, rng) for _ in range(2))
        std, correlation = wander.std, wander.correlation
        self._wander = FirstOrderNoise(std, correlation, ts, rng, strength) if std else None
        self._ts = ts
        self._rng = rng
        self._walk = 0.0

    def over(self, time: float) -> float:
        """Load held over the sampling time that begins at ``time`` s, OP units. Call it once a sample."""
        wave = self._sinusoid
        phase = 2.0 * math.pi * (time + self._ts / 2.0) / wave.period
        step = self._drift.walk * math.sqrt(self._ts) * self._rng.standard_normal()
        self._walk += step if self._of_walk is None else step * self._of_walk.next()
        wandered = self._wander.next() if self._wander else 0.0
        stepped = at_time([(step.time, step.load) for step in self._steps], time, 0.0)
        swings = wave.amplitude * SHAPES[wave.shape](phase)
        return swings + self._drift.ramp * time + self._walk + wandered + stepped


def at_time(steps: Iterable[tuple[float, float]], time: float, before: float) -> float:
    """Value of the last of ``steps`` (time in s, value) that is not after ``time``; ``before`` the first."""
    past = [value for start, value in steps if start <= time]
    return past[-1] if past else before


class FirstOrderNoise:
    """Noise, white or of first order: Gaussian, or of a strength that rises and falls."""

    def __init__(
        self,
        std: float,
        correlation: float,
        ts: float,
        rng: np.random.Generator,
        strength: Strength | None = None,
    ) -> None:
        self._std = std
        self._keep = math.exp(-ts / correlation) if correlation > 0.0 else 0.0
        self._rng = rng
        self._strength = strength
        self._value = std * rng.standard_normal()

    def next(self) -> float:
        """Noise of the next sample, unit of ``std``."""
        fresh = self._std * math.sqrt(1.0 - self._keep**2) * self._rng.standard_normal()
        if self._strength is not None:
            fresh *= self._strength.next()
        self._value = self._keep * self._value + fresh
        return float(self._value)


class Strength:
    """Factor of a noise, its logarithm noise of first order; the mean of its square is one."""

    def __init__(self, std: float, correlation: float, ts: float, rng: np.random.Generator) -> None:
        self._logarithm = FirstOrderNoise(std, correlation, ts, rng)
        self._mean = std * std

    def next(self) -> float:
        """Factor of the next sample."""
        return math.exp(self._logarithm.next() - self._mean)


def strength_of(bursts: Bursts, ts: float, rng: np.random.Generator) -> Strength | None:
    """Return the strength of one noise; None where it is always the same."""
    return Strength(bursts.std, bursts.correlation, ts, rng.spawn(1)[0]) if bursts.std else None
