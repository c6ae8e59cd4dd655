"""The error's half cycles with the areas before and after their peaks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.plots.axes import MEASURED, MODEL, VALVE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.analysis.stiction.singhal_salsbury import PeakAreas

SHOWN = 8
"""Half cycles in the picture, from the middle of the record: of all of them none would be seen."""


def draw(axes: Axes, seen: PeakAreas) -> None:
    """Draw some half cycles of the error and fill the areas that are compared."""
    first = max(0, (len(seen.half_cycles) - SHOWN) // 2)
    shown = range(first, min(first + SHOWN, len(seen.half_cycles)))
    labels = {"before": "area before the peak", "after": "area after the peak"}
    for k in shown:
        cycle, peak = seen.half_cycles[k], seen.peaks[k]
        for name, colour, start, stop in (
            ("before", MODEL, cycle.start, peak + 1),
            ("after", VALVE, peak, cycle.stop),
        ):
            samples = np.arange(start, stop)
            label = labels.pop(name, None)
            axes.fill_between(
                samples, seen.error[start:stop], color=colour, alpha=0.45, linewidth=0, label=label
            )
    start, stop = seen.half_cycles[shown[0]].start, seen.half_cycles[shown[-1]].stop
    axes.plot(np.arange(start, stop), seen.error[start:stop], color=MEASURED, linewidth=1.0)
    axes.set_xlabel("sample")
    axes.set_ylabel("smoothed error (PV units)")
    axes.legend(frameon=False, fontsize=8)
