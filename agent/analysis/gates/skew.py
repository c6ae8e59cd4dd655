"""Whether OP and PV were read at the same instants, tested with the controller's own law.

A controller computes OP from the error of the same instant. Where OP follows from an error that is recorded
only later, or from one recorded some samples ago, the two signals have different clocks. A fixed time between
OP and PV looks like a part of a stroke (reference ``methods.md`` section 5). The test is ours.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.gates.fault import SHAPE, GateFault
from agent.analysis.gates.transmission import FEWEST_SCANS
from agent.analysis.loop.pi_controller import pi_law
from agent.analysis.record.recording import error_of

if TYPE_CHECKING:
    from agent.analysis.loop.pi_controller import PiController
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import Oscillation

MOST = 5
"""Largest shift that is tried, samples."""
KNOWN_LAW = 0.8
"""Share of the increments of OP that the PI law must explain at the best shift."""
BETTER = 3.0
"""Unexplained share without a shift, over the unexplained share at the best shift."""
LEAST_LEFT = 0.02
"""Least unexplained share without a shift: a smooth wave obeys a PI law at any shift."""


def skew_faults(window: LoopWindow, oscillation: Oscillation) -> list[GateFault]:
    """Return the fault of a record whose OP and PV are so many samples apart that shapes are distorted."""
    shift = skew(window)
    if shift == 0:
        return []
    period = None if oscillation.period is None else oscillation.period / window.ts
    if oscillation.detected and period is not None and period / abs(shift) >= FEWEST_SCANS:
        return []
    samples = f"{abs(shift)} sample{'s' * (abs(shift) > 1)}"
    when = f"{samples} before PV is recorded" if shift > 0 else f"{samples} late"
    reason = f"OP responds to PV {when}: their clocks or scans differ"
    return [GateFault("clock_skew", reason, SHAPE)]


def skew(window: LoopWindow) -> int:
    """Return by how many samples PV is recorded later than the controller read it; 0 if not known."""
    laws = {shift: _law(window, shift) for shift in range(-MOST, MOST + 1)}
    left = {shift: 1 - law.explained for shift, law in laws.items() if law is not None}
    lawful = [shift for shift, law in laws.items() if law is not None and law.kc * law.ki > 0]
    if not lawful:
        return 0
    best = min(lawful, key=lambda shift: left[shift])
    if left[best] > 1 - KNOWN_LAW or left.get(0, 1.0) < max(LEAST_LEFT, BETTER * left[best]):
        return 0
    return best


def _law(window: LoopWindow, shift: int) -> PiController | None:
    """Return the PI law of OP with PV taken ``shift`` samples ahead."""
    pv = np.full(len(window), np.nan)
    if shift >= 0:
        pv[: len(pv) - shift] = window.pv[shift:]
    else:
        pv[-shift:] = window.pv[:shift]
    return pi_law(window.op, error_of(pv, window.sp))
