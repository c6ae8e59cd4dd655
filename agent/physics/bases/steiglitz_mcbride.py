"""A sampled linear model of a record: least squares in turns, each behind the denominator of the one before.

Source: K. Steiglitz and L. McBride, "A technique for the identification of linear systems", IEEE Transactions
on Automatic Control 10 (1965) 461.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import lfilter

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]
    Sampled = tuple[FloatArray, FloatArray, int]
    """Numerator from the sample after the dead time on, (k,), denominator, (k + 1,), samples of dead time."""

DELAYS = 16
"""Samples of dead time that are tried, from none on."""
TURNS = 10
"""Of least squares."""
KEPT = 3
"""Models that are returned."""


def sampled_models(op: FloatArray, pv: FloatArray, order: int) -> list[Sampled]:
    """Return stable models from OP to PV, both (n,), of the dead times with the least errors, best first."""
    moves = op - op[0]
    delays = range(min(DELAYS, len(op) // (4 * order)))
    found = [(*in_turns(moves, pv, order, delay), delay) for delay in delays]
    found.sort(key=lambda each: each[0])
    return [(top, bottom, delay) for _, top, bottom, delay in found[:KEPT]]


def in_turns(
    moves: FloatArray, pv: FloatArray, order: int, delay: int
) -> tuple[float, FloatArray, FloatArray]:
    """Return the error in free run, the numerator, (k,), and the denominator, (k + 1,), with a dead time.

    Args:
        moves: Of OP from its first value, (n,).
        pv: PV units, (n,); its level and what it does from before the record are solved for.
        order: k.
        delay: Samples of dead time.
    """
    bottom = np.eye(1, order + 1)[0]
    best = np.inf, np.zeros(order), bottom
    start, level = order + delay, float(pv[0])
    for _ in range(TURNS):
        seen, shown = (lfilter([1.0], bottom, each) for each in (moves, pv - level))
        rows = [-shown[start - 1 - i : len(pv) - 1 - i] for i in range(order)]
        rows += [seen[start - 1 - delay - i : len(pv) - 1 - delay - i] for i in range(order)]
        rows += [each[start:] for each in free_responses(bottom, len(pv))]
        solved = np.linalg.lstsq(np.array(rows).T, shown[start:], rcond=None)[0]
        bottom, top = stable(np.concatenate(([1.0], solved[:order]))), solved[order : 2 * order]
        left = in_motion(top, bottom, delay, moves, pv)
        error = float(left @ left)
        if error < best[0]:
            best = error, top, bottom
    return best


def in_motion(
    top: FloatArray, bottom: FloatArray, delay: int, moves: FloatArray, pv: FloatArray
) -> FloatArray:
    """Return what a sampled model leaves of PV, (n,), with the best level and initial state."""
    columns = np.column_stack(free_responses(bottom, len(pv)))
    left = pv - sampled_run(top, bottom, moves, delay)
    return np.asarray(left - columns @ np.linalg.lstsq(columns, left, rcond=None)[0], dtype=np.float64)


def free_responses(bottom: FloatArray, count: int) -> list[FloatArray]:
    """Return a level and what each initial state does, each (n,)."""
    states = np.eye(len(bottom) - 1, count)
    return [np.ones(count), *(lfilter([1.0], bottom, each) for each in states)]


def stable(bottom: FloatArray) -> FloatArray:
    """Return a denominator with its poles within the unit circle."""
    poles = np.roots(bottom)
    outside = np.abs(poles) >= 1
    poles[outside] = 0.999 / np.conj(poles[outside])
    return np.asarray(np.real(np.poly(poles)), dtype=np.float64)


def sampled_run(top: FloatArray, bottom: FloatArray, moves: FloatArray, delay: int) -> FloatArray:
    """Return the response of a sampled model to moves, (n,), from rest."""
    late = np.concatenate((np.zeros(1 + delay), moves))[: len(moves)]
    return np.asarray(lfilter(top, bottom, late), dtype=np.float64)
