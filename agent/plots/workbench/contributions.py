"""What each effect adds to the model's PV."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from agent.plots.axes import tidy
from agent.plots.time_units import time_of
from agent.plots.workbench.palette import COLOURS

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


def contributions_figure(loop: str, ts: float, added: Mapping[str, FloatArray]) -> Figure:
    """Draw the model less the model without each effect, one panel an effect, all to one scale.

    Args:
        loop: Name for the title.
        ts: s.
        added: By each effect, at least one, PV units, (n,).
    """
    figure = Figure(figsize=(12.0, 1.0 + 1.7 * len(added)), layout="constrained")
    panels = figure.subplots(len(added), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    for axes, colour, (name, values) in zip(panels, cycle(COLOURS), added.items(), strict=False):
        time, unit = time_of(len(values), ts)
        axes.plot(time, values, color=colour, linewidth=0.9)
        axes.set_title(name.replace("_", " "), fontsize=10, loc="left")
        axes.set_ylabel("PV units")
        tidy(axes)
    panels[-1].set_xlabel(f"time from the start of the record ({unit})")
    figure.suptitle(f"{loop}: contribution of each effect to PV", x=0.01, ha="left", fontsize=12)
    return figure
