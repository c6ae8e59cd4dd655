"""Whether the record holds a limit cycle: steady, enough periods and samples, made by the loop itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.gates.fast_line import fast_line
from agent.analysis.gates.fault import ALL_KINDS, LIMIT_CYCLE, GateFault

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import Oscillation

COARSE = "coarse"
"""Name of the fault of too few samples a period."""
FEWEST_PERIODS = 5.0
"""Shapes are means over so many periods at least (``methods.md`` 3)."""
FEWEST_SAMPLES = 12.0
"""Samples a period below which no method can judge the valve: the third harmonic, which distinguishes a
triangle or a square from a sine, then has fewer than four samples, and a slip is as short as a sample.
Learnt on simulated loops (``benchmarks.sampling_rate``): sticking valves are cleared at six and fewer, and at
ten the interval of S does not hold where the record is of means. Means are not recognised, so their limit
is that of all."""
ADVISED_SAMPLES = 50.0
"""Samples a period that Lee, Ren and Huang (2008) need."""
MOST_SET_POINT = 0.2
"""Span of SP, part of that of PV, up to which the oscillation is the loop's own."""


def rhythm_faults(window: LoopWindow, oscillation: Oscillation) -> list[GateFault]:
    """Return the faults of the oscillation: coarse samples close all methods, others limit cycles."""
    cycle = (*_set_point(window), *_oscillation(window, oscillation))
    return [*_coarse(window, oscillation), *(GateFault(name, reason, LIMIT_CYCLE) for name, reason in cycle)]


def samples_per_period(window: LoopWindow, oscillation: Oscillation) -> float | None:
    """Return the samples that a period has; None where nothing oscillates.

    Of an oscillation that is too fast for the detectors where there is one, else of that which was detected:
    the detectors may find a small slow one beside it.
    """
    lines = [line for line in (fast_line(window.op), fast_line(window.pv)) if line is not None]
    fast = [line for line in lines if line < FEWEST_SAMPLES]
    if fast:
        return min(fast)
    if not oscillation.detected or oscillation.period is None:
        return None
    return oscillation.period / window.ts


def _coarse(window: LoopWindow, oscillation: Oscillation) -> list[GateFault]:
    samples = samples_per_period(window, oscillation)
    if samples is None or samples >= FEWEST_SAMPLES:
        return []
    advice = f"record a sample every {samples * window.ts / ADVISED_SAMPLES:.2g} s, and no means"
    reason = f"a period has only {samples:.1f} samples, at least {FEWEST_SAMPLES:.0f} are needed; {advice}"
    return [GateFault(COARSE, reason, ALL_KINDS)]


def _set_point(window: LoopWindow) -> list[tuple[str, str]]:
    if window.sp is None:
        return []
    sp = window.sp[window.valid & np.isfinite(window.sp)]
    share = float(np.ptp(sp) / np.ptp(window.pv[window.valid])) if sp.size else 0.0
    if share <= MOST_SET_POINT:
        return []
    return [("sp_moves", f"the set point moves by {share:.0%} of the span of PV")]


def _oscillation(window: LoopWindow, oscillation: Oscillation) -> list[tuple[str, str]]:
    if not oscillation.detected or oscillation.period is None:
        return [("no_oscillation", "the loop does not oscillate")]
    if oscillation.regularity is None or oscillation.regularity <= 1:
        return [("unsteady", "the period is not regular, or the record holds too few periods")]
    faults = []
    periods = len(window) * window.ts / oscillation.period
    if periods < FEWEST_PERIODS:
        reason = f"the record holds only {periods:.1f} periods, at least {FEWEST_PERIODS:.0f} are needed"
        faults.append(("few_periods", reason))
    return faults
