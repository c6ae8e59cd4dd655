"""Whether OP and PV have one clock, enough valid samples, and whether the loop was in automatic."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.gates.fault import GateFault
from agent.durations import duration_words

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow

MIN_SAMPLES = 100
"""Valid samples below this number cannot carry a valve and a process model."""
MIN_VALID_SHARE = 0.5
MIN_AUTOMATIC_SHARE = 0.5
"""As for gaps: a stretch that was not in automatic is one."""


def different_clocks(window: LoopWindow) -> tuple[GateFault, ...]:
    """Return the fault of a record whose OP and PV bear the times of clocks that differ.

    A time between OP and PV looks like a part of a stroke: S would be whatever the clocks make of it.
    """
    apart = window.clocks_apart
    if apart == 0:
        return ()
    way = "ahead of" if apart > 0 else "behind"
    reason = (
        f"the clock of PV is {duration_words(abs(apart))} {way} that of OP, so that they cannot be compared"
    )
    return (GateFault("clocks_differ", reason),)


def too_short(window: LoopWindow) -> tuple[GateFault, ...]:
    """Return the fault of a record that is too short for any other test, or mostly not in automatic."""
    manual = _manual(window)
    if manual is not None:
        return (manual,)
    count = int(np.count_nonzero(window.valid))
    if count >= MIN_SAMPLES:
        return ()
    reason = f"only {count} samples have both OP and PV, at least {MIN_SAMPLES} are needed"
    return (GateFault("few_samples", reason),)


def record_faults(window: LoopWindow) -> list[GateFault]:
    """Return the fault of quality."""
    there = float(np.mean(window.valid if window.automatic is None else window.valid[window.automatic]))
    if there >= MIN_VALID_SHARE:
        return []
    return [GateFault("gaps", f"only {100 * there:.0f} % of the samples are valid, the rest are gaps")]


def _manual(window: LoopWindow) -> GateFault | None:
    if window.automatic is None or not len(window):
        return None
    automatic = float(np.mean(window.automatic))
    if automatic >= MIN_AUTOMATIC_SHARE:
        return None
    only = f"in automatic for only {100 * automatic:.0f} % of the record"
    share = "never in automatic" if automatic == 0 else only
    return GateFault("manual", f"the loop was {share}; OP shows the valve only where the controller moves it")
