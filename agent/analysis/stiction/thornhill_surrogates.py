"""Surrogates: is the control error predicted better than a linear process with the same spectrum could be?

Source: N. F. Thornhill, "Finding the source of nonlinearity in a process with plant-wide oscillations",
IEEE Transactions on Control Systems Technology 13 (2005) 434; reconstructed from reference ``methods.md``
3.12.

The paper finds nonlinearity, and in a plant that swings as a whole the loop with most of it, whose valve is
then examined. So this detector never names stiction. A wave that repeats itself exactly has surrogates
that do so as well, and the test has no power; so a loop is called linear only where its third harmonic is
known to be absent.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.record.signals import detrended
from agent.analysis.results import MethodKind, MethodResult, Oscillation
from agent.analysis.stiction.shapes.nearest_neighbours import prediction_error
from agent.analysis.stiction.shapes.phase_surrogates import ends_matched, surrogates
from agent.analysis.stiction.shapes.stretch import longest_stretch, period_of
from agent.analysis.stiction.shapes.third_harmonic import third_harmonic
from agent.physics.processes.decimation import block_means

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

FEWEST_SAMPLES, MOST_SAMPLES = 7.0, 25.0
"""Samples a period (published); slower waves are averaged in blocks."""
FEWEST_PERIODS = 14.0
"""Twelve (published), and what is cut off to match the ends."""
MARGIN = 3.0
"""Most periods that are cut off at each end for it. Of 40 loops with a swinging load the index is above 1
in 10 with a margin of 1, in 2 with 3 (``simulators.draws.random_plants``, kind sinusoid, seeds 0 to 39)."""
MOST_BLOCKS = 1000
"""Of longer records the end is taken: the work grows with the square."""
NEIGHBOURS, COUNT = 8, 50
"""Nearest neighbours, and surrogates (published)."""
SEED = 2005
"""Every window sees the same random phases, so that a verdict can be repeated."""
GRID = 2.0**-20
"""Standardised signals are rounded to it. Sums of their squares are then exact, and ties of distance, common
in quantised signals, fall alike in all units."""


@dataclass(frozen=True, slots=True)
class SurrogateErrors:
    """What the detector measured: sums of squared prediction errors, variances of the signal."""

    error: float
    """Of the signal."""
    surrogates: FloatArray
    """Of its surrogates, (50,)."""

    @property
    def index(self) -> float:
        """Thornhill's N: how far its error is below the surrogates', in three of their deviations."""
        return float((np.mean(self.surrogates) - self.error) / (3 * np.std(self.surrogates)))


@dataclass(frozen=True, slots=True)
class ThornhillSurrogates:
    """For all loops with 14 cycles; the index is N, > 1 where the loop is not linear."""

    name: str = "thornhill_surrogates"
    kind: MethodKind = "limit_cycle"

    def detect(self, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
        """Call the loop linear, or undecided: the cause of a nonlinearity stays open."""
        stretch = longest_stretch(window)
        period = period_of(stretch, oscillation, periods=FEWEST_PERIODS, samples=FEWEST_SAMPLES)
        if isinstance(period, str):
            return MethodResult("not_applicable", None, period)
        error = detrended(stretch.error)
        block = int(np.ceil(period / MOST_SAMPLES))
        seen = surrogate_errors(block_means(error, block), period / block)
        if seen is None:
            return MethodResult("undecided", None, "the control error is constant or repeats itself exactly")
        found = f"N {seen.index:.2f}"
        if seen.index > 1:
            reason = f"the loop is not linear, the cause is not known: {found}"
            return MethodResult("undecided", seen.index, reason, seen)
        if third_harmonic(error, period) != "absent":
            reason = f"no nonlinearity is found, but a third harmonic cannot be excluded: {found}"
            return MethodResult("undecided", seen.index, reason, seen)
        return MethodResult("no_stiction", seen.index, f"the loop is linear: {found}", seen)


def surrogate_errors(values: FloatArray, period: float) -> SurrogateErrors | None:
    """Compare the prediction of ``values`` (n,), no gaps, with that of its surrogates; None without a spread.

    Args:
        values: At least 14 periods, of which the last 1000 samples are taken.
        period: Samples, 7 to 25.
    """
    last, cycle = _standardised(values[-MOST_BLOCKS:]), round(period)
    most = (len(last) - (FEWEST_PERIODS - 1) * period) / 2
    margin = int(min(MARGIN * period, max(most, period / 2 + 1)))
    x = _standardised(ends_matched(last, cycle, margin))
    errors = np.array([_error(each, cycle) for each in surrogates(x, COUNT, SEED)])
    seen = SurrogateErrors(_error(x, cycle), errors)
    return seen if float(np.std(errors)) > len(x) * GRID else None


def _error(x: FloatArray, cycle: int) -> float:
    return prediction_error(np.round(x / GRID) * GRID, cycle, NEIGHBOURS)


def _standardised(x: FloatArray) -> FloatArray:
    deviation = float(np.std(x))
    return np.zeros(len(x)) if deviation == 0 else (x - np.mean(x)) / deviation
