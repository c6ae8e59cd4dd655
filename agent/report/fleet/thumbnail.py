"""A small picture of a record as numbers: the interesting stretch, thinned so that no stroke is lost."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.record.interesting_stretch import interesting_stretch

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.record.recording import FloatArray, LoopWindow

PIECES = 150
"""Each drawn by its lowest and highest sample."""


@dataclass(frozen=True, slots=True)
class Thumbnail:
    """OP and PV of a stretch, thinned; NaN where nothing was recorded."""

    start: float
    """Of the stretch, from the start of the record, s."""
    end: float
    op: FloatArray
    """OP units, (k,)."""
    pv: FloatArray
    """PV units, (k,)."""


def thumbnail(window: LoopWindow, diagnosis: Diagnosis) -> Thumbnail:
    """Return the small picture of a record."""
    period = None if diagnosis.oscillation is None else diagnosis.oscillation.period
    shown = interesting_stretch(window, period)
    ts = window.ts
    return Thumbnail(
        shown.start * ts, shown.stop * ts, _thinned(window.op[shown]), _thinned(window.pv[shown])
    )


def _thinned(values: FloatArray) -> FloatArray:
    """Return the extremes of each piece, in the order in which they came, (at most 2 PIECES,)."""
    if len(values) <= 2 * PIECES:
        return values
    width = -(-len(values) // PIECES)
    pieces = np.pad(values, (0, -len(values) % width), constant_values=np.nan).reshape(-1, width)
    missing = ~np.isfinite(pieces)
    least, most = np.where(missing, np.inf, pieces).argmin(1), np.where(missing, -np.inf, pieces).argmax(1)
    ends = np.sort(np.stack((least, most), axis=1), axis=1)
    return np.take_along_axis(pieces, ends, axis=1).ravel()
