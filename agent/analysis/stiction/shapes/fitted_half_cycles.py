"""Half cycles of a record that are fit for a test of their shape, or the limit that is broken.

Source: reference ``methods.md`` section 3, common preparation, and 3.1 for the dead time.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.record.signals import detrended
from agent.analysis.stiction.shapes.half_cycle_shapes import fit, resampled_all
from agent.analysis.stiction.shapes.stretch import CUT_OFF, half_cycles, period_of, smoothed

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.analysis.results import Oscillation
    from agent.analysis.stiction.shapes.stretch import Stretch

FEWEST_PERIODS = 5.0
FEWEST_HALF_CYCLES = 8
"""Of the ten in five periods the two at the ends may be cut."""
FEWEST_SAMPLES = 10.0
"""Samples a period. From ten on sampled sines, triangles and squares fall on the right side of the limits of
He (2007) and of Rossi and Scali (2005); the paper of Lee et al. (2008) requires 50."""
LARGEST_NOISE = 0.17
"""Noise behind the low-pass over the standard deviation of the signal. A sine misses a triangle by 1.45 % of
its power, so with noise of s^2 He's index of a triangle is (0.0145 + s^2) / (0.0145 + 2 s^2): 0.6 at 0.17."""
LONGEST_DELAY = 1 / 6
"""Dead time over the period, where it is known; beyond, PV and OP lose the shape that the valve gave them."""


@dataclass(frozen=True, slots=True)
class FittedHalfCycles:
    """What a detector of shapes measured."""

    half_cycles: FloatArray
    """Without their sign, parts of the largest value of the signal, (m, 100)."""
    fits: dict[str, FloatArray]
    """By name of the shape: the mean of its fits, in the same unit, (100,)."""

    @classmethod
    def of(cls, half: FloatArray, **shapes: FloatArray) -> FittedHalfCycles:
        """Fit each of ``shapes`` (100, k) to the half cycles (m, 100)."""
        return cls(half, {name: fit(half, shape).curves.mean(axis=0) for name, shape in shapes.items()})


def shape_signal(
    values: FloatArray, stretch: Stretch, window: LoopWindow, oscillation: Oscillation
) -> tuple[FloatArray, float] | str:
    """Return a signal that is fit for a test of its shape, or the limit that is broken as a text.

    Args:
        values: OP or the control error of ``stretch``, (n,).
        stretch: The part of the window that is used.
        window: Its hints hold the dead time, if it is known.
        oscillation: That of the window.

    Returns:
        The signal without its trend and smoothed, parts of its largest value, (n,), and its period, samples.
    """
    period = period_of(stretch, oscillation, periods=FEWEST_PERIODS, samples=FEWEST_SAMPLES)
    if isinstance(period, str):
        return period
    delay = window.hints.delay
    if delay is not None and delay > LONGEST_DELAY * period:
        return f"a dead time of {delay / period:.2f} periods hides the shape, {LONGEST_DELAY:.2f} is allowed"
    if not (detrended(stretch.op).any() and detrended(stretch.pv).any()):
        return "OP or PV does not move"
    rest = detrended(values)
    noise = _noise(rest) * np.sqrt(min(1.0, 2 * CUT_OFF / period))
    if noise > LARGEST_NOISE * np.std(rest):
        return "noise hides the shape"
    return smoothed(rest, period), period


def shape_half_cycles(
    values: FloatArray, stretch: Stretch, window: LoopWindow, oscillation: Oscillation
) -> FloatArray | str:
    """Return the half cycles of ``shape_signal``, (m, 100), or the limit that is broken."""
    found = shape_signal(values, stretch, window, oscillation)
    if isinstance(found, str):
        return found
    signal, period = found
    half = resampled_all(signal, half_cycles(signal, period))
    if len(half) < FEWEST_HALF_CYCLES:
        return f"only {len(half)} half cycles are 0.25 to 1 period long, {FEWEST_HALF_CYCLES} are needed"
    return half


def _noise(values: FloatArray) -> float:
    """Return the standard deviation of white noise that explains most bends of ``values`` (n,).

    The median does not see the few large bends at the corners of squares and triangles.
    """
    return float(1.4826 * np.median(np.abs(np.diff(values, n=2))) / np.sqrt(6))
