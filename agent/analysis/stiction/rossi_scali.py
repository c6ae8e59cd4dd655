"""A sine or a relay response: a sticking valve switches as a relay does, and PV follows it.

Source: M. Rossi, C. Scali, "A comparison of techniques for automatic detection of stiction: simulation and
application to industrial data", Journal of Process Control 15 (2005) 505; reconstructed from reference
``methods.md`` 3.7, where the shape of the answer to a relay is derived.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.results import MethodKind, MethodResult, Oscillation
from agent.analysis.stiction.shapes.fitted_half_cycles import FittedHalfCycles, shape_half_cycles
from agent.analysis.stiction.shapes.half_cycle_shapes import RELAY, SINE, TRIANGLE, fit
from agent.analysis.stiction.shapes.stretch import longest_stretch

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

LIMIT = 0.21
"""Of the index to both sides: one root mean squared error is half again as large as the other."""


def measures(half_cycles: FloatArray) -> FloatArray:
    """Return the root mean squared errors of the sine, and of relay or triangle, whichever fits better.

    Args:
        half_cycles: (m, 100).

    Returns:
        Shape (m, 2).
    """
    sine, triangle, relay = (np.sqrt(fit(half_cycles, shape).error) for shape in (SINE, TRIANGLE, RELAY))
    return np.stack([sine, np.minimum(triangle, relay)], axis=1)


def index(mean: FloatArray) -> float:
    """Return the index of the mean of ``measures`` (2,): -1 for a sine, 1 for relay or triangle."""
    sine, other = mean
    return float((sine - other) / (sine + other))


@dataclass(frozen=True, slots=True)
class RossiScali:
    """Looks at PV about its set point, in self-regulating loops."""

    name: str = "rossi_scali"
    kind: MethodKind = "limit_cycle"

    def detect(self, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
        """Judge by the limits of Rossi and Scali (2005); the index runs from -1 to 1."""
        if window.hints.integrating:
            return MethodResult(
                "not_applicable", None, "PV of an integrating loop has another response to a relay"
            )
        stretch = longest_stretch(window)
        half = shape_half_cycles(stretch.error, stretch, window, oscillation)
        if isinstance(half, str):
            return MethodResult("not_applicable", None, half)
        found = index(measures(half).mean(axis=0))
        seen = FittedHalfCycles.of(half, sine=SINE, triangle=TRIANGLE, relay=RELAY)
        if found > LIMIT:
            reason = f"PV is a relay response or a triangle rather than a sine: {found:.2f}"
            return MethodResult("stiction", found, reason, seen)
        if found < -LIMIT:
            reason = f"PV is a sine rather than a triangle or a relay response: {found:.2f}"
            return MethodResult("no_stiction", found, reason, seen)
        return MethodResult(
            "undecided", found, f"sine and relay response fit equally well: {found:.2f}", seen
        )
