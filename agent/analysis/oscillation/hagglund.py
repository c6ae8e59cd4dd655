"""Load disturbances between zero crossings of the control error: Hägglund's method.

Source: T. Hägglund, "A control-loop performance monitor", Control Engineering Practice 3 (1995) 1543;
reference ``methods.md`` 2.1. The variant without the controller's integral time: the frequency in the
limit of the IAE is that of the half cycle itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.record.recording import LoopWindow
from agent.analysis.record.signals import detrended, noise_level, regularity
from agent.analysis.results import Oscillation

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

LOADS = 10
"""Loads within the supervision time that make an oscillation (n_lim of the paper)."""
SUPERVISION = 100
"""Supervision time in half cycles: 50 periods, the paper's 50 Ti where Ti is near the ultimate period."""
NOISE_SIGMAS = 3.0
"""How far noise reaches, standard deviations: no crossing and no load where the range of PV is unknown."""
MIN_PERIODS = 4
"""With fewer periods the regularity is not estimated."""


@dataclass(frozen=True, slots=True)
class HalfCycle:
    """The stretch between two zero crossings of the error."""

    duration: float
    """s."""
    iae: float
    """Integral of the absolute error, PV units times s."""

    def is_load(self, amplitude: float) -> bool:
        """Return whether its area exceeds that of half a sine of ``amplitude`` (PV units)."""
        return self.iae > 2 * amplitude * self.duration / math.pi


class HalfCycles:
    """Cuts a stream of errors at its zero crossings, in constant memory."""

    def __init__(self, ts: float, dead_band: float = 0.0) -> None:
        """Take the sampling time (s) and the error that noise may reach without crossing zero (PV units)."""
        self._ts = ts
        self._dead_band = dead_band
        self._restart()

    def _restart(self) -> None:
        self._side = 0
        self._whole = False
        self._samples = 0
        self._iae = 0.0

    def push(self, error: float) -> HalfCycle | None:
        """Take one error (PV units); return the half cycle it ends. A gap (NaN) starts anew."""
        if not math.isfinite(error):
            self._restart()
            return None
        side = self._side
        if abs(error) > self._dead_band:
            side = 1 if error > 0 else -1
        ended = None
        if side != self._side:
            if self._whole:
                ended = HalfCycle(self._samples * self._ts, self._iae)
            self._whole = self._side != 0  # what came before the first crossing is a part only
            self._side = side
            self._samples = 0
            self._iae = 0.0
        self._samples += 1
        self._iae += abs(error) * self._ts
        return ended


def half_cycles(errors: FloatArray, ts: float, dead_band: float) -> list[tuple[int, int, HalfCycle]]:
    """Return what ``HalfCycles`` gives of all errors (PV units, shape (n,)), thirty times as fast.

    Each half cycle with the sample that ends it and the number of gaps before.
    """
    outside = np.flatnonzero(np.abs(errors) > dead_band)  # NaN is not
    run = np.cumsum(~np.isfinite(errors))[outside]
    side = np.sign(errors[outside])
    crosses = np.concatenate(([True], (np.diff(run) != 0) | (np.diff(side) != 0)))[: outside.size]
    at, runs = outside[crosses].tolist(), run[crosses].tolist()
    areas = (np.abs(errors) * ts).tolist()
    return [
        (end, runs[k], HalfCycle((end - begin) * ts, sum(areas[begin:end])))
        for k, (begin, end) in enumerate(pairwise(at))
        if k > 0 and runs[k - 1] == runs[k] == runs[k + 1]  # what came before the first crossing is a part
    ]


class HagglundMonitor:
    """Online form: O(1) a sample, constant memory, no clock."""

    def __init__(self, ts: float, amplitude: float, dead_band: float = 0.0) -> None:
        """Start with no load seen.

        Args:
            ts: Sampling time, s.
            amplitude: Smallest amplitude that counts, PV units; the paper takes 1 % of the range of PV.
            dead_band: Error that noise may reach without crossing zero, PV units.
        """
        self._half_cycles = HalfCycles(ts, dead_band)
        self._ts = ts
        self._amplitude = amplitude
        self._supervision = SUPERVISION * ts
        self._loads = 0.0

    def push(self, error: float) -> bool:
        """Take the next error SP - PV (PV units, NaN for a gap); return whether the loop oscillates now."""
        self._loads *= math.exp(-self._ts / self._supervision)
        ended = self._half_cycles.push(error)
        if ended is not None:
            self._supervision = SUPERVISION * ended.duration
            self._loads += ended.is_load(self._amplitude)
        return self._loads > LOADS


@dataclass(frozen=True, slots=True)
class HagglundIae:
    """Batch form on the error of a window; the amplitude that counts follows from the noise of the record."""

    name: str = "hagglund_iae"
    noise_proof: bool = False

    def detect(self, window: LoopWindow) -> Oscillation:
        """Run the monitor over the window: the answer is that at its end."""
        error = detrended(window.error)
        noise = NOISE_SIGMAS * noise_level(error)
        cycles = half_cycles(error, window.ts, noise)
        detected = _oscillates(cycles, len(error), window.ts, noise)
        durations = [ended.duration for _, _, ended in cycles]
        periods = [rise + fall for rise, fall in zip(durations[::2], durations[1::2], strict=False)]
        if len(periods) < MIN_PERIODS:
            return Oscillation(detected, None, None)
        return Oscillation(detected, sum(periods) / len(periods), regularity(periods, window.ts))


def _oscillates(cycles: list[tuple[int, int, HalfCycle]], n: int, ts: float, amplitude: float) -> bool:
    """Return what ``HagglundMonitor`` says at the last of n samples."""
    loads, supervision, known = 0.0, SUPERVISION * ts, 0
    for end, ended in [*((end, ended) for end, _, ended in cycles), (n - 1, None)]:
        kept = math.exp(-ts / supervision)
        for _ in range(known, end + 1):
            loads *= kept
        known = end + 1
        if ended is not None:
            supervision = SUPERVISION * ended.duration
            loads += ended.is_load(amplitude)
    return loads > LOADS
