"""Whether the transmitter of PV works and has enough resolution."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.gates.fault import GateFault
from agent.analysis.gates.values import constant, quantised

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

MAX_FROZEN_SHARE = 0.3
"""Longest time for which PV may keep one value, part of the record."""


def pv_faults(window: LoopWindow) -> list[GateFault]:
    """Return the first fault of PV itself."""
    pv, op = window.pv[window.valid], window.op[window.valid]
    if constant(pv):
        reason = f"PV does not move: it is constant at {pv[0]:g}; check the transmitter"
        return [GateFault("pv_constant", reason)]
    fault = quantised("PV", pv)
    if fault is not None:
        return [fault]
    rest = longest_rest(pv)
    if len(pv[rest]) > MAX_FROZEN_SHARE * len(pv) and not constant(op[rest]):
        share = len(pv[rest]) / len(pv)
        reason = f"PV is exactly {pv[rest][0]:g} for {100 * share:.0f} % of the record while OP moves"
        return [GateFault("pv_frozen", f"{reason}; check the transmitter")]
    return []


def longest_rest(values: FloatArray) -> slice:
    """Return the longest stretch of ``values`` (n,), n >= 1, in which all are the same."""
    starts = np.concatenate(([0], np.flatnonzero(np.diff(values)) + 1))
    ends = np.concatenate((starts[1:], [len(values)]))
    longest = int(np.argmax(ends - starts))
    return slice(int(starts[longest]), int(ends[longest]))
