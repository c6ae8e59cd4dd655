"""A recording prepared for fits: OP without gaps, weights of PV, and the facts that bound parameters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.gates import gates
from agent.analysis.loop.controller_action import process_gain_sign
from agent.analysis.oscillation import detect_oscillation
from agent.analysis.record.reversals import significant_reversals
from agent.identify.problem import BURN, after_gaps, bridge, dominant_period, smooth_speed
from agent.physics.effect import Facts

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

SPOILT = frozenset(
    {
        "clocks_differ",
        "few_samples",
        "gaps",
        "manual",
        "op_constant",
        "op_still",
        "pv_by_exception",
        "pv_constant",
        "pv_frozen",
        "pv_quantised",
    }
)
"""Faults of ``agent.analysis.gates`` with which OP and PV say nothing of each other. The others speak of the
form of OP, few values, few turns, a limit, and close methods that look at shapes: what such a record can show
of each effect is computed (``shown``)."""
HELD = 0.5
"""Part of the samples that repeat the one before, from which on OP is stepped: by hand, a test, a relay."""
FEW_CYCLES = 8
"""Dominant periods in a record, up to which it is doubtful whether the loop oscillates at all."""


@dataclass(frozen=True, slots=True)
class Record:
    """OP and PV of one loop, ready to be fitted. Arrays have shape (n,)."""

    loop: str
    op: FloatArray
    """OP units, a straight line through each gap."""
    pv: FloatArray
    """PV units, a straight line through each gap; those samples have no weight."""
    weight: FloatArray
    """1 where PV counts; 0 in gaps, after them and at the start, where PV responds to an unknown OP."""
    facts: Facts
    start: FloatArray | None = None
    """What a process may still answer to OP before the record, columns, (n, k); None: nothing is seen."""

    def __len__(self) -> int:
        return len(self.op)

    @property
    def period(self) -> float:
        """Dominant period of OP, samples."""
        return self.facts.period / self.facts.ts


def record_of(window: LoopWindow, *, from_start: bool = False) -> Record | str:
    """Return the record, or as a text why the workbench cannot test it.

    ``from_start``: PV counts from the first sample on, for a model that has its initial state as a parameter.
    """
    closed = closed_by(window)
    return bare_record(window, from_start=from_start) if closed is None else closed


def closed_by(window: LoopWindow) -> str | None:
    """Return as a text why no model can be fitted to or scored on a window; None where one can."""
    closing = [
        each.reason
        for each in gates(window, detect_oscillation(window))
        if "model" in each.closes and each.name in SPOILT
    ]
    return "; ".join(closing) or None


def bare_record(window: LoopWindow, *, from_start: bool = False) -> Record:
    """Return the record of a window without any test; OP and PV must have known samples."""
    op, pv = bridge(window.op), bridge(window.pv)
    period = period_of(op)
    counts = window.valid & ~after_gaps(window.op, period) & ~after_gaps(window.pv, period)
    if not from_start:
        counts[: _unknown_start(op, period)] = False
    facts = Facts(
        ts=window.ts,
        samples=len(op),
        op_low=float(op.min()),
        op_high=float(op.max()),
        pv_low=float(pv.min()),
        pv_high=float(pv.max()),
        period=period * window.ts,
        op_speed=smooth_speed(op, period) / window.ts,
        gain_sign=process_gain_sign(window),
        stepped=_is_stepped(op),
    )
    return Record(window.loop, op, pv, counts.astype(np.float64), facts)


def _unknown_start(op: FloatArray, period: float) -> int:
    """Return for how many samples PV answers to an OP that is not known.

    A stepped OP that stands still at first was known before as well as after, but for the time before that.
    """
    longest = int(min(BURN * period, len(op) / 12))
    moves = np.flatnonzero(np.diff(op))
    return min(longest, int(moves[0]) // 2) if len(moves) and _is_stepped(op) else longest


def _is_stepped(op: FloatArray) -> bool:
    return int(np.count_nonzero(np.diff(op))) <= (1 - HELD) * len(op)


def period_of(op: FloatArray) -> float:
    """Return the dominant period of OP (n,), without gaps, samples.

    Where the record has few cycles of it, it is at most twice the mean time between reversals: if a loop does
    not oscillate, the highest line is one of the slowest and has no meaning.
    """
    period = dominant_period(op)
    turns = significant_reversals(op)
    if turns == 0 or len(op) > FEW_CYCLES * period:
        return period
    return min(period, 2 * len(op) / turns)
