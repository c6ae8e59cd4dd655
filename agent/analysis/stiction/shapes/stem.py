"""The stem's position beside OP: the measured one, or PV where it moves in short steps as a stem does.

Methods that compare valve and OP need the position. In a fast loop, mostly flow, PV is used in its place. A
record shows that a loop is fast only where its valve jumps: then PV moves in short steps. A PV that moves all
the time comes from a slow process or from a free valve, and the record cannot distinguish the two.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import ndimage

from agent.analysis.loop.controller_action import process_gain_sign
from agent.analysis.oscillation.acf_zero_crossings import autocorrelation
from agent.analysis.record.signals import detrended
from agent.analysis.stiction.shapes.stretch import longest_stretch

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.analysis.results import Oscillation

SAMPLES = 20
"""Samples a period after averaging: a stroke has ten (Yamashita 2006)."""
FEWEST_SAMPLES = 10.0
"""Samples a period in the record."""
FEWEST_PERIODS = 3.0
"""As many strokes each way as the detectors average over at least."""
SHORT_STEPS = 0.2
"""Part of the time in which PV makes half of its way, up to which it is used in place of the stem.

Behind a lag tau a step has made half of its way after 0.69 tau, so that a square wave of period P is below
while tau < P / 7. A sine needs 1/3 of the time, a triangle 1/2.
"""


@dataclass(frozen=True, slots=True)
class Stem:
    """OP and stem over one stretch, both as moving means over a twentieth of a period; arrays (n,)."""

    op: FloatArray
    """OP units."""
    position: FloatArray
    """Unit of the measured position, or PV units; it rises where more OP opens the valve."""
    width: int
    """Samples in a mean."""
    measured: bool
    """False where PV is used in place of the stem."""


def stem_of(window: LoopWindow, oscillation: Oscillation) -> Stem | str:
    """Return OP and stem of the longest stretch without a gap, or the reason why no stem is known.

    Where no oscillation is known, the first zero of OP's autocorrelation is taken for a quarter period.
    """
    stretch = longest_stretch(window)
    period = _time_scale(stretch.op) if oscillation.period is None else oscillation.period / window.ts
    if period is None or len(stretch) < FEWEST_PERIODS * period:
        return f"OP moves up and down fewer than {FEWEST_PERIODS:.0f} times without a gap"
    if period < FEWEST_SAMPLES:
        return f"fewer than {FEWEST_SAMPLES:.0f} samples a period"
    width = max(1, round(period / SAMPLES))
    if stretch.mv is not None:
        stem = _side_by_side(stretch.op, stretch.mv, width, measured=True)
        return stem or "OP or the measured valve position does not move"
    sign = process_gain_sign(window)
    if sign == 0:
        return "no valve position is measured, and the direction in which OP moves PV is not known"
    stem = _side_by_side(stretch.op, sign * stretch.pv, width, measured=False)
    if stem is None or time_of_half_the_way(stem.position) > SHORT_STEPS:
        return "no valve position is measured, and PV moves too slowly to be used in its place"
    return stem


def time_of_half_the_way(position: FloatArray) -> float:
    """Return the least part of the time in which ``position`` (n,) makes half of its way; 1 if it stands."""
    steps = np.sort(np.abs(np.diff(position)))[::-1]
    way = np.cumsum(steps)
    return float(np.searchsorted(way, way[-1] / 2) + 1) / len(steps) if way[-1] > 0 else 1.0


def _side_by_side(op: FloatArray, position: FloatArray, width: int, *, measured: bool) -> Stem | None:
    """Return ``op`` and ``position`` (n,) with a scan taken off; None where one of them stands.

    A loop is read before its OP is sent, so the stem follows one sample late. If this delay stayed in, it
    would look like a stem that stands while OP moves.
    """
    late = _moving_mean(op[:-1], width), _moving_mean(position[1:], width)
    at_once = _moving_mean(op, width), _moving_mean(position, width)
    if not (np.ptp(late[0]) > 0 and np.ptp(late[1]) > 0):
        return None
    nearer = late if _correlation(*late) > _correlation(*at_once) else at_once
    return Stem(*nearer, width, measured)


def _correlation(one: FloatArray, other: FloatArray) -> float:
    return float(np.corrcoef(one, other)[0, 1])


def _time_scale(op: FloatArray) -> float | None:
    """Return four times the lag, samples, where the autocorrelation of ``op`` (n,) first crosses zero."""
    acf = autocorrelation(detrended(op))
    below = np.flatnonzero(acf.r < 0) if acf is not None else np.empty(0)
    return 4.0 * float(below[0]) if below.size else None


def _moving_mean(values: FloatArray, width: int) -> FloatArray:
    return np.asarray(ndimage.uniform_filter1d(values - values[0], width), dtype=np.float64)
