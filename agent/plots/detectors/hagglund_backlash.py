"""The error, and the square of its mean height that the controller integrates to cross the dead band."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.plots.axes import MEASURED, MODEL

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.analysis.stiction.hagglund_backlash import Backlash

SHOWN = 10
"""Half cycles drawn."""


def draw(axes: Axes, seen: Backlash) -> None:
    """Draw the first half cycles of the error and the square of its mean height."""
    shown = seen.half_cycles[:SHOWN]
    first, last = shown[0].start, shown[-1].stop
    error = seen.error[first:last]
    axes.plot(np.arange(first, last), error, color=MEASURED, linewidth=1.1, label="error")
    square = seen.height * np.sign(error)
    label = f"mean height, dead band <= {seen.dead_band:.3g}"
    axes.plot(np.arange(first, last), square, color=MODEL, linewidth=1.0, linestyle="--", label=label)
    axes.set_xlabel("sample")
    axes.set_ylabel("control error (PV units)")
    axes.legend(frameon=False, fontsize=8)
