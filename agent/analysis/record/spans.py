"""The record in spans from its least values, where units must not matter."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow


def in_spans_of(window: LoopWindow) -> LoopWindow | None:
    """Return the record with OP and PV in spans from their least values; None where one does not move."""
    pv = window.pv[np.isfinite(window.pv)]
    spread = float(np.ptp(pv)) if pv.size else 0.0
    if not (window.op_span > 0 and spread > 0):
        return None
    low = float(pv.min())
    return replace(
        window,
        op=(window.op - np.nanmin(window.op)) / window.op_span,
        pv=(window.pv - low) / spread,
        sp=None if window.sp is None else (window.sp - low) / spread,
    )
