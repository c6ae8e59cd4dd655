"""The prediction errors of the surrogates, and that of the signal."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.plots.axes import MODEL, SET_POINT, VALVE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.analysis.stiction.thornhill_surrogates import SurrogateErrors


def draw(axes: Axes, seen: SurrogateErrors) -> None:
    """Draw the histogram of the surrogates, the error of the signal and the limit of N."""
    limit = float(np.mean(seen.surrogates) - 3 * np.std(seen.surrogates))
    axes.hist(seen.surrogates, bins=12, color=SET_POINT, label=f"{len(seen.surrogates)} surrogates")
    axes.axvline(limit, color=VALVE, linewidth=1.2, linestyle="--", label="N = 1")
    axes.axvline(seen.error, color=MODEL, linewidth=1.6, label="control error")
    axes.set_xlabel("sum of squared prediction errors over the variance")
    axes.set_ylabel("surrogates")
    axes.legend(frameon=False, fontsize=8)
