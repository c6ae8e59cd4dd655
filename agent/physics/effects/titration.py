"""Gain that is highest at one value of PV and falls on both sides: pH about its neutral point."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts, Parameter, Stage
from agent.physics.effects.pv_gain import LEVELLED

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

WIDTH = (1e-3, 2.0)
"""Of the steep part, over OP's span: from a step, as of a strong acid without a buffer, to nearly a straight
line."""
OUTSIDE = 0.5
"""Of OP's span, by which the steepest place may lie beyond it: then only one side of the curve is seen."""
PLACES, WIDTHS = 15, (0.005, 0.03, 0.1, 0.3, 1.0)
"""Middles and widths, over OP's span, from which a search begins."""


@dataclass(frozen=True, slots=True)
class Titration:
    """An S-shaped curve behind the lags: asinh, which is pH over the excess of a strong acid or base."""

    name: str = "titration"
    family: str = "pv_gain"
    stage: Stage = "sensor"
    bases: tuple[str, ...] = LEVELLED

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the OP that leads to the steepest place in the long run, and the width of the steep part."""
        low, high = (each * facts.op_span for each in WIDTH)
        beyond = OUTSIDE * facts.op_span
        return (
            Parameter("middle", "OP", facts.op_low - beyond, facts.op_high + beyond),
            Parameter("width", "OP", low, high, log=True),
        )

    def spotted(self, residual: FloatArray, facts: Facts) -> FloatArray:  # noqa: ARG002
        """Return steep parts all over OP's span, (m, 2)."""
        middles = facts.op_low + facts.op_span * (np.arange(PLACES) + 0.5) / PLACES
        return np.array([(middle, width * facts.op_span) for middle in middles for width in WIDTHS])

    def apply(self, pv: FloatArray, values: FloatArray, ts: float) -> FloatArray:  # noqa: ARG002
        """Return the measured value; in the middle its slope is one."""
        middle, width = (float(value) for value in values)
        return np.asarray(width * np.arcsinh((pv - middle) / width))
