"""A sine or a triangle: behind a valve that jumps the first integrator of the loop draws a triangle.

Sources: Q. P. He, J. Wang, M. Pottmann, S. J. Qin, "A curve fitting method for detecting valve stiction in
oscillating control loops", Industrial & Engineering Chemistry Research 46 (2007) 4549; for OP alone the
report of He and Pottmann (2003); reference ``methods.md`` 3.6.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.results import MethodKind, MethodResult, Oscillation
from agent.analysis.stiction.shapes.fitted_half_cycles import FittedHalfCycles, shape_half_cycles
from agent.analysis.stiction.shapes.half_cycle_shapes import SINE, TRIANGLE, fit
from agent.analysis.stiction.shapes.stretch import longest_stretch

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

SINE_UP_TO, TRIANGLE_FROM = 0.4, 0.6


def measures(half_cycles: FloatArray) -> FloatArray:
    """Return the mean squared errors of sine and triangle for each of ``half_cycles`` (m, 100), (m, 2)."""
    return np.stack([fit(half_cycles, shape).error for shape in (SINE, TRIANGLE)], axis=1)


def index(mean: FloatArray) -> float:
    """Return He's stiction index of the mean of ``measures`` (2,): 0 for a sine, 1 for a triangle."""
    sine, triangle = mean
    return float(sine / (sine + triangle))


@dataclass(frozen=True, slots=True)
class HeCurveFit:
    """Looks at OP, which integrates the error; in integrating loops at PV, which integrates the flow."""

    name: str = "he_curve_fit"
    kind: MethodKind = "limit_cycle"

    def detect(self, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
        """Judge by the limits of He (2007); a loop of unknown kind is taken as self-regulating.

        The index is the mean squared error of the sine over that of sine and triangle, 0 to 1.
        """
        stretch = longest_stretch(window)
        name, values = ("PV", stretch.error) if window.hints.integrating else ("OP", stretch.op)
        half = shape_half_cycles(values, stretch, window, oscillation)
        if isinstance(half, str):
            return MethodResult("not_applicable", None, half)
        si = index(measures(half).mean(axis=0))
        seen = FittedHalfCycles.of(half, sine=SINE, triangle=TRIANGLE)
        if si >= TRIANGLE_FROM:
            return MethodResult("stiction", si, f"{name} is a triangle rather than a sine: {si:.2f}", seen)
        if si <= SINE_UP_TO:
            return MethodResult("no_stiction", si, f"{name} is a sine rather than a triangle: {si:.2f}", seen)
        return MethodResult("undecided", si, f"{name} is neither a sine nor a triangle: {si:.2f}", seen)
