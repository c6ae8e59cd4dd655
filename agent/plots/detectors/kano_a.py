"""OP and stem over time, with the stretches in which only OP moves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.plots.axes import MEASURED, MODEL, VALVE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.analysis.record.recording import FloatArray
    from agent.analysis.stiction.shapes.stuck import StuckIntervals

SHOWN = 100
"""Samples of the stem in the picture, in widths of its moving mean: five periods."""


def draw(axes: Axes, seen: StuckIntervals) -> None:
    """Draw the first periods of OP and stem, each over its own span."""
    last = min(SHOWN * seen.stem.width, len(seen.stem.op))
    axes.plot(_over_span(seen.stem.op)[:last], color=MEASURED, linewidth=1.0, label="OP")
    axes.plot(_over_span(seen.stem.position)[:last], color=VALVE, linewidth=1.0, label="stem")
    label = "only OP moves"
    for each in seen.intervals:
        if each.start < last:
            axes.axvspan(each.start, min(each.stop, last), color=MODEL, alpha=0.2, linewidth=0, label=label)
            label = "_"  # one entry in the legend is enough
    axes.set_xlabel("sample")
    axes.set_ylabel("part of its span")
    axes.legend(loc="upper right", fontsize=8)


def _over_span(values: FloatArray) -> FloatArray:
    return np.asarray((values - np.min(values)) / np.ptp(values))
