"""OP and the stem in windows; the windows in which only OP moves are shaded."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.plots.axes import MEASURED, SET_POINT, VALVE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.analysis.stiction.damarla import StuckWindows

SHOWN = 40
"""Windows drawn."""


def draw(axes: Axes, seen: StuckWindows) -> None:
    """Draw the first windows of OP and stem, each over its standard deviation."""
    width = seen.op.shape[1]
    for k in np.flatnonzero(seen.stuck[:SHOWN]):
        axes.axvspan(k * width - 0.5, (k + 1) * width - 0.5, color=SET_POINT, alpha=0.3, linewidth=0)
    for values, colour, label in ((seen.op, MEASURED, "OP"), (seen.position, VALVE, "stem or PV")):
        line = (values - values.mean()) / (values.std() or 1.0)
        axes.plot(line[:SHOWN].ravel(), color=colour, linewidth=1.1, label=label)
    axes.set_xlabel("step, about 20 a period; stuck windows are grey")
    axes.set_ylabel("standard deviations")
    axes.legend(frameon=False, fontsize=8)
