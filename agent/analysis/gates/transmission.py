"""Transmission faults of OP and PV that look like stiction: values held, sent by exception, interpolated.

Source: reference ``methods.md`` section 5. The tests are ours; the limits come from simulation, see
docs/methods/gates.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.gates.fault import ALL_KINDS, SHAPE, GateFault
from agent.analysis.gates.values import ROUND_OFF, constant

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.analysis.results import Oscillation

FEWEST_CHANGES = 20
"""Changes of a signal below which its transmission is not tested."""
RESTING = 0.3
"""Least part of the samples that repeat the one before in a signal that is sent by exception."""
BAND_STEPS = 3.0
"""A band of exception is larger than so many steps of the signal's resolution."""
SMALL_BAND, LARGE_BAND = 0.02, 0.1
"""Bands of exception, parts of the signal's span, that distort shapes (first) and models (second)."""
FEWEST_SCANS = 20.0
"""Scans a period below which the lag between OP and PV is seen in the shapes."""
SLOPING = 5.0
"""Steps of the resolution beyond which a sample moves, so that a bend would show."""
KNOT = 40.0
"""Bend of an interpolated signal where two of its lines meet, steps of the resolution; rounding makes 2."""


@dataclass(frozen=True, slots=True)
class Changes:
    """How a signal moves from sample to sample."""

    values: FloatArray
    """With NaN where it has gaps, (n,)."""
    resolution: float
    """Smallest distance of two of its values, or the round-off of its numbers, its unit."""
    steps: FloatArray
    """Differences of successive samples, NaN at gaps, (n - 1,)."""

    @property
    def moves(self) -> FloatArray:
        """Sizes of the steps that are not zero, (m,)."""
        sizes = np.abs(self.steps[np.isfinite(self.steps)])
        return sizes[sizes > self.resolution / 2]

    @property
    def resting(self) -> float:
        """Part of the samples that repeat the one before."""
        return 1 - self.moves.size / max(int(np.count_nonzero(np.isfinite(self.steps))), 1)


def transmission_faults(window: LoopWindow, oscillation: Oscillation) -> list[GateFault]:
    """Return the transmission faults of OP and of PV."""
    period = oscillation.period if oscillation.detected else None
    faults: list[GateFault] = []
    for signal, values in (("OP", window.op), ("PV", window.pv)):
        changes = changes_of(values)
        if changes is None or changes.moves.size < FEWEST_CHANGES:
            continue
        fault = (
            _scan(signal, changes, None if period is None else period / window.ts)
            or _exception(signal, changes)
            or _interpolated(signal, changes)
        )
        if fault is not None:
            faults.append(fault)
    return faults


def changes_of(values: FloatArray) -> Changes | None:
    """Return how ``values`` (n,), NaN at gaps, move; None where they do not."""
    known = values[np.isfinite(values)]
    if known.size < 2 or constant(known):
        return None
    resolution = max(np.min(np.diff(np.unique(known))), ROUND_OFF * np.max(np.abs(known)))
    return Changes(values, float(resolution), np.diff(values))


def _scan(signal: str, changes: Changes, period: float | None) -> GateFault | None:
    """Look for a signal that changes at every k-th sample only; ``period`` in samples."""
    at = np.flatnonzero(np.abs(changes.steps) > changes.resolution / 2)
    every = int(np.gcd.reduce(np.diff(at)))
    if every < 2 or (period is not None and period / every >= FEWEST_SCANS):
        return None
    reason = f"{signal} has a new value only every {every} samples, so it lags by up to {every} samples"
    return GateFault(f"{signal.lower()}_slow_scan", reason, SHAPE)


def _exception(signal: str, changes: Changes) -> GateFault | None:
    """Look for a signal that keeps its value until it has moved by more than a band."""
    band = float(np.quantile(changes.moves, 0.05))
    share = band / float(np.nanmax(changes.values) - np.nanmin(changes.values))
    if changes.resting < RESTING or band < BAND_STEPS * changes.resolution or share < SMALL_BAND:
        return None
    reason = f"{signal} is sent by exception: only moves by {share:.0%} of its span or more arrive"
    return GateFault(f"{signal.lower()}_by_exception", reason, ALL_KINDS if share >= LARGE_BAND else SHAPE)


def _interpolated(signal: str, changes: Changes) -> GateFault | None:
    """Look for straight lines between few samples: most bends are rounding, the others far larger."""
    bends = np.abs(np.diff(changes.steps))
    sloping = bends[(np.abs(changes.steps[1:]) > SLOPING * changes.resolution) & np.isfinite(bends)]
    if sloping.size < FEWEST_CHANGES:
        return None
    usual, knot = np.quantile(sloping, (0.5, 0.98))
    if usual > 2 * changes.resolution or knot < KNOT * changes.resolution:
        return None
    reason = f"{signal} is interpolated by straight lines between few samples, as historians do"
    return GateFault(f"{signal.lower()}_interpolated", reason, SHAPE)
