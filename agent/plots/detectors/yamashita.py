"""The stem over OP at the samples that become symbols, with the steps in which only OP moves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.plots.axes import MODEL, SET_POINT

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.analysis.stiction.yamashita import QualitativeShape


def draw(axes: Axes, seen: QualitativeShape) -> None:
    """Draw the stem over OP and mark the steps IS and DS."""
    axes.plot(seen.op, seen.position, color=SET_POINT, linewidth=0.7)
    (stuck,) = np.nonzero(np.isin(seen.symbols, ("IS", "DS")))
    gap = np.full(len(stuck), np.nan)  # between two steps no line is drawn
    op, position = (
        np.column_stack((each[stuck], each[stuck + 1], gap)).ravel() for each in (seen.op, seen.position)
    )
    axes.plot(op, position, color=MODEL, linewidth=1.1, label="only OP moves")
    axes.set_xlabel("OP from its first value (OP units)")
    axes.set_ylabel("stem, or PV in its place")
    axes.legend(frameon=False, fontsize=8)
