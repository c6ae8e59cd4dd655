"""The record in spans from its least values, where units must not matter."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow


DIGITS = 9
"""Decimals of a span that are kept: far less than any transmitter resolves, far more than rounding has."""


def in_spans_of(window: LoopWindow) -> LoopWindow | None:
    """Return the record with OP and PV in spans from their least values, rounded; None where one stands.

    A search takes another way where last digits differ. So the same record in other units must be the same
    numbers.
    """
    pv = window.pv[np.isfinite(window.pv)]
    spread = float(np.ptp(pv)) if pv.size else 0.0
    if not (window.op_span > 0 and spread > 0):
        return None
    low = float(pv.min())
    return replace(
        window,
        op=np.round((window.op - np.nanmin(window.op)) / window.op_span, DIGITS),
        pv=np.round((window.pv - low) / spread, DIGITS),
        sp=None if window.sp is None else np.round((window.sp - low) / spread, DIGITS),
    )
