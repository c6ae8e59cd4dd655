"""The cycles under their nearest template."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.analysis.stiction.shapes.half_cycle_shapes import T
from agent.analysis.stiction.srinivasan_dtw import TEMPLATES
from agent.plots.axes import MEASURED, MODEL, SET_POINT, VALVE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.analysis.stiction.srinivasan_dtw import LabelledCycles

COLOURS = dict(zip(TEMPLATES, (MODEL, MEASURED, VALVE, "#8256a8", "#b58900"), strict=True))
MOST = 40
"""Cycles drawn; more would be a block of ink."""


def draw(axes: Axes, seen: LabelledCycles) -> None:
    """Draw the cycles, and each template that is the nearest of some."""
    every = -(-len(seen.cycles) // MOST)
    axes.plot(T, seen.cycles[::every].T, color=SET_POINT, linewidth=0.5, alpha=0.6)
    for k, (name, template) in enumerate(TEMPLATES.items()):
        count = int((seen.labels == k).sum())
        if count:
            axes.plot(T, template, color=COLOURS[name], linewidth=1.4, label=f"{name}: {count} cycles")
    axes.set_xlabel("time over the period")
    axes.set_ylabel("standard deviations")
    axes.legend(frameon=False, fontsize=8)
