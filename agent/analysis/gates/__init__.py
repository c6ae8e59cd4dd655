"""Whether a window is fit for a verdict on its valve; each fault of the record has a name.

Source: reference ``methods.md`` sections 3 (preparation) and 5 (pitfalls). One group of gates a file.
"""

from __future__ import annotations

from agent.analysis.gates.fault import ALL_KINDS, GateFault, closed_kinds
from agent.analysis.gates.op import op_faults
from agent.analysis.gates.pv import pv_faults
from agent.analysis.gates.record import different_clocks, record_faults, too_short
from agent.analysis.gates.rhythm import rhythm_faults
from agent.analysis.gates.skew import skew_faults
from agent.analysis.gates.transmission import transmission_faults
from agent.analysis.record.recording import LoopWindow
from agent.analysis.results import Oscillation

__all__ = ["ALL_KINDS", "GateFault", "closed_kinds", "gates"]


def gates(window: LoopWindow, oscillation: Oscillation) -> tuple[GateFault, ...]:
    """Return every fault that forbids a verdict to some methods or to all; empty where there is none.

    Args:
        window: The stretch to judge.
        oscillation: The result of ``detect_oscillation`` for it.
    """
    spoilt = different_clocks(window) or too_short(window)
    if spoilt:
        return spoilt
    faults = (*record_faults(window), *op_faults(window), *pv_faults(window))
    if closed_kinds(faults) == ALL_KINDS:
        return faults
    return (
        *faults,
        *transmission_faults(window, oscillation),
        *skew_faults(window, oscillation),
        *rhythm_faults(window, oscillation),
    )
