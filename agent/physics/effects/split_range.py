"""Trim in two straight parts, with or without a gap between them: split range, a worn or a staged plug."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts, Parameter, Stage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

WIDEST = 0.5
"""Widest gap, over OP's span."""
RATIO = (0.25, 4.0)
"""Of the slope above to that below; beyond it one part hardly moves PV, which is a stop."""
EDGE = 0.05
"""Part of OP's span at either end in which a part would be too short to have a slope."""
PLACES, WIDTHS, RATIOS = 12, (0.0, 0.1, 0.25), (0.5, 1.0, 2.0)
"""Gaps from which a search begins."""


@dataclass(frozen=True, slots=True)
class SplitRange:
    """Two slopes with a gap between them in which OP moves no flow.

    The valve moves beyond the gap: one that ends with the travel is a stop, and counts as no gap.
    """

    name: str = "split_range"
    family: str = "valve_characteristic"
    stage: Stage = "valve"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return where the lower part ends, the width of the gap, and the slope above over that below."""
        low, high = facts.op_low + EDGE * facts.op_span, facts.op_high - EDGE * facts.op_span
        return (
            Parameter("place", "OP", low, high),
            Parameter("width", "OP", 0.0, WIDEST * facts.op_span, null=0.0, natural=True),
            Parameter("ratio", "1", *RATIO, null=1.0, log=True),
        )

    def spotted(self, residual: FloatArray, facts: Facts) -> FloatArray:  # noqa: ARG002
        """Return gaps and bends all over OP's span, (m, 3)."""
        places = facts.op_low + facts.op_span * np.arange(1, PLACES + 1) / (PLACES + 1)
        return np.array(
            [
                (place, width * facts.op_span, ratio)
                for place in places
                for width in WIDTHS
                for ratio in RATIOS
                if (width, ratio) != (0.0, 1.0)
            ]
        )

    def apply(self, position: FloatArray, values: FloatArray, ts: float) -> FloatArray:  # noqa: ARG002
        """Return the flow, in OP units of the lower part."""
        place, width, ratio = (float(value) for value in values)
        least, most = float(position.min()), float(position.max())
        if (width == 0.0 and ratio == 1.0) or place + width > most - EDGE * (most - least):
            return position
        above = np.maximum(position - place - width, 0.0)
        return np.asarray(np.minimum(position, place) + ratio * above)
