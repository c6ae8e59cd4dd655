"""Whether the record has enough valid samples, and whether the loop was in automatic."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.gates.fault import GateFault

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow

MIN_SAMPLES = 100
"""Valid samples below this number cannot carry a valve and a process model."""
MIN_VALID_SHARE = 0.5
MIN_AUTOMATIC_SHARE = 0.8


def too_short(window: LoopWindow) -> tuple[GateFault, ...]:
    """Return the fault of a record that is too short for any other test."""
    count = int(np.count_nonzero(window.valid))
    if count >= MIN_SAMPLES:
        return ()
    reason = f"only {count} samples have both OP and PV, at least {MIN_SAMPLES} are needed"
    return (GateFault("few_samples", reason),)


def record_faults(window: LoopWindow) -> list[GateFault]:
    """Return the faults of quality and mode."""
    faults = []
    valid = window.valid
    there = float(np.mean(valid))
    if there < MIN_VALID_SHARE:
        faults.append(GateFault("gaps", f"only {there:.0%} of the samples are valid, the rest are gaps"))
    if window.automatic is not None:
        automatic = float(np.mean(window.automatic[valid]))
        if automatic < MIN_AUTOMATIC_SHARE:
            reason = f"the loop was in automatic for only {automatic:.0%} of the record"
            faults.append(GateFault("manual", reason))
    return faults
