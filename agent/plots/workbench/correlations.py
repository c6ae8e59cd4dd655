"""Is the residual white, and does it follow what OP did before? Two correlograms with their bands."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from agent.plots.axes import MEASURED, tidy
from agent.plots.workbench.palette import BAND, FAILS
from agent.report.numbers import p_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.workbench.residual.whiteness import Correlogram


def correlations_figure(loop: str, white: Correlogram | None, independent: Correlogram | None) -> Figure:
    """Draw both; a panel of what could not be computed stays empty.

    Args:
        loop: Name for the title.
        white: Autocorrelation of the residual.
        independent: Of its innovations with OP before them.
    """
    figure = Figure(figsize=(12.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    _draw(left, white, "residual with its own past", "coloured noise fails this test, too")
    _draw(right, independent, "innovations with OP before them", "an incomplete model fails this test")
    figure.suptitle(f"{loop}: correlations of the residual", x=0.01, ha="left", fontsize=12)
    return figure


def _draw(axes: Axes, found: Correlogram | None, what: str, meaning: str) -> None:
    axes.set_xlabel("lag (samples)")
    axes.set_ylabel("correlation")
    tidy(axes)
    if found is None:
        axes.set_title(f"{what}: too few samples", fontsize=9, loc="left")
        return
    lags = np.arange(1, 1 + len(found.correlation))
    beyond = np.abs(found.correlation) > found.band
    axes.fill_between(lags, -found.band, found.band, color=BAND, linewidth=0, label="99 % band")
    for inside, colour in ((~beyond, MEASURED), (beyond, FAILS)):
        axes.vlines(lags[inside], 0, found.correlation[inside], color=colour, linewidth=1.6)
    axes.axhline(0, color=MEASURED, linewidth=0.6)
    axes.set_title(f"{what}: {p_words(found.p)} ({meaning})", fontsize=9, loc="left")
