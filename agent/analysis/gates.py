"""Whether a window can tell anything about its valve; each thing that stands in the way is named.

Source: reference ``methods.md`` sections 3 (preparation) and 5 (pitfalls).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, get_args

import numpy as np

from agent.analysis.recording import LoopWindow
from agent.analysis.results import MethodKind

if TYPE_CHECKING:
    from agent.analysis.recording import FloatArray

MIN_SAMPLES = 100
"""Valid samples below this number cannot carry a valve and a process model."""
MIN_VALID_SHARE = 0.5
MIN_AUTOMATIC_SHARE = 0.8
MAX_SATURATED_SHARE = 0.3
MIN_LEVELS = 8
"""Distinct values below which the steps of the converter look like a sticking valve."""
MIN_SPAN_OF_RANGE = 0.002
"""Smallest movement of OP that counts, as a part of its range: the usual resolution of a positioner."""
LIMIT_MARGIN = 0.002
"""OP within this part of its range (or span) of a limit stands at the limit."""
CONSTANT = 1e-9
"""A span below this part of the largest value is round-off."""


ALL_KINDS: frozenset[MethodKind] = frozenset(get_args(MethodKind))


@dataclass(frozen=True, slots=True)
class GateFault:
    """Something about the record that forbids a verdict to some methods."""

    name: str
    """Stable word: few_samples, gaps, manual, op_constant, op_still, op_quantised, op_saturated, pv_constant,
    pv_quantised."""
    reason: str
    """The same for an engineer."""
    closes: frozenset[MethodKind] = ALL_KINDS
    """Kinds of methods that it forbids to speak."""


def gates(window: LoopWindow) -> tuple[GateFault, ...]:
    """Return everything that makes the window untestable; empty where it may be analysed."""
    valid = window.valid
    count = int(np.count_nonzero(valid))
    faults: list[GateFault] = []
    if count < MIN_SAMPLES:
        reason = f"only {count} samples have both OP and PV, at least {MIN_SAMPLES} are needed"
        return (GateFault("few_samples", reason),)
    if count < MIN_VALID_SHARE * len(window):
        faults.append(
            GateFault("gaps", f"only {count / len(window):.0%} of the record is there, the rest are gaps")
        )
    op, pv = window.op[valid], window.pv[valid]
    faults += _manual(window, valid)
    faults += _op_faults(op, window.hints.op_range)
    faults += _pv_faults(pv)
    return tuple(faults)


def _manual(window: LoopWindow, valid: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> list[GateFault]:
    if window.automatic is None:
        return []
    share = float(np.mean(window.automatic[valid]))
    if share >= MIN_AUTOMATIC_SHARE:
        return []
    return [GateFault("manual", f"the loop was in automatic for only {share:.0%} of the record")]


def _op_faults(op: FloatArray, op_range: tuple[float, float] | None) -> list[GateFault]:
    span = float(np.ptp(op))
    if _constant(op):
        return [GateFault("op_constant", f"OP does not move: it stands at {op[0]:g}")]
    if op_range is not None and span < MIN_SPAN_OF_RANGE * (op_range[1] - op_range[0]):
        share = span / (op_range[1] - op_range[0])
        return [GateFault("op_still", f"OP moves by only {share:.2%} of its range")]
    if (levels := len(np.unique(op))) < MIN_LEVELS:
        return [GateFault("op_quantised", f"OP takes only {levels} different values")]
    low, high = (float(op.min()), float(op.max())) if op_range is None else op_range
    margin = LIMIT_MARGIN * (high - low)
    for limit, at_limit in ((low, op <= low + margin), (high, op >= high - margin)):
        share = float(np.mean(at_limit))
        if share > MAX_SATURATED_SHARE:
            reason = f"OP stands at {limit:g}, its limit, for {share:.0%} of the record"
            return [GateFault("op_saturated", reason)]
    return []


def _pv_faults(pv: FloatArray) -> list[GateFault]:
    if _constant(pv):
        return [
            GateFault("pv_constant", f"PV does not move: it stands at {pv[0]:g}; is the transmitter alive?")
        ]
    if (levels := len(np.unique(pv))) < MIN_LEVELS:
        return [GateFault("pv_quantised", f"PV takes only {levels} different values")]
    return []


def _constant(values: FloatArray) -> bool:
    return bool(np.ptp(values) <= CONSTANT * max(float(np.max(np.abs(values))), CONSTANT))
