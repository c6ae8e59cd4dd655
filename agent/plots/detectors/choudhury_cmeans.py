"""The most regular cycles of OP and PV, and the two clusters of OP where PV is near its mean."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.plots.axes import MEASURED, MODEL, SET_POINT, VALVE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.analysis.stiction.choudhury_cmeans import Clusters


def draw(axes: Axes, seen: Clusters) -> None:
    """Draw the points, the strip, and the apparent stiction as the distance of the centres."""
    axes.plot(seen.cycles.op, seen.cycles.pv, ".", color=MEASURED, markersize=3, label="OP and PV, filtered")
    axes.axhspan(-seen.strip, seen.strip, color=SET_POINT, alpha=0.4, linewidth=0)
    label = f"centres, {seen.apparent:.3g} apart"
    axes.plot(seen.centres, (0.0, 0.0), color=VALVE, linewidth=2)
    axes.plot(seen.centres, (0.0, 0.0), "o", color=MODEL, markersize=7, label=label)
    axes.set_xlabel("OP (OP units)")
    axes.set_ylabel("PV (PV units)")
    axes.legend(frameon=False, fontsize=8)
