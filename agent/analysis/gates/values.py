"""Tests of the values of one signal that several gates share."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.gates.fault import ALL_KINDS, SHAPE, GateFault

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

MIN_LEVELS = 8
"""Distinct values below which the steps of the converter look like a sticking valve."""
MIN_LEVELS_OF_MODEL = 4
"""The same for a model's free run, which is fitted to all samples at once."""
ROUND_OFF = 1e-9
"""A span below this part of the largest value is round-off."""


def constant(values: FloatArray) -> bool:
    """Return whether ``values`` (n,), n >= 1 and finite, do not move."""
    return bool(np.ptp(values) <= ROUND_OFF * max(float(np.max(np.abs(values))), ROUND_OFF))


def quantised(signal: str, values: FloatArray) -> GateFault | None:
    """Return the fault of a signal, ``OP`` or ``PV``, that takes few different values."""
    levels = len(np.unique(values))
    if levels >= MIN_LEVELS:
        return None
    closes = ALL_KINDS if levels < MIN_LEVELS_OF_MODEL else SHAPE
    return GateFault(f"{signal.lower()}_quantised", f"{signal} takes only {levels} different values", closes)
