"""Gain that depends on PV: losses that grow with temperature."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts, Parameter, Stage
from agent.physics.effects.characteristic import REACH, STEEPEST

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

LEVELLED = ("fopdt", "sopdt", "oscillatory")
"""Bases whose response has the level of OP; an integrator's is counted from anywhere."""

MOST_BENT = 100.0
"""Curvature times response at most: one that integrates goes far beyond OP, and its square must be finite."""


@dataclass(frozen=True, slots=True)
class PvGain:
    """Slope from what the process does to what is measured, which grows or falls at a constant rate.

    The curve lies behind the lags, that of a trim before them. Over the range of a record the losses of a hot
    vessel are nearly such a curve.
    """

    name: str = "pv_gain"
    family: str = "pv_gain"
    stage: Stage = "sensor"
    bases: tuple[str, ...] = LEVELLED

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the curvature, as of ``characteristic``."""
        farthest = max(abs(facts.op_low), abs(facts.op_high))
        most = min(STEEPEST / facts.op_span, REACH / farthest)
        return (Parameter("curvature", "1/OP", -most, most, null=0.0),)

    def apply(self, pv: FloatArray, values: FloatArray, ts: float) -> FloatArray:  # noqa: ARG002
        """Return the measured value; at OP 0 it has a slope of one.

        Bent about any other level the curve is the same but for gain and level; from there one curvature, and
        one gain, mean the same in every record of the loop.
        """
        curvature = float(values[0])
        if curvature == 0.0:
            return pv
        return np.asarray(np.expm1(np.minimum(curvature * pv, MOST_BENT)) / curvature)
