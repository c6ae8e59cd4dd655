"""Short windows in which OP moves and the stem does not.

Source: S. K. Damarla, B. Huang and others, 2022 and 2023; reconstructed from reference ``methods.md`` 3.14.
Settled here: slopes are compared in standard deviations of their signal, because a ratio of OP to PV units
has no meaning; the F test compares the variance about the mean with that from sample to sample, because the
variances of successive windows hardly differ where OP ramps; moves below 2 % of the span count as none; a
window is stuck where two of the three tests agree, because noise misleads each test alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy import special

from agent.analysis.results import MethodKind, MethodResult, Oscillation
from agent.analysis.stiction.shapes.stem import Stem, stem_of
from agent.analysis.stiction.shapes.stuck import LEAST_BAND

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

BoolArray = NDArray[np.bool_]

WINDOW = 6
"""Samples in a window, of about 20 a period; published are 6 to 8."""
FEWEST_WINDOWS = 15
"""Five periods have 16."""
SLOPE_RATIO = 15.0
"""Slope of OP over that of the stem beyond which the stem stands (published)."""
VARIANCE_RATIO = float(special.fdtri(WINDOW - 1, WINDOW - 1, 0.95))
"""Beyond it the F test calls a window moving, at a level of 0.05 (published)."""
FEWEST_ARRANGEMENTS = 1.96 * np.sqrt(WINDOW * (WINDOW - 1) * (2 * WINDOW + 5) / 18)
"""Pairs in falling order less those in rising order from which the arrangements are no chance at 0.05."""
STICKING, SOUND = 0.15, 0.05
"""Share of stuck windows from which, and up to which; published is any above 0. Of random_plants, seeds 0 to
39, with or without 5 % noise on the position, sticking valves have 0.18 and more, others at most 0.054."""


@dataclass(frozen=True, slots=True)
class StuckWindows:
    """What the detector measured; w windows of 6 samples each."""

    op: FloatArray
    """OP about its first value, OP units, (w, 6)."""
    position: FloatArray
    """The stem, or PV, about its first value, its own unit, (w, 6)."""
    stuck: BoolArray
    """(w,)"""
    stick_band: float | None
    """OP travel that 95 % of the stuck runs stay below, OP units; None without such runs."""

    @property
    def omega(self) -> float:
        """Share of stuck windows."""
        return float(np.mean(self.stuck))


@dataclass(frozen=True, slots=True)
class Damarla:
    """For loops with a measured valve position, and fast ones without; they need not oscillate."""

    name: str = "damarla"
    kind: MethodKind = "travel"

    def detect(self, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
        """Judge by the share of stuck windows, which is the index."""
        stem = stem_of(window, oscillation)
        if isinstance(stem, str):
            return MethodResult("not_applicable", None, stem)
        count = len(stem.op[:: stem.width]) // WINDOW
        if count < FEWEST_WINDOWS:
            reason = f"only {count} windows of {WINDOW} samples, at least {FEWEST_WINDOWS} are needed"
            return MethodResult("not_applicable", None, reason)
        seen = stuck_windows(stem)
        found = f"in {seen.omega:.0%} of the windows OP moves and the stem does not"
        if seen.stick_band is not None and seen.omega >= STICKING:
            found = f"{found}, over {seen.stick_band:.3g} OP units"
            return MethodResult("stiction", seen.omega, found, seen)
        return MethodResult("no_stiction" if seen.omega <= SOUND else "undecided", seen.omega, found, seen)


def stuck_windows(stem: Stem) -> StuckWindows:
    """Cut OP and ``stem`` into windows, one after the other, and test each."""
    op, position = (_windows(values, stem.width) for values in (stem.op, stem.position))
    votes = np.stack(
        [
            slope(op) * np.std(position) > SLOPE_RATIO * slope(position) * np.std(op),
            varies(op) & ~varies(position),
            is_arranged(op) & ~is_arranged(position),
        ]
    )
    stuck = np.sum(votes, axis=0) >= 2
    travels = [
        abs(float(op[run[-1], -1] - op[run[0], 0]))
        for is_stuck, run in (
            (key, list(each)) for key, each in groupby(range(len(op)), key=stuck.__getitem__)
        )
        if is_stuck
    ]
    return StuckWindows(op, position, stuck, float(np.percentile(travels, 95)) if travels else None)


def slope(windows: FloatArray) -> FloatArray:
    """Return the absolute slope of the least-squares line of each of ``windows`` (w, 6), per sample, (w,)."""
    time = np.arange(WINDOW) - (WINDOW - 1) / 2
    return np.asarray(np.abs(windows @ time) / np.sum(time**2))


def varies(windows: FloatArray) -> BoolArray:
    """F test: mark the windows (w, 6) that vary more about their mean than from sample to sample, (w,)."""
    from_sample_to_sample = np.mean(np.diff(windows, axis=1) ** 2, axis=1) / 2
    return np.asarray(np.var(windows, axis=1, ddof=1) > VARIANCE_RATIO * from_sample_to_sample)


def is_arranged(windows: FloatArray) -> BoolArray:
    """Reverse arrangements: mark the windows (w, 6) whose pairs fall, or rise, more than by chance, (w,)."""
    earlier, later = np.triu_indices(WINDOW, 1)
    falls = np.sum(np.sign(windows[:, earlier] - windows[:, later]), axis=1)
    return np.asarray(np.abs(falls) > FEWEST_ARRANGEMENTS)


def _windows(values: FloatArray, width: int) -> FloatArray:
    step = LEAST_BAND * float(np.ptp(values))  # without noise the least creep would be significant
    coarse = step * np.round(values[::width] / step)
    count = len(coarse) // WINDOW
    return np.asarray(coarse[: count * WINDOW].reshape(count, WINDOW))
