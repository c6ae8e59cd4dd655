"""Gain that depends on PV: losses that grow with temperature."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.physics.effect import Facts, Parameter, Stage
from agent.physics.effects.characteristic import bent, curvature_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

LEVELLED = ("fopdt", "sopdt", "oscillatory")
"""Bases whose response has the level of OP; an integrator's is counted from anywhere."""


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
        return (curvature_of(facts),)

    def apply(self, pv: FloatArray, values: FloatArray, ts: float) -> FloatArray:  # noqa: ARG002
        """Return the measured value; at OP 0 it has a slope of one.

        Bent about any other level the curve is the same but for gain and level; from there one curvature, and
        one gain, mean the same in every record of the loop.
        """
        return bent(pv, float(values[0]))
