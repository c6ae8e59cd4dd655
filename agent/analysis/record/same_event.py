"""Whether two recordings of a loop show the same event, so that it must not count twice.

They do where their dates overlap, and where OP is the same but for a shift, as in files with a wrong date.
Two days of one loop look alike as well: ramps have the same level but for noise, limit cycles the same
increments. What is one and the same has both.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft
from scipy.stats import rankdata

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray, LoopWindow

    ComplexArray = NDArray[np.complex128]

LEVELS, INCREMENTS = 0.985, 0.85
"""Correlation of OP, and of the ranks of its increments, from which two records are one.

Set on 144 pairs of simulated days of one loop and 96 records taken twice, once half a sample later: those
taken twice have at least 0.99 and 0.94; two days have up to 0.997 or up to 0.90, and never at one shift as
much as this of both. Ranks, for else the kick that a step of the set point gives OP would be all there is.
"""
FEW = 5
"""Samples of which the mean is taken, and over which an increment: two exports of one event are not sampled
at the same instants."""
LEAST_OVERLAP = 0.5
"""Share of the shorter record that a shift must leave to compare."""
COMMON_TIME = 0.1
"""Share of the shorter record from which dates that overlap make one event of two: a file that begins with
the last samples of the former is another."""
A_DATE = 1e8
"""Time from which it is a date (1973), s UTC; less is a clock that begins with each file."""


def one_of_each(windows: Sequence[LoopWindow]) -> list[int]:
    """Return for each record the index of that which stands for its event: the longest, often itself."""

    def rank(k: int) -> tuple[float, float, str]:
        return -len(windows[k]) * windows[k].ts, windows[k].start, windows[k].loop

    stands = list(range(len(windows)))
    by_length = sorted(stands, key=rank)
    for place, k in enumerate(by_length):
        longer = (j for j in by_length[:place] if stands[j] == j)
        stands[k] = next((j for j in longer if same_event(windows[j], windows[k])), k)
    return stands


def same_event(one: LoopWindow, other: LoopWindow) -> bool:
    """Whether two records show the same."""
    if min(one.start, other.start) > A_DATE:
        ends = [each.start + len(each) * each.ts for each in (one, other)]
        common = min(ends) - max(one.start, other.start)
        if common > COMMON_TIME * min(len(one) * one.ts, len(other) * other.ts):
            return True
    ts = max(one.ts, other.ts)
    first, second = _smooth(one, ts), _smooth(other, ts)
    alike = correlations(first, second) >= LEVELS
    return bool(np.any(alike & (correlations(_ranks(first), _ranks(second)) >= INCREMENTS)))


def correlations(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the correlation of two signals (n,) and (m,) at each shift; -1 where too little is to compare.

    NaN is left out. The place of a shift in the answer depends on n and m only.
    """
    size = next_fast_len(len(one) + len(other), real=True)
    (here, x, x2), (there, y, y2) = _spectra(one, size), _spectra(other, size)

    def sums(left: ComplexArray, right: ComplexArray) -> FloatArray:
        return np.asarray(irfft(np.conj(left) * right, size), dtype=np.float64)

    count = sums(here, there)
    enough = count >= max(2.0, LEAST_OVERLAP * min(np.isfinite(one).sum(), np.isfinite(other).sum()))
    count = np.maximum(count, 1.0)
    sum_x, sum_y = sums(x, there), sums(here, y)
    squares = (sums(x2, there) - sum_x**2 / count, sums(here, y2) - sum_y**2 / count)
    # What does not move within the overlap is alike to anything; rounding leaves it a little more than zero.
    moving = [each > 1e-9 * max(float(each.max()), 1e-300) for each in squares]
    good = enough & moving[0] & moving[1]
    found = np.full(size, -1.0)
    product = (sums(x, y) - sum_x * sum_y / count)[good]
    found[good] = product / np.sqrt(squares[0][good] * squares[1][good])
    return found


def _spectra(values: FloatArray, size: int) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Return the spectra of where a signal (n,) is known, of it less its mean, and of the square of that."""
    known = np.isfinite(values)
    away = np.where(known, values - np.mean(values[known]), 0.0) if known.any() else np.zeros(len(values))
    first, second, third = (rfft(each, size) for each in (known.astype(np.float64), away, away**2))
    return first, second, third


def _smooth(window: LoopWindow, ts: float) -> FloatArray:
    """Return the mean of OP over each ``FEW`` samples that are ``ts`` s apart, (n,); NaN beside a gap."""
    op = window.op
    if window.ts != ts:
        time = window.ts * np.arange(len(window))
        op = np.interp(np.arange(0.0, time[-1] + ts / 2, ts), time, op)
    return op if len(op) < FEW else np.convolve(op, np.full(FEW, 1 / FEW), "valid")


def _ranks(values: FloatArray) -> FloatArray:
    """Return the ranks of the increments of a signal (n,) over ``FEW`` samples, the first unknown, (n,)."""
    steps = np.full(len(values), np.nan)
    steps[FEW:] = values[FEW:] - values[:-FEW]
    known = np.isfinite(steps)
    steps[known] = rankdata(steps[known])
    return steps
