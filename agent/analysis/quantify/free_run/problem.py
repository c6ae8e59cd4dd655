"""The record as the search sees it: gaps weighted out, slow nuisance projected out, bounds set."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.analysis.controller_action import process_gain_sign

if TYPE_CHECKING:
    from agent.analysis.recording import FloatArray, LoopWindow

SLOW_TERMS = 2
"""Slow cosines beside level and slope: drift is in the base, or a drifting loop looks sticky."""
LEAST_SAMPLES = 50


class Problem(NamedTuple):
    """What the compiled objective needs; a NamedTuple because numba takes it apart by itself."""

    op: FloatArray
    """Controller output, last value held through gaps, OP units, (n,)."""
    pv: FloatArray
    """Process variable with the nuisance projected out and zero where unknown, PV units, (n,)."""
    weight: FloatArray
    """1 where OP and PV are known, else 0, (n,)."""
    basis: FloatArray
    """Orthonormal level, slope and slow cosines on the known samples, (n, 4)."""
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
    op = hold_last(window.op)
    weight = known.astype(np.float64)
    basis = nuisance_basis(weight, SLOW_TERMS)
    pv = np.where(known, window.pv, 0.0)
    pv = (pv - basis @ (basis.T @ pv)) * weight
    period = dominant_period(op)
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


def hold_last(op: FloatArray) -> FloatArray:
    """Carry the last known value through gaps: a valve without a command keeps its place."""
    index = np.where(np.isfinite(op), np.arange(len(op)), 0)
    index[0] = int(np.argmax(np.isfinite(op)))
    return np.ascontiguousarray(op[np.maximum.accumulate(index)])


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
