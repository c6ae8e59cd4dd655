"""Laboratory rigs of linear dynamics beyond one lag: vessels in a row, a mass on a spring, two of them.

OP is what such rigs are tested with, levels at random, each held for a while; PV is solved for exactly (a
held input). The record begins while PV moves, for it is cut out of a longer one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
from scipy.signal import cont2discrete, lfilter

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

LinearRigName = Literal["vessels", "spring", "two_springs"]
LINEAR_RIGS: tuple[LinearRigName, ...] = get_args(LinearRigName)
SAMPLES, BEFORE = 1200, 300
"""Of the record, and before it; 1 s each."""
HELD = 15
"""Samples for which a level is held."""
LEVELS = (30.0, 70.0)
"""OP units."""
NOISE = 0.3
"""Standard deviation, PV units."""


@dataclass(frozen=True, slots=True)
class LinearRig:
    """A record of one. Arrays have shape (n,)."""

    op: FloatArray
    """OP units."""
    pv: FloatArray
    """PV units."""


def linear_rig(seed: int, name: LinearRigName) -> LinearRig:
    """Draw a record; the same seed gives the same one."""
    rng = np.random.default_rng([seed, *name.encode()])
    count = BEFORE + SAMPLES
    op = np.repeat(rng.uniform(*LEVELS, -(-count // HELD)), HELD)[:count]
    top, bottom, _ = cont2discrete(_transfer(name, rng), 1.0)
    pv = 20 + rng.uniform(0.5, 2.0) * lfilter(top.ravel(), bottom, op - op[0])
    return LinearRig(op[BEFORE:], (pv + rng.normal(0.0, NOISE, count))[BEFORE:])


def _transfer(name: LinearRigName, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Return numerator and denominator of a gain of one, s."""
    if name == "vessels":
        bottom = np.ones(1)
        for _ in range(5):
            bottom = np.convolve(bottom, (rng.uniform(4.0, 9.0), 1.0))
        return np.ones(1), bottom
    first = _spring(rng.uniform(3.0, 8.0), rng.uniform(0.05, 0.3))
    if name == "spring":
        return np.array([rng.uniform(0.0, 6.0), 1.0]), first
    return np.ones(1), np.convolve(first, _spring(rng.uniform(1.0, 2.0), rng.uniform(0.05, 0.3)))


def _spring(tau: float, damping: float) -> FloatArray:
    return np.array([tau * tau, 2 * damping * tau, 1.0])
