"""The half cycles of a record, their mean, and the shapes fitted to them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.analysis.stiction.shapes.half_cycle_shapes import T
from agent.plots.axes import MEASURED, MODEL, SET_POINT, VALVE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.analysis.stiction.shapes.fitted_half_cycles import FittedHalfCycles

COLOURS = {"sine": MODEL, "triangle": VALVE, "square": VALVE, "relay": "#8256a8"}
MOST = 40
"""Half cycles drawn; more would be a block of ink."""


def draw(axes: Axes, seen: FittedHalfCycles) -> None:
    """Draw the half cycles on top of each other, their mean, and the mean of the fits of each shape."""
    every = -(-len(seen.half_cycles) // MOST)
    height = seen.half_cycles.mean(axis=0).max()
    axes.plot(T, seen.half_cycles[::every].T / height, color=SET_POINT, linewidth=0.5, alpha=0.6)
    axes.plot(T, seen.half_cycles.mean(axis=0) / height, color=MEASURED, linewidth=1.8, label="mean")
    for name, shape in seen.fits.items():
        axes.plot(T, shape / height, color=COLOURS[name], linewidth=1.2, linestyle="--", label=name)
    axes.set_xlabel("time between zero crossings")
    axes.set_ylabel("height over the peak of the mean")
    axes.legend(frameon=False, fontsize=8)
