"""The histogram of PV's derivative: two humps where PV is a sine, one where it is a broken line.

Source: A. Horch, "Condition Monitoring of Control Loops", PhD thesis, KTH 2000; reconstructed from reference
``methods.md`` 3.2. Added: the distribution of sine and noise keeps to the range where it has two humps,
because with a small sine it is the Gaussian and could never fit worse; the dead zone of the index; the checks
of noise and steadiness.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import optimize, signal

from agent.analysis.record.signals import noise_level
from agent.analysis.results import MethodKind, MethodResult, Oscillation
from agent.analysis.stiction.shapes.stretch import half_cycles, longest_stretch, period_of, smoothed

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

CUT_OFF = 3.0
"""Cut-off of the low-pass, frequencies of the oscillation (Horch 2000)."""
FEWEST_PERIODS = 5.0
FEWEST_SAMPLES = 10.0
"""Samples a period; with fewer the third harmonic is near the Nyquist frequency."""
LARGEST_NOISE = 0.5
"""Noise that the filter leaves in the derivative over that of a sine like PV: more would make one hump."""
LARGEST_SPREAD = 0.25
"""Standard deviation over mean of the heights of the derivative's half cycles. A wave that noise drives has a
Gaussian derivative without any valve. Of 40 such simulated loops none is below 0.28, of 40 with a sticking
valve 37 are (``simulators.draws.random_plants``, kinds tuning and stiction, seeds 0 to 39)."""
DEAD_ZONE = float(np.log(1.1))
"""An index nearer to 0 decides nothing (``methods.md`` 3.2)."""
TWO_HUMPS = 1.0 / 1.78
"""Largest noise over the amplitude of a sine at which the density of their sum has two humps (derived: the
curvature at its middle changes sign where 2 z (I0(z) - I1(z)) = I0(z) with z = (A/s)^2 / 4)."""
SINES = np.sin(np.pi * (np.arange(64) + 0.5) / 64 - np.pi / 2)
"""Values of a sine at equidistant phases."""
GAUSSIANS = ((-1.0, 0.0, 1.0), (0.05, 1.0, 3.0))
"""Lowest, first tried and highest mean and standard deviation; the derivative has 0 and 1."""
CAMELS = ((-1.0, 0.0, 1.0), (0.1, np.sqrt(2.0), 4.0), (0.05, 0.2, TWO_HUMPS))
"""The same of mean, amplitude, and noise over amplitude."""


Range = tuple[tuple[float, float, float], ...]
"""Lowest, first tried and highest value of each parameter."""
Density = Callable[["FloatArray", "FloatArray"], "FloatArray"]
"""Of parameters (p,) and places (k,): the density there, (k,)."""


@dataclass(frozen=True, slots=True)
class DerivativeHistogram:
    """What the detector measured, the derivative at mean 0 and deviation 1; all arrays have shape (k,)."""

    order: int
    """1 or 2: how often PV was differenced."""
    centres: FloatArray
    """Middles of the bins."""
    density: FloatArray
    gaussian: FloatArray
    """Density of the Gaussian that fits best."""
    camel: FloatArray
    """Density of the sum of sine and noise that fits best."""
    index: float
    """ln of the mean squared error of camel over that of Gaussian."""
    spread: float
    """Standard deviation over mean of the heights of the derivative's half cycles; infinite below three."""


@dataclass(frozen=True, slots=True)
class HorchHistogram:
    """For all loops: a sticking valve moves in steps, so PV is a broken line with few bends."""

    name: str = "horch_histogram"
    kind: MethodKind = "limit_cycle"

    def detect(self, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
        """Compare the two fits; the index is the logarithm of their ratio, > 0 where the Gaussian is better.

        For an integrating loop it takes the second difference, for a loop of unknown kind the first.
        """
        stretch, order = longest_stretch(window), 2 if window.hints.integrating else 1
        period = period_of(stretch, oscillation, periods=FEWEST_PERIODS, samples=FEWEST_SAMPLES)
        if isinstance(period, str):
            return MethodResult("not_applicable", None, period)
        if not noise_in_derivative(stretch.pv, period, order) < LARGEST_NOISE:
            return MethodResult("not_applicable", None, "too much noise on PV to use its derivative")
        seen = derivative_histogram(stretch.pv, period, order)
        if seen is None:
            return MethodResult("undecided", None, "the derivative of PV is constant")
        return _judge(seen)


def _judge(seen: DerivativeHistogram) -> MethodResult:
    if not seen.spread < LARGEST_SPREAD:
        reason = "the half cycles differ too much: noise that drives a loop gives the same histogram"
        return MethodResult("not_applicable", None, reason, seen)
    found = f"ln of the ratio of errors {seen.index:.2f}"
    if seen.index > DEAD_ZONE:
        return MethodResult("stiction", seen.index, f"PV is rather a broken line than a sine: {found}", seen)
    if seen.index < -DEAD_ZONE:
        return MethodResult(
            "no_stiction", seen.index, f"PV is rather a sine than a broken line: {found}", seen
        )
    return MethodResult("undecided", seen.index, f"sine and broken line fit equally well: {found}", seen)


def noise_in_derivative(pv: FloatArray, period: float, order: int) -> float:
    """Return the noise in the filtered derivative of ``pv`` (n,) over the derivative of a sine like ``pv``.

    White noise is taken; of it the filter leaves the frequencies up to its cut-off. ``period`` in samples.
    Infinite where ``pv`` stands still.
    """
    spread = float(np.std(pv))
    if spread == 0:
        return np.inf
    left = 2 * CUT_OFF ** (2 * order + 1) / ((2 * order + 1) * period)
    return float(noise_level(pv) / spread * np.sqrt(left))


def derivative_histogram(pv: FloatArray, period: float, order: int) -> DerivativeHistogram | None:
    """Fit both densities to the histogram of the ``order``-th difference of ``pv`` (n,).

    None where the difference is constant. ``period`` in samples.
    """
    slow = smoothed(signal.detrend(pv), period, CUT_OFF)
    edge = int(period / 2)  # where the filter has only one side to go by
    derivative = np.diff(slow, order)[edge:-edge]
    deviation = float(np.std(derivative))
    if deviation == 0:
        return None
    values = (derivative - np.mean(derivative)) / deviation
    density, edges = np.histogram(values, bins=round(np.sqrt(len(values))), density=True)
    centres = (edges[1:] + edges[:-1]) / 2
    gaussian = _best_fit(_gaussian, density, centres, GAUSSIANS)
    camel = _best_fit(_camel, density, centres, CAMELS)
    of_camel, of_gaussian = (float(np.mean((density - fit) ** 2)) for fit in (camel, gaussian))
    if min(of_camel, of_gaussian) == 0:
        return None
    index, spread = float(np.log(of_camel / of_gaussian)), _spread_of_heights(values, period)
    return DerivativeHistogram(order, centres, density, gaussian, camel, index, spread)


def _spread_of_heights(values: FloatArray, period: float) -> float:
    heights = [np.max(np.abs(values[each])) for each in half_cycles(values, period)]
    return float(np.std(heights) / np.mean(heights)) if len(heights) > 2 else np.inf


def _best_fit(
    density_of: Density,
    density: FloatArray,
    x: FloatArray,
    range_of: Range,
) -> FloatArray:
    """Return the density at ``x`` (k,) that is nearest to ``density`` (k,) in the least-squares sense."""

    def rest(parameters: FloatArray) -> FloatArray:
        return density_of(parameters, x) - density

    low, start, high = zip(*range_of, strict=True)
    return density_of(optimize.least_squares(rest, start, bounds=(low, high)).x, x)


def _gaussian(parameters: FloatArray, x: FloatArray) -> FloatArray:
    """Return the density with the given mean and standard deviation at ``x`` (k,)."""
    mean, deviation = parameters
    return np.asarray(np.exp(-(((x - mean) / deviation) ** 2) / 2) / (deviation * np.sqrt(2 * np.pi)))


def _camel(parameters: FloatArray, x: FloatArray) -> FloatArray:
    """Return the density of a sine with Gaussian noise at ``x`` (k,): mean, amplitude, noise over it."""
    mean, amplitude, noise = parameters
    around = x[:, None] - amplitude * SINES
    return np.asarray(_gaussian(np.array((mean, noise * amplitude)), around).mean(axis=1))
