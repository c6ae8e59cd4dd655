"""The record as the search sees it: gaps weighted out, slow parts filtered out, bounds set.

The valve is simulated at the native rate of OP; its position and PV are then averaged over blocks, so that a
period has at least forty of them. Both pass the same high-pass filter: drift, a moving set point and the
integral of every small error of the valve leave the objective, and the rest of an error stays where it
was made.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple, TypeVar

import numpy as np

from agent.identify.arrays import FloatArray
from agent.jit import kernel, summing_kernel
from agent.physics.processes.decimation import block_means

if TYPE_CHECKING:
    from numpy.typing import NDArray

Delay = TypeVar("Delay", float, FloatArray)

BLOCKS_PER_PERIOD = 40
"""Samples of a period that are kept; fewer would blur the slips."""
PASS_TIME = 0.5
"""Time constant of the high-pass filter, periods: it passes 95 % of the oscillation."""
LEAST_PASS_TIME = 2.0
"""Its least, blocks: a filter that is faster than the samples leaves their differences only."""
BURN = 0.5
"""Start of the record that does not count, periods, at most a twelfth of it: what was before is not known."""
LEAST_SAMPLES = 50
STROKE_TIME = 1.5
"""Periods in which a loop that swings shows the whole range of its OP."""
FIRST_LOOK = 5
"""Periods that a search looks at first."""
QUIET = 0.5
"""Range of OP in that time, over the usual one, below which the loop does not swing yet."""
SETTLES = 2.0
"""Periods after a long gap until the model has forgotten it: with half a period S of a simulated valve was
12 % too small, with two 6 %."""
NUISANCE = 3
"""Columns that every basis has: level, slope and the end of the filter's memory."""
OVER = 1e-9
"""Start-up, over its first value, that has died away."""
SHORT_GAP = 1 / 12
"""Length of a gap in OP, in periods, up to which a straight line stands for what is missing."""


class Problem(NamedTuple):
    """What the compiled objective needs; a NamedTuple because numba takes it apart by itself."""

    op: FloatArray
    """Controller output, a straight line through each gap, OP units, (n,)."""
    block: int
    """Samples in a block."""
    keep: float
    """Pole of the high-pass filter, per block."""
    pv: FloatArray
    """Filtered block means of PV, the nuisance projected out, zero where unknown, PV units, (m,)."""
    weight: FloatArray
    """1 where OP and PV are known and the model can know what PV answers to, else 0, (m,)."""
    basis: FloatArray
    """Orthonormal level, slope and end of the filter's memory on the blocks that count, (m, 3).

    Column by column in memory, so that the sums over each are added several at once.
    """
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
    quiet: int
    """Samples before the loop begins to swing: what counts periods counts them from there."""
    whitening: FloatArray
    """Coefficients of the autoregression behind which PV and responses to OP stand, (p,); none: p = 0."""


def pose(
    signal_op: FloatArray,
    signal_pv: FloatArray,
    gain_sign: int = 0,
    fixed_delay: int = 0,
    pass_time: float = PASS_TIME,
    least_blocks: int = 1,
) -> Problem | str:
    """Return the problem, or in plain words why the record poses none.

    Args:
        signal_op: OP units, NaN where unknown, (n,).
        signal_pv: PV units, likewise.
        gain_sign: Sign of the process gain; 0 where both are possible.
        fixed_delay: Delay that the user gave, samples; 0: search it.
        pass_time: Time constant of the high-pass filter, periods.
        least_blocks: Of the record, as far as there are samples.
    """
    known = np.isfinite(signal_op) & np.isfinite(signal_pv)
    n = len(signal_op)
    if known.sum() < LEAST_SAMPLES:
        return f"{known.sum()} samples with both OP and PV, at least {LEAST_SAMPLES} are needed"
    if np.ptp(signal_op[np.isfinite(signal_op)]) <= 0:
        return "OP does not move"
    if np.ptp(signal_pv[known]) <= 0:
        return "PV does not move"
    op = bridge(signal_op)
    period = dominant_period(op)
    known &= ~after_gaps(signal_op, period) & ~after_gaps(signal_pv, period)
    block = max(1, min(int(period / BLOCKS_PER_PERIOD), n // least_blocks))
    counts = block_means(known.astype(np.float64), block) == 1.0
    counts[: int(min(BURN * period, n / 12) / block)] = False
    pv = block_means(bridge(signal_pv), block)
    if counts.sum() < LEAST_SAMPLES or np.ptp(pv[counts]) <= 0:
        return "OP has so many gaps that PV answers to them all the time"
    keep = math.exp(-block / max(pass_time * period, LEAST_PASS_TIME * block))
    weight = counts.astype(np.float64)
    pv, basis = behind_high_pass(pv, weight, keep)
    max_delay = max(8.0, min(0.8 * period, n / 8))
    fixed = float(fixed_delay)
    return Problem(
        op=op,
        block=block,
        keep=keep,
        pv=pv,
        weight=weight,
        basis=basis,
        gain_sign=gain_sign,
        fixed_delay=fixed,
        max_delay=max(max_delay, fixed),
        max_log_tau=math.log(4 * period),
        op_span=float(np.ptp(op)),
        period=period,
        op_speed=smooth_speed(op, period),
        quiet=quiet_start(op, period),
        whitening=np.empty(0),
    )


def behind_high_pass(pv: FloatArray, weight: FloatArray, keep: float) -> tuple[FloatArray, FloatArray]:
    """Return block means of PV, (m,), filtered, with the nuisance projected out, and its basis, (m, 3)."""
    basis = nuisance_basis(weight, keep)
    pv = high_pass(pv - pv[weight > 0].mean(), keep)
    return (pv - basis @ (basis.T @ (pv * weight))) * weight, basis


def first_periods(problem: Problem, periods: float) -> Problem:
    """Return the problem of the first ``periods`` periods, at least 80 blocks; infinite: all of it."""
    if math.isinf(periods):
        return problem
    m = first_blocks(problem, periods, 80)
    weight = problem.weight[:m]
    basis = nuisance_basis(weight, problem.keep)
    pv = problem.pv[:m]
    return problem._replace(
        op=problem.op[: m * problem.block],
        pv=(pv - basis @ (basis.T @ pv)) * weight,
        weight=weight,
        basis=basis,
    )


def first_blocks(problem: Problem, periods: float, least: int) -> int:
    """Return how many blocks the first ``periods`` periods of the swinging loop end with, at least some.

    A valve that rests shows nothing, so that the first periods of a record that begins at rest would let the
    search choose among valves none of which has moved. A part whose blocks lie in gaps shows nothing either:
    it goes on until ``LEAST_SAMPLES`` of them count.
    """
    end = math.ceil((problem.quiet + periods * problem.period) / problem.block)
    shows = int(np.searchsorted(np.cumsum(problem.weight), LEAST_SAMPLES)) + 1
    return min(len(problem.pv), max(least, end, shows))


def bridge(signal: FloatArray) -> FloatArray:
    """Draw a line through each gap, level before the first and after the last known value."""
    known = np.flatnonzero(np.isfinite(signal))
    return np.interp(np.arange(len(signal)), known, signal[known])


@kernel
def high_pass(signal: FloatArray, keep: float) -> FloatArray:
    """Return the signal less its slow part, from rest at its first value, same unit, (m,)."""
    passed = np.empty(signal.size)
    rest = 0.0
    for t in range(signal.size):
        if t > 0:
            rest = keep * (rest + signal[t] - signal[t - 1])
        passed[t] = rest
    return passed


def after_gaps(signal: FloatArray, period: float) -> NDArray[np.bool_]:
    """Return where PV still answers to OP that was not recorded, (n,).

    A line bridges what is short against the period (samples). After a longer gap nothing counts for twice its
    length, at most half a period: valve and process are elsewhere, and a sticking valve would explain that.
    After one of a period or more, as a stretch in manual, the model needs two periods to forget it.
    """
    answering = np.zeros(len(signal), dtype=np.bool_)
    edges = np.flatnonzero(np.diff(~np.isfinite(signal), prepend=False, append=False))
    for first, end in edges.reshape(-1, 2):
        length = end - first
        if length > SHORT_GAP * period:
            settles = SETTLES * period if length >= period else min(2 * length, period / 2)
            answering[end : end + int(settles)] = True
    return answering


def nuisance_basis(weight: FloatArray, keep: float) -> FloatArray:
    """Orthonormal columns for level, slope and the end of the filter's memory, (m, 3)."""
    orthonormal, _ = np.linalg.qr(_nuisance(len(weight), keep) * weight[:, None])
    return np.asfortranarray(orthonormal)


@summing_kernel
def along_column(column: FloatArray, response: FloatArray, startup_pole: float) -> tuple[float, float]:
    """Return the parts of a response and of the start-up along one more column of a basis, (m,) each.

    A record whose load is a wave has two more. ``startup_pole`` is 0 where there is no start-up.
    """
    startup = 0.0 if startup_pole == 0.0 else 1.0
    along = along_startup = 0.0
    for t in range(response.size):
        along += column[t] * response[t]
        if startup >= OVER:
            along_startup += column[t] * startup
        startup *= startup_pole
    return along, along_startup


def nuisance_of(passed: FloatArray, counts: NDArray[np.bool_], keep: float) -> FloatArray:
    """Return level, slope and the end of the filter's memory of a filtered signal, its unit, (n,).

    Args:
        passed: Behind ``high_pass``, (n,).
        counts: Samples from which they are estimated, (n,).
        keep: Pole of the filter.
    """
    columns = _nuisance(len(passed), keep, first=int(np.argmax(counts)))
    solved, *_ = np.linalg.lstsq(columns[counts], passed[counts], rcond=None)
    return columns @ solved


def _nuisance(n: int, keep: float, first: int = 0) -> FloatArray:
    """Return the columns, (n, 3); the memory ends from ``first`` on and is not drawn back before it."""
    at = np.arange(n, dtype=np.float64)
    return np.stack([np.ones_like(at), at / n, keep ** np.maximum(at - first, 0.0)], axis=1)


def dominant_period(op: FloatArray) -> float:
    """Return the period of the highest line of OP with at least three cycles in the record, samples."""
    n = len(op)
    spectrum = np.abs(np.fft.rfft((op - op.mean()) * np.hanning(n)))
    spectrum[:3] = 0.0
    return n / max(int(np.argmax(spectrum)), 3)


def quiet_start(op: FloatArray, period: float) -> int:
    """Return how many samples of ``op`` (n,) pass before it swings about as far as it usually does.

    None in a record of few periods: all of it is looked at from the first, and OP may not swing at all.
    """
    if len(op) < FIRST_LOOK * period:
        return 0
    step, width = max(1, int(period / 4)), int(STROKE_TIME * period)
    begins = np.arange(0, max(1, len(op) - width + 1), step)
    ranges = np.array([np.ptp(op[begin : begin + width]) for begin in begins])
    return int(begins[np.argmax(ranges >= QUIET * np.median(ranges))])


def smooth_speed(op: FloatArray, period: float) -> float:
    """Return the mean |dOP| per sample after averaging over a twelfth of a period, OP units."""
    width = max(1, int(period / 12))
    smooth = np.convolve(op, np.full(width, 1 / width), mode="valid")
    return float(np.mean(np.abs(np.diff(smooth)))) or float(np.ptp(op)) / len(op)


@kernel
def to_blocks(delay: Delay, block: int) -> Delay:
    """Return the lag in blocks of a delay in samples, from the block's end to its middle."""
    return (delay - 1.0) / block + (block + 1.0) / (2.0 * block)


@kernel
def from_blocks(delay: float, block: int) -> float:
    """Return the delay in samples of a lag in blocks, the inverse of ``to_blocks``."""
    return (delay - (block + 1.0) / (2.0 * block)) * block + 1.0
