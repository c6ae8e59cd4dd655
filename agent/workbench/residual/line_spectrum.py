"""Lines in the spectrum of a residual: made by the loop's own cycle, or from outside.

A valve that sticks puts odd harmonics of OP's cycle into the residual, and they stay locked to OP's reversals
however the cycle varies. A wave from outside keeps its own frequency over the whole record.
Reference ``missing_effect.md`` section 3. The limits are ours, from simulation (``tests/unit/workbench``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy import fft, optimize, signal

from agent.analysis.oscillation.spectrum import bridged, spectrum
from agent.analysis.record.reversals import NOISES, PART_OF_SPAN, op_noise
from agent.workbench.residual.axes import last_turns

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

FALSE_ALARM = 0.01
"""Probability that noise alone shows a line anywhere in the record."""
MOST_LINES = 6
FEWEST_CYCLES = 4
"""Of a line in the record: slower is drift."""
CERTAIN_CYCLES = 12
"""Of a line in the record, to be sure that it keeps its own frequency."""
SLOW_CYCLES = 24
"""In the record, up to which a residual counts as slow."""
CERTAIN_PART = 0.78
"""Part of the slow residual that one wave explains, from which on slow noise is excluded. In 594 records that
hide no wave (``simulators.draws``, seeds 91270 to 91289 and 91861 to 91924) noise makes 50 slow lines, which
explain 0.15 to 0.76 of it; true waves that show such a line explain 0.76 to 0.96, most of them over 0.8."""
STEPS = 29
"""Frequencies at which a slow wave is fitted, within one line of the spectrum."""
CENTRES = 60
"""Frequencies at which the level of the noise is taken."""
WITHIN = 1.6
"""The level is the median of the lines within this factor of a frequency, and at least of ``LEAST_LINES``."""
LEAST_LINES = 8
MEDIAN_OF_EXPONENTIAL = float(np.log(2.0))
"""Over its mean: so the lines of noise scatter about their level."""
BESIDE = 3
"""Lines to each side that the window smears a line over."""
HARMONICS = 5
OFF = 0.15
"""Distance from a harmonic, in frequencies of OP's cycle, from which a line is no harmonic. Power that is
nearer to a line, in parts of its frequency, belongs to the line."""
CLEARLY = 1.15
"""Ratio of a line's power in OP's cycles to that in time, or the reverse, from which the larger one decides.
In simulation the two agree to 1 % on even cycles, and differ by 7 to 72 % in 90 of 100 records whose period
varies by 6 %."""
CLEARLY_OUTSIDE = 2.0
"""The same of a harmonic that is to come from outside. What jitter the other edge of OP's cycle has counts as
often in its phase as its number says: a thermostat's third harmonic has 1.5."""

LineKind = Literal["locked", "coherent", "either"]


@dataclass(frozen=True, slots=True)
class Line:
    """A line that noise does not explain."""

    frequency: float
    """1/s."""
    harmonic: int | None
    """Of OP's cycle; None where it lies between them, or OP has no cycle."""
    kind: LineKind
    """``locked``: stays in phase with the reversals of OP. ``coherent``: keeps its own frequency over the
    record, so it comes from outside. ``either``: OP's cycle is so even that the record cannot distinguish the
    two."""
    alone: float
    """Part of the slow residual (``SLOW_CYCLES``) that a wave of about this frequency explains; 1 where it
    has so many cycles that slow noise makes no such line."""


@dataclass(frozen=True, slots=True)
class LineSpectrum:
    """Spectrum of a residual with its lines, the highest above the noise first. Arrays have shape (m,)."""

    frequency: FloatArray
    """1/s."""
    power: FloatArray
    """Square of the residual's unit; only ratios matter."""
    threshold: FloatArray
    """Noise passes it anywhere in ``FALSE_ALARM`` of records."""
    lines: tuple[Line, ...]

    @property
    def certain(self) -> tuple[Line, ...]:
        """Lines that are certain: slow noise may make slow ones as well, except nearly all of it."""
        return tuple(each for each in self.lines if each.alone > CERTAIN_PART)

    @property
    def from_outside(self) -> tuple[Line, ...]:
        """The certain lines that certainly come from outside."""
        return tuple(each for each in self.certain if each.kind == "coherent")


def line_spectrum(residual: FloatArray, op: FloatArray, ts: float) -> LineSpectrum | None:
    """Return the spectrum of a residual (n,), NaN where there is none, and its lines.

    Args:
        residual: PV less model, PV units.
        op: Without gaps, OP units, (n,).
        ts: s.

    Returns:
        None where the residual is constant or too short to have a spectrum.
    """
    whole = bridged(residual - np.nanmean(residual)) if np.isfinite(residual).any() else None
    if whole is None or len(whole) < 4 * FEWEST_CYCLES:
        return None
    found = spectrum(whole)
    frequency, power = found.frequency[FEWEST_CYCLES:-1], found.power[FEWEST_CYCLES:-1]
    threshold = -np.log1p(-((1 - FALSE_ALARM) ** (1 / len(power)))) * _noise(power)
    cycles = cycles_of(op)
    slow = CERTAIN_CYCLES / FEWEST_CYCLES * float(frequency[0])
    lines = tuple(_line(whole, cycles, frequency[at], ts, slow) for at in _peaks(power / threshold))
    return LineSpectrum(frequency / ts, power, threshold, lines)


def cycles_of(op: FloatArray) -> FloatArray:
    """Return how many cycles OP (n,) has made, growing evenly from low to low.

    NaN before the first and after the last, everywhere where it makes fewer than ``FEWEST_CYCLES``. Where the
    record begins is no low, though OP may rise from there.
    """
    turn, direction = last_turns(op, max(NOISES * op_noise(op), PART_OF_SPAN * float(np.ptp(op))))
    lows = np.setdiff1d(turn[direction > 0], [0])
    if len(lows) <= FEWEST_CYCLES:
        return np.full(len(op), np.nan)
    return np.interp(np.arange(len(op)), lows, np.arange(len(lows)), left=np.nan, right=np.nan)


def _noise(power: FloatArray) -> FloatArray:
    """Return the level of the noise under the lines, (m,)."""
    lines = np.arange(len(power)) + FEWEST_CYCLES
    centres = np.unique(np.geomspace(lines[0], lines[-1], CENTRES).astype(int))
    levels = []
    for centre in centres:
        low, high = min(centre / WITHIN, centre - LEAST_LINES), max(centre * WITHIN, centre + LEAST_LINES)
        levels.append(np.median(power[(lines >= low) & (lines <= high)]) / MEDIAN_OF_EXPONENTIAL)
    least = np.finfo(float).tiny
    smooth = np.interp(np.log(lines), np.log(centres), np.log(np.maximum(levels, least)))
    return np.asarray(np.exp(smooth), dtype=np.float64)


def _peaks(ratio: FloatArray) -> Iterator[int]:
    """Yield where power is above its threshold, the highest first, each with its surroundings once."""
    rest = ratio.copy()
    for _ in range(MOST_LINES):
        at = int(np.argmax(rest))
        if rest[at] < 1:
            return
        yield at
        beside = max(BESIDE, round(OFF * (at + FEWEST_CYCLES)))
        rest[max(at - beside, 0) : at + beside + 1] = 0.0


def _line(values: FloatArray, cycles: FloatArray, frequency: float, ts: float, slow: float) -> Line:
    """Return the line at ``frequency``, cycles a sample; below ``slow`` noise may have made it."""
    known = np.isfinite(cycles)
    harmonic = _harmonic(frequency, cycles[known])
    if harmonic is None:
        known[:] = True
    weighted = values[known] * signal.windows.hann(int(known.sum()))
    at = np.flatnonzero(known)

    def power(turns: FloatArray) -> float:
        return float(np.abs(weighted @ np.exp(-2j * np.pi * turns)) ** 2)

    resolution = 1 / len(values)
    own = optimize.minimize_scalar(
        lambda f: -power(f * at), bounds=(frequency - resolution, frequency + resolution), method="bounded"
    )
    kind: LineKind = "coherent"
    if harmonic is not None:
        coherent, locked = -own.fun, power(harmonic * cycles[known])
        kind = "locked" if locked > CLEARLY * coherent else "either"
        clearly = CLEARLY if harmonic == 1 else CLEARLY_OUTSIDE
        kind = "coherent" if coherent > clearly * locked else kind
    alone = _alone(values, float(own.x)) if own.x < slow else 1.0
    return Line(float(own.x) / ts, harmonic, kind, alone)


def _alone(values: FloatArray, frequency: float) -> float:
    """Return which part of a slow residual, (n,), a wave of about a frequency, 1/sample, explains."""
    along = fft.dct(values, norm="ortho")
    along[2 * SLOW_CYCLES :] = 0.0
    slow = fft.idct(along, norm="ortho")
    slow = slow - slow.mean()
    at, least = np.arange(len(slow)), np.inf
    for tried in frequency + np.linspace(-1.0, 1.0, STEPS) / len(slow):
        turns = 2 * np.pi * tried * at
        columns = np.column_stack((np.cos(turns), np.sin(turns), np.ones(len(slow))))
        left = slow - columns @ np.linalg.lstsq(columns, slow, rcond=None)[0]
        least = min(least, float(left @ left))
    return 1 - least / max(float(slow @ slow), np.finfo(float).tiny)


def _harmonic(frequency: float, cycles: FloatArray) -> int | None:
    """Return the harmonic of OP's cycle at a frequency, cycles a sample; None if it is none."""
    if not cycles.size:
        return None
    ratio = frequency * len(cycles) / (cycles[-1] - cycles[0])
    nearest = round(ratio)
    return nearest if 1 <= nearest <= HARMONICS and abs(ratio - nearest) < OFF else None
