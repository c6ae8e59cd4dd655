"""How far probabilities are from the part that is so, and how far chance alone takes them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.memory.weighing_windows import BASE_RATE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray

BINS = 5
"""Of the probabilities."""
DRAWS = 1000


def calibration_error(p: Sequence[float], sticks: Sequence[bool]) -> float:
    """Return the mean distance of P and the part that sticks, over bins of P, weighted to the base rate.

    NaN where there are not valves of both kinds.
    """
    values, kinds = np.asarray(p, dtype=float), np.asarray(sticks, dtype=bool)
    return _error(values, kinds, BASE_RATE) if 0 < kinds.mean() < 1 else float("nan")


def error_by_chance(p: Sequence[float], sticks: Sequence[bool]) -> float:
    """Return the mean calibration error of as many valves of each kind if these probabilities were right.

    Then of valves with a probability p the part p sticks: so valves of each kind are drawn from those that
    are here, the ones that stick in proportion to p, sound ones to 1 - p, and their mean is the base rate.
    """
    values, kinds = np.asarray(p, dtype=float), np.asarray(sticks, dtype=bool)
    if not 0 < kinds.mean() < 1:
        return float("nan")
    rng = np.random.default_rng(0)
    here = _weights(kinds, BASE_RATE)
    base = float(here @ values / here.sum())
    chances = [here * values, here * (1 - values)]
    counts = [int(kinds.sum()), int((~kinds).sum())]
    labels = np.repeat([True, False], counts)
    errors = []
    for _ in range(DRAWS):
        drawn = [rng.choice(values, n, p=each / each.sum()) for n, each in zip(counts, chances, strict=True)]
        errors.append(_error(np.concatenate(drawn), labels, base))
    return float(np.mean(errors))


def _weights(sticks: NDArray[np.bool_], base: float) -> FloatArray:
    """Return the weight of each valve with which those that stick have the base rate, (n,)."""
    share = sticks.mean()
    return np.where(sticks, base / share, (1 - base) / (1 - share))


def _error(p: FloatArray, sticks: NDArray[np.bool_], base: float) -> float:
    weight = _weights(sticks, base)
    place = np.minimum((p * BINS).astype(int), BINS - 1)
    error = 0.0
    for k in range(BINS):
        here = place == k
        if here.any():
            error += abs(float((weight * sticks)[here].sum() - (weight * p)[here].sum()))
    return error / float(weight.sum())
