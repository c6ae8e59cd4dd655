"""Whether a window can tell anything about its valve; each thing that stands in the way is named.

Source: reference ``methods.md`` sections 3 (preparation) and 5 (pitfalls). One group of gates a file.
"""

from __future__ import annotations

from agent.analysis.gates.fault import ALL_KINDS, GateFault, closed_kinds
from agent.analysis.gates.op import op_faults
from agent.analysis.gates.pv import pv_faults
from agent.analysis.gates.record import record_faults, too_short
from agent.analysis.gates.rhythm import rhythm_faults
from agent.analysis.gates.skew import skew_faults
from agent.analysis.gates.transmission import transmission_faults
from agent.analysis.record.recording import LoopWindow
from agent.analysis.results import Oscillation

__all__ = ["ALL_KINDS", "GateFault", "closed_kinds", "gates"]


def gates(window: LoopWindow, oscillation: Oscillation) -> tuple[GateFault, ...]:
    """Return everything that stands in the way of some methods or of all; empty where nothing does.

    Args:
        window: The stretch to judge.
        oscillation: What ``detect_oscillation`` saw in it.
    """
    short = too_short(window)
    if short:
        return short
    faults = (*record_faults(window), *op_faults(window), *pv_faults(window))
    if closed_kinds(faults) == ALL_KINDS:
        return faults
    return (
        *faults,
        *transmission_faults(window, oscillation),
        *skew_faults(window, oscillation),
        *rhythm_faults(window, oscillation),
    )
