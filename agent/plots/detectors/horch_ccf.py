"""The correlation of OP and PV between its zero crossings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.plots.axes import MEASURED, MODEL, SET_POINT

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.analysis.stiction.horch_ccf import CrossCorrelation


def draw(axes: Axes, seen: CrossCorrelation) -> None:
    """Draw the correlation over the lag and mark the first crossing to each side of lag 0."""
    axes.axhline(0.0, color=SET_POINT, linewidth=0.8)
    axes.axvline(0.0, color=SET_POINT, linewidth=0.8)
    axes.plot(seen.lag, seen.r, color=MEASURED, linewidth=1.1)
    axes.plot([-seen.left, seen.right], [0.0, 0.0], "o", color=MODEL, markersize=5, label="first crossings")
    axes.set_xlabel("lag of PV behind OP (samples)")
    axes.set_ylabel("correlation of OP and PV")
    axes.legend(frameon=False, fontsize=8)
