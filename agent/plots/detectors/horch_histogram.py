"""The histogram of PV's derivative with the two densities fitted to it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.plots.axes import MEASURED, MODEL, SET_POINT, VALVE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.analysis.stiction.horch_histogram import DerivativeHistogram


def draw(axes: Axes, seen: DerivativeHistogram) -> None:
    """Draw the histogram, the Gaussian of a broken line and the camel of a sine."""
    axes.fill_between(seen.centres, seen.density, step="mid", color=SET_POINT, alpha=0.5, linewidth=0)
    axes.step(seen.centres, seen.density, where="mid", color=MEASURED, linewidth=0.8, label="histogram")
    axes.plot(seen.centres, seen.gaussian, color=MODEL, linewidth=1.2, label="broken line: Gaussian")
    axes.plot(seen.centres, seen.camel, color=VALVE, linewidth=1.2, label="sine: camel")
    derivative = "first" if seen.order == 1 else "second"
    axes.set_xlabel(f"{derivative} difference of PV over its deviation")
    axes.set_ylabel("density")
    axes.legend(frameon=False, fontsize=8)
