"""The most regular cycles of OP and PV, and the ellipse through them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.plots.axes import MEASURED, MODEL, VALVE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.analysis.stiction.choudhury_ellipse import OpPvEllipse


def draw(axes: Axes, seen: OpPvEllipse) -> None:
    """Draw the points, the ellipse, and the apparent stiction as the chord along OP."""
    ellipse = seen.ellipse
    angle = np.linspace(0.0, 2 * np.pi, 200)
    u, v = np.cos(angle), np.sin(angle) * np.sqrt(ellipse.a / ellipse.c)
    radius = 1 / np.sqrt(ellipse.a * u * u + ellipse.b * u * v + ellipse.c * v * v)
    axes.plot(seen.cycles.op, seen.cycles.pv, ".", color=MEASURED, markersize=3, label="OP and PV, filtered")
    axes.plot(ellipse.x0 + radius * u, ellipse.y0 + radius * v, color=MODEL, linewidth=1.2, label="ellipse")
    chord = ellipse.x0 + seen.apparent * np.array((-0.5, 0.5))
    axes.plot(chord, (ellipse.y0, ellipse.y0), color=VALVE, linewidth=2, label=f"width {seen.apparent:.3g}")
    axes.set_xlabel("OP (OP units)")
    axes.set_ylabel("PV (PV units)")
    axes.legend(frameon=False, fontsize=8)
