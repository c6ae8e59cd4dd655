"""How well a sine, a triangle and a relay response fit half cycles of an oscillation.

Every half cycle is brought to the same 100 points, so that a shape is a table of candidates with one column
for each place of the peak or time constant, and the best fit of all half cycles a product of matrices.

Source: reference ``methods.md`` 3.6 (sine, triangle) and 3.7 (relay).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import FloatArray

POINTS = 100
"""Points that a half cycle is brought to."""
T: FloatArray = (np.arange(POINTS) + 0.5) / POINTS
"""Their times, from one zero crossing to the next, half cycles; (100,)."""
FASTEST_RELAY, SLOWEST_RELAY = 0.015, 10.0
"""Time constants of the relay shape, half cycles. A faster one is a square on these points, a slower one a
symmetric triangle."""
RELAYS = 60
"""Number of time constants between them, evenly in their logarithm."""


@dataclass(frozen=True, slots=True)
class FittedShape:
    """One shape fitted to each of m half cycles by least squares."""

    error: FloatArray
    """Mean squared error of each fit, squared units of the signal, (m,)."""
    curves: FloatArray
    """The fits, units of the signal, (m, 100)."""


def resampled(values: FloatArray) -> FloatArray:
    """Return one half cycle at 100 points between its zero crossings, without its sign, shape (100,).

    Args:
        values: (n,), from the last sample before the first crossing to the first after the second, n >= 3.
    """
    first = values[0] / (values[0] - values[1])
    last = len(values) - 2 + values[-2] / (values[-2] - values[-1])
    times = np.concatenate(([first], np.arange(1.0, len(values) - 1), [last]))
    inside = np.concatenate(([0.0], values[1:-1], [0.0]))
    side = -1.0 if np.signbit(values[1]) else 1.0
    return np.asarray(side * np.interp(first + T * (last - first), times, inside))


def resampled_all(values: FloatArray, cycles: Sequence[slice]) -> FloatArray:
    """Return ``cycles`` of ``values`` (n,), as ``half_cycles`` cuts them, at 100 points each, (m, 100).

    A half cycle that is zero throughout has no shape and is left out.
    """
    moving = [cycle for cycle in cycles if values[cycle].any()]
    each = [resampled(values[cycle.start - 1 : cycle.stop + 1]) for cycle in moving]
    return np.array(each).reshape(-1, POINTS)


def fit(half_cycles: FloatArray, shape: FloatArray) -> FittedShape:
    """Fit the best column of ``shape`` (100, k), of any height, to each of ``half_cycles`` (m, 100)."""
    heights = half_cycles @ shape  # columns have length 1, so this is least squares for every one of them
    best = np.argmax(heights, axis=1)
    curves = heights[np.arange(len(best)), best, None] * shape.T[best]
    return FittedShape(np.mean((half_cycles - curves) ** 2, axis=1), curves)


def _unit_columns(columns: FloatArray) -> FloatArray:
    return np.asarray(columns / np.linalg.norm(columns, axis=0))


def _triangles() -> FloatArray:
    t, peak = T[:, None], T[None, :]
    return np.where(t <= peak, t / peak, (1 - t) / (1 - peak))


def _relays() -> FloatArray:
    """Return the response of a first-order process with dead time to a relay, between two crossings.

    The relay switches at the crossing, the process responds a dead time later. The dead time follows from
    the time constant, because the curve must come back to zero at the end.
    """
    t, tau = T[:, None], np.geomspace(FASTEST_RELAY, SLOWEST_RELAY, RELAYS)[None, :]
    dead_time = tau * np.log((1 + np.exp(1 / tau)) / 2)
    rise = 1 - np.exp(-t / tau)
    fall = -1 + (2 - np.exp(-dead_time / tau)) * np.exp(-(t - dead_time) / tau)
    return np.where(t <= dead_time, rise, fall)


SINE = _unit_columns(np.sin(np.pi * T)[:, None])
"""Half a sine, (100, 1)."""
TRIANGLE = _unit_columns(_triangles())
"""Two straight lines through the crossings that meet at any of the points, (100, 100)."""
RELAY = _unit_columns(_relays())
"""Relay responses for every time constant, (100, 60)."""
