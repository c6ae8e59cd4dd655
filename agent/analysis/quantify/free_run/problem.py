"""The record as the search sees it: gaps weighted out, slow nuisance projected out, bounds set."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.analysis.controller_action import process_gain_sign

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.recording import FloatArray, LoopWindow

SLOW_TERMS = 2
"""Slow cosines beside level and slope, of two records and of one: the drift of a loop that oscillates."""
APART = 8
"""Periods in a record from which drift and oscillation are apart; with fewer, cosines follow the slips."""
LEAST_SAMPLES = 50
SHORT_GAP = 1 / 12
"""Length of a gap in OP, in periods, up to which a straight line stands for what is missing."""


class Problem(NamedTuple):
    """What the compiled objective needs; a NamedTuple because numba takes it apart by itself."""

    op: FloatArray
    """Controller output, a straight line through each gap, OP units, (n,)."""
    pv: FloatArray
    """Process variable with the nuisance projected out and zero where unknown, PV units, (n,)."""
    weight: FloatArray
    """1 where OP and PV are known and the model can know what PV answers to, else 0, (n,)."""
    basis: FloatArray
    """Orthonormal level, slope and maybe slow cosines on the known samples, (n, 2) or (n, 4)."""
    gain_sign: int
    """+1, -1, or 0 where both are possible."""
    fixed_delay: float
    """Delay given by the user, samples; 0: search it."""
    max_delay: float
    """samples"""
    max_log_tau: float
    """log of samples"""
    op_span: float
    """OP units"""
    period: float
    """Dominant period of OP, samples."""
    op_speed: float
    """Mean speed of OP without its noise, OP units per sample."""


def pose(window: LoopWindow) -> Problem | str:
    """Return the problem, or in plain words why the window poses none."""
    known = window.valid
    n = len(window)
    if known.sum() < LEAST_SAMPLES:
        return f"{known.sum()} samples with both OP and PV, at least {LEAST_SAMPLES} are needed"
    if window.op_span <= 0:
        return "OP does not move"
    if np.ptp(window.pv[known]) <= 0:
        return "PV does not move"
    op = bridge(window.op)
    period = dominant_period(op)
    known &= ~after_gaps(window.op, period)
    if known.sum() < LEAST_SAMPLES or np.ptp(window.pv[known]) <= 0:
        return "OP has so many gaps that PV answers to them all the time"
    weight = known.astype(np.float64)
    basis = nuisance_basis(weight, SLOW_TERMS if n >= APART * period else 0)
    pv = np.where(known, window.pv, 0.0)
    pv = (pv - basis @ (basis.T @ pv)) * weight
    max_delay = max(8.0, min(0.8 * period, n / 8))
    fixed = float(window.hints.delay or 0)
    return Problem(
        op=op,
        pv=pv,
        weight=weight,
        basis=basis,
        gain_sign=process_gain_sign(window),
        fixed_delay=fixed,
        max_delay=max(max_delay, fixed),
        max_log_tau=math.log(n),
        op_span=float(np.ptp(op)),
        period=period,
        op_speed=smooth_speed(op, period),
    )


def bridge(op: FloatArray) -> FloatArray:
    """Draw a line through each gap, level before the first and after the last known value."""
    known = np.flatnonzero(np.isfinite(op))
    return np.interp(np.arange(len(op)), known, op[known])


def after_gaps(op: FloatArray, period: float) -> NDArray[np.bool_]:
    """Return where PV still answers to OP that was not recorded, (n,).

    A line bridges what is short against the period (samples). After a longer gap nothing counts for twice its
    length, at most half a period: valve and process are elsewhere, and a sticking valve would explain that.
    """
    answering = np.zeros(len(op), dtype=np.bool_)
    edges = np.flatnonzero(np.diff(~np.isfinite(op), prepend=False, append=False))
    for first, end in edges.reshape(-1, 2):
        length = end - first
        if length > SHORT_GAP * period:
            answering[end : end + int(min(2 * length, period / 2))] = True
    return answering


def nuisance_basis(weight: FloatArray, slow_terms: int) -> FloatArray:
    """Orthonormal columns for level, slope and ``slow_terms`` half-cosines over the record, (n, 2 + k)."""
    position = (np.arange(len(weight)) + 0.5) / len(weight)
    columns = [np.ones_like(position), position]
    columns += [np.cos(math.pi * k * position) for k in range(1, slow_terms + 1)]
    orthonormal, _ = np.linalg.qr(np.stack(columns, axis=1) * weight[:, None])
    return np.ascontiguousarray(orthonormal)


def dominant_period(op: FloatArray) -> float:
    """Return the period of the highest line of OP with at least three cycles in the record, samples."""
    n = len(op)
    spectrum = np.abs(np.fft.rfft((op - op.mean()) * np.hanning(n)))
    spectrum[:3] = 0.0
    return n / max(int(np.argmax(spectrum)), 3)


def smooth_speed(op: FloatArray, period: float) -> float:
    """Return the mean |dOP| per sample after averaging over a twelfth of a period, OP units."""
    width = max(1, int(period / 12))
    smooth = np.convolve(op, np.full(width, 1 / width), mode="valid")
    return float(np.mean(np.abs(np.diff(smooth)))) or float(np.ptp(op)) / len(op)
