"""The PI controller of a loop, read from the record."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

FEWEST_MOVES = 10
"""Known increments of OP below which nothing is estimated."""


@dataclass(frozen=True, slots=True)
class PiController:
    """dOP(t) = kc (e(t) - e(t-1)) + ki e(t) + constant, the PI law from sample to sample."""

    kc: float
    """OP units per PV unit; below zero in a direct acting controller."""
    ki: float
    """kc Ts / Ti, OP units per PV unit and sample."""
    explained: float
    """Share of the variance of the increments of OP that this law gives."""


def pi_controller(window: LoopWindow) -> PiController | None:
    """Return the law by least squares, or None where OP hardly moves or only ramps.

    Without a set point the error is taken about the mean of PV; the constant makes up for that as long as the
    set point stood still.
    """
    return pi_law(window.op, window.error)


def pi_law(op: FloatArray, error: FloatArray) -> PiController | None:
    """Return the law that gives OP (n,) from the control error (n,), as ``pi_controller`` does."""
    increments = np.diff(op)
    terms = np.stack([np.diff(error), error[1:], np.ones(len(increments))], axis=1)
    known = np.isfinite(increments) & np.isfinite(terms).all(axis=1)
    if known.sum() < FEWEST_MOVES or not np.any(increments[known]):
        return None
    increments, terms = increments[known], terms[known]
    if not np.var(increments):
        return None  # one ramp: any law of the constant alone gives it
    weights, *_ = np.linalg.lstsq(terms, increments, rcond=None)
    explained = 1 - np.var(increments - terms @ weights) / np.var(increments)
    return PiController(float(weights[0]), float(weights[1]), float(explained))
