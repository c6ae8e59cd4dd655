"""The squared bicoherence over pairs of frequencies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.stiction.bicoherence import F1, F2, LINES
from agent.plots.axes import MODEL

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.analysis.stiction.bicoherence import SquaredBicoherence


def draw(axes: Axes, seen: SquaredBicoherence) -> None:
    """Draw the principal domain, with the highest value marked where the loop is not linear."""
    surface = np.full((F2.max() + 1, F1.max() + 1), np.nan)
    surface[F2, F1] = seen.squared
    periods = 1 / (LINES * seen.frequency)
    f1, f2 = (np.arange(size) * periods for size in surface.shape[::-1])
    image = axes.pcolormesh(f1, f2, surface, cmap="viridis", shading="nearest", vmin=0.0, vmax=1.0)
    scale = axes.inset_axes((0.04, 0.9, 0.38, 0.05))  # the domain leaves this corner free
    axes.figure.colorbar(image, cax=scale, orientation="horizontal", label="squared bicoherence")
    if seen.nonlinear:
        low, high = (each / seen.frequency for each in seen.peak)
        axes.plot(high, low, "o", markersize=9, markerfacecolor="none", markeredgecolor=MODEL)
    axes.set_xlabel("f1 over the frequency of the oscillation")
    axes.set_ylabel("f2 over the same")
