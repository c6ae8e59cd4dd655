"""Whether OP moves enough, in enough values, inside its limits."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.gates.fault import SHAPE, GateFault
from agent.analysis.gates.values import constant, quantised
from agent.analysis.record.reversals import noise_hides_reversals, significant_reversals

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

MAX_SATURATED_SHARE = 0.3
MIN_SPAN_OF_RANGE = 0.002
"""Smallest movement of OP that counts, as a part of its range: the usual resolution of a positioner."""
LIMIT_MARGIN = 0.002
"""OP within this part of its range (or span) of a limit stands at the limit."""
FEWEST_REVERSALS = 2
"""A stick band is visible only where the valve reverses; one reversal each way is the least."""


def op_faults(window: LoopWindow) -> list[GateFault]:
    """Return the first fault of OP itself, else the fault of an OP that reverses too seldom."""
    op = window.op[window.valid]
    if constant(op):
        return [GateFault("op_constant", f"OP does not move: it is constant at {op[0]:g}")]
    fault = _still(op, window.hints.op_range) or quantised("OP", op) or _saturated(op, window.hints.op_range)
    if fault is not None:
        return [fault]
    reversals = significant_reversals(op)
    if reversals < FEWEST_REVERSALS and not noise_hides_reversals(op):
        seen = f"OP reverses only {reversals} time" if reversals else "OP does not reverse"
        reason = f"{seen}, at least {FEWEST_REVERSALS} reversals are needed"
        return [GateFault("op_few_reversals", reason, SHAPE)]
    return []


def _still(op: FloatArray, op_range: tuple[float, float] | None) -> GateFault | None:
    if op_range is None:
        return None
    share = float(np.ptp(op)) / (op_range[1] - op_range[0])
    if share >= MIN_SPAN_OF_RANGE:
        return None
    return GateFault("op_still", f"OP moves by only {100 * share:.2f} % of its range")


def _saturated(op: FloatArray, op_range: tuple[float, float] | None) -> GateFault | None:
    low, high = (float(op.min()), float(op.max())) if op_range is None else op_range
    margin = LIMIT_MARGIN * (high - low)
    for limit, at_limit in ((low, op <= low + margin), (high, op >= high - margin)):
        share = float(np.mean(at_limit))
        if share > MAX_SATURATED_SHARE:
            reason = f"OP is at its limit of {limit:g} for {100 * share:.0f} % of the record"
            return GateFault("op_saturated", reason)
    return None
