"""The stem over OP at the samples that become symbols, with the steps in which only OP moves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.plots.axes import MODEL, SET_POINT

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.analysis.stiction.yamashita import QualitativeShape


SHOWN = 400
"""Steps in the picture; a day is a solid block."""


def draw(axes: Axes, seen: QualitativeShape) -> None:
    """Draw the stem over OP in the first steps and mark the steps IS and DS."""
    axes.plot(seen.op[: SHOWN + 1], seen.position[: SHOWN + 1], color=SET_POINT, linewidth=0.7)
    (stuck,) = np.nonzero(np.isin(seen.symbols[:SHOWN], ("IS", "DS")))
    gap = np.full(len(stuck), np.nan)  # between two steps no line is drawn
    op, position = (
        np.column_stack((each[stuck], each[stuck + 1], gap)).ravel() for each in (seen.op, seen.position)
    )
    axes.plot(op, position, color=MODEL, linewidth=1.1, label="only OP moves")
    axes.set_xlabel("OP from its first value (OP units)")
    axes.set_ylabel("stem, or PV in its place")
    axes.legend(loc="upper left", frameon=False, fontsize=8)
