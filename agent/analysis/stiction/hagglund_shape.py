"""A sine or a square: behind a valve that is stuck the control error stands still.

Source: T. Hägglund, "A shape-analysis approach for diagnosis of stiction in control valves", Control
Engineering Practice 19 (2011) 782; reference ``methods.md`` 3.13.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.results import MethodKind, MethodResult, Oscillation
from agent.analysis.stiction.shapes.fitted_half_cycles import FittedHalfCycles, shape_half_cycles
from agent.analysis.stiction.shapes.half_cycle_shapes import POINTS, T
from agent.analysis.stiction.shapes.stretch import longest_stretch

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow


def shapes_of_same_area(half_cycles: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return sine and square with the area of each of ``half_cycles`` (m, 100), both (m, 100)."""
    area = half_cycles.mean(axis=1, keepdims=True)
    return np.pi / 2 * area * np.sin(np.pi * T), area * np.ones(POINTS)


def measures(half_cycles: FloatArray) -> FloatArray:
    """Return the index of each of ``half_cycles`` (m, 100), -1 for a sine to 1 for a square, shape (m, 1)."""
    from_sine, from_square = (
        np.sum((half_cycles - shape) ** 2, axis=1) for shape in shapes_of_same_area(half_cycles)
    )
    return np.asarray((from_sine - from_square) / (from_sine + from_square))[:, None]


def index(mean: FloatArray) -> float:
    """Return the index of the mean of ``measures`` (1,)."""
    return float(mean[0])


@dataclass(frozen=True, slots=True)
class HagglundShape:
    """Looks at the control error of self-regulating loops.

    It finds the square waves of fast processes. An index below zero does not show a sound valve: a triangle
    has -0.88.
    """

    name: str = "hagglund_shape"
    kind: MethodKind = "limit_cycle"

    def detect(self, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
        """Judge by the limit 0 of Hägglund (2011); the index runs from -1 to 1."""
        if window.hints.integrating:
            return MethodResult("not_applicable", None, "an integrating loop never makes a square wave")
        stretch = longest_stretch(window)
        half = shape_half_cycles(stretch.error, stretch, window, oscillation)
        if isinstance(half, str):
            return MethodResult("not_applicable", None, half)
        found = index(measures(half).mean(axis=0))
        sine, square = (shape.mean(axis=0) for shape in shapes_of_same_area(half))
        seen = FittedHalfCycles(half, {"sine": sine, "square": square})
        if found > 0:
            return MethodResult(
                "stiction", found, f"the error is a square wave rather than a sine: {found:.2f}", seen
            )
        reason = f"the error is not a square wave, as with a free valve or a slow process: {found:.2f}"
        return MethodResult("undecided", found, reason, seen)
