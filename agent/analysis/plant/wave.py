"""Oscillations of every loop of a plant, on one clock.

Several a loop, each from its own peak of the spectrum (Thornhill, Huang and Zhang, J. Process Control 13
(2003) 91; ``agent.analysis.oscillation.acf_filtered``). Loops are compared over the time that all of them
have in common.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import signal

from agent.analysis.oscillation.acf_filtered import band_passed, components
from agent.analysis.oscillation.spectrum import bridged
from agent.analysis.record.signals import detrended

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray, LoopWindow

    ComplexArray = NDArray[np.complex128]

SAME = 0.1
"""Periods of one loop that differ by less are one oscillation; so is a whole fraction of a stronger one's."""
HARMONICS = np.arange(2, 8)
FEWEST_SAMPLES = 100
"""On the common clock; with fewer nothing is compared."""


@dataclass(frozen=True, slots=True)
class CommonRecord:
    """Control errors and OP of all loops at the same instants; each array has shape (n,), no gaps."""

    loops: tuple[str, ...]
    start: float
    """s UTC."""
    ts: float
    """s."""
    errors: tuple[FloatArray, ...]
    """PV units, as a part of their largest value, without their trend."""
    ops: tuple[FloatArray, ...]
    """OP, likewise."""


@dataclass(frozen=True, slots=True)
class Wave:
    """One oscillation of one loop."""

    place: int
    """Of the loop in the record."""
    period: float
    """s."""
    share: float
    """Part of the power of its signal, 0 to 1."""


def common_record(windows: Sequence[LoopWindow]) -> CommonRecord:
    """Return what the loops have in common; those that share no time with the others are left out.

    Args:
        windows: One of each loop. The longest sampling time among them is that of the result.
    """
    ts = max(each.ts for each in windows)
    longest = max(windows, key=lambda each: len(each) * each.ts)
    kept = [each for each in windows if _overlap(each, longest) >= FEWEST_SAMPLES * ts]
    start = max(each.start for each in kept)
    end = min(each.start + (len(each) - 1) * each.ts for each in kept)
    count = max(int((end - start) / ts) + 1, 0)
    times = np.asarray(start + ts * np.arange(count), dtype=np.float64)
    rows = [(each.loop, _at(each, each.error, times), _at(each, each.op, times)) for each in kept]
    rows = [row for row in rows if row[1] is not None and row[2] is not None]
    names, errors, ops = ([row[k] for row in rows] for k in range(3))
    return CommonRecord(tuple(names), start, ts, tuple(errors), tuple(ops))  # type: ignore[arg-type]


def waves(record: CommonRecord) -> list[Wave]:
    """Return all oscillations of all loops."""
    found = []
    for place, values in enumerate(record.errors):
        kept: list[Wave] = []
        for each in sorted(components(values, record.ts), key=lambda one: -(one.share or 0.0)):
            period = each.period or 0.0
            if period and not any(belongs(period, other.period) for other in kept):
                kept.append(Wave(place, period, each.share or 0.0))
        found += kept
    return found


def share_of(values: FloatArray, period: float) -> float:
    """Return the part of a signal's power (n,) around a period (samples), 0 to 1."""
    power = float(np.mean((values - np.mean(values)) ** 2))
    return float(np.mean(band_passed(values, period) ** 2)) / power if power > 0 else 0.0


def phasor(values: FloatArray, period: float) -> ComplexArray:
    """Return a signal (n,) around a period (samples) as a complex wave of the mean square 1, (n,)."""
    wave = signal.hilbert(band_passed(values, period))
    edge = min(round(period), len(wave) // 8)  # where the filter sees past the ends
    wave = wave[edge : len(wave) - edge]
    size = float(np.sqrt(np.mean(np.abs(wave) ** 2)))
    return np.asarray(wave / size if size > 0 else wave, dtype=np.complex128)


def belongs(period: float, stronger: float) -> bool:
    """Return whether a period is that of a stronger oscillation, or of a harmonic of it."""
    ratio = stronger / period
    return abs(ratio - 1) < SAME or bool(np.any(np.abs(ratio / HARMONICS - 1) < SAME / 2))


def _overlap(one: LoopWindow, other: LoopWindow) -> float:
    ends = (each.start + len(each) * each.ts for each in (one, other))
    return min(ends) - max(one.start, other.start)


def _at(window: LoopWindow, values: FloatArray, times: FloatArray) -> FloatArray | None:
    """Return a signal at other times, gaps bridged; None where it is mostly gaps."""
    whole = bridged(detrended(values))
    if whole is None or times.size < FEWEST_SAMPLES:
        return None
    return np.asarray(np.interp(times, window.time, whole), dtype=np.float64)
