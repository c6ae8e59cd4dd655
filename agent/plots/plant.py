"""The groups of a plant: control errors one above the other, the likeliest root of each group on top."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from agent.plots.axes import MEASURED, MODEL, tidy

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.plant.plant import PlantFinding
    from agent.analysis.record.recording import LoopWindow

PERIODS = 8
"""Of the group that are drawn: the last of the record."""


def plant_figure(finding: PlantFinding, windows: Sequence[LoopWindow]) -> Figure:
    """Return the figure, a panel for each group of loops.

    Args:
        finding: With at least one group.
        windows: Those that it was made of.
    """
    by_loop = {each.loop: each for each in windows}
    heights = [len(group.suspects) for group in finding.groups]
    figure = Figure(figsize=(8, 1 + 0.35 * sum(heights) + 0.6 * len(heights)), layout="constrained")
    panels = figure.subplots(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
    for axes, group in zip(panels, finding.groups, strict=True):
        names = [each.loop for each in group.suspects]
        for place, name in enumerate(names):
            window = by_loop[name]
            shown = window.time >= window.time[-1] - PERIODS * group.period
            values = window.error[shown]
            size = np.nanmax(np.abs(values - np.nanmean(values))) or 1.0
            colour = MODEL if place == 0 else MEASURED
            time = window.time[shown] - window.time[-1]
            axes.plot(time, -place + 0.45 * (values - np.nanmean(values)) / size, color=colour, lw=0.9)
        axes.set_yticks([-k for k in range(len(names))], names)
        axes.set_title(f"period {group.period:.4g} s, likeliest root {group.root}", loc="left", fontsize=10)
        tidy(axes)
    panels[-1].set_xlabel("time before the end of the record, s")
    return figure
