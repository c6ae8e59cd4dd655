"""PV and any number of models on one axis, the blocks that were held out marked."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from agent.plots.axes import MEASURED, legend_above, tidy
from agent.plots.time_units import time_of
from agent.plots.workbench.palette import COLOURS, HELD_OUT
from agent.report.comparison_text import in_words

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


def overlay_figure(
    loop: str,
    ts: float,
    pv: FloatArray,
    models: Mapping[str, FloatArray],
    fold: NDArray[np.int64] | None = None,
) -> Figure:
    """Draw PV, the models with their fit, and below it their residuals.

    Args:
        loop: Name for the title.
        ts: s.
        pv: PV units, (n,), NaN where it counts for nothing.
        models: PV of each in free run, PV units, (n,).
        fold: With which fold each sample was held out, -1 with none, (n,); None: nothing was.
    """
    figure = Figure(figsize=(12.0, 6.0), layout="constrained")
    upper, lower = panels = figure.subplots(2, 1, sharex=True, height_ratios=(1.6, 1.0))
    time, unit = time_of(len(pv), ts)
    upper.plot(time, pv, color=MEASURED, linewidth=1.1, label="PV measured")
    for colour, (name, model) in zip(cycle(COLOURS), models.items(), strict=False):
        label = f"{in_words(name)} (fit {fit_percent(pv, model):.1f} %)"
        upper.plot(time, model, color=colour, linewidth=1.0, label=label)
        lower.plot(time, pv - model, color=colour, linewidth=0.8)
    if fold is not None:
        edges = np.flatnonzero(np.diff(fold)) + 1
        for block in np.split(np.arange(len(fold)), edges):
            _mark(upper, time[block], int(fold[block[0]]))
    lower.axhline(0, color=MEASURED, linewidth=0.6)
    upper.set_ylabel("PV (PV units)")
    lower.set_ylabel("residual (PV units)")
    lower.set_xlabel(f"time from the start of the record ({unit})")
    for axes in panels:
        tidy(axes)
    legend_above(upper, columns=4)
    figure.align_ylabels(panels)
    held = "" if fold is None else "; numbers: held-out fold of each block"
    figure.suptitle(f"{loop}: free run from OP{held}", x=0.01, ha="left", fontsize=12)
    return figure


def fit_percent(pv: FloatArray, model: FloatArray) -> float:
    """Return 100 (1 - ||PV - model|| / ||PV - mean PV||) over the samples that PV has, (n,) each."""
    known = np.isfinite(pv)
    spread = np.linalg.norm(pv[known] - pv[known].mean())
    return float(100 * (1 - np.linalg.norm(pv[known] - model[known]) / spread))


def _mark(axes: Axes, time: FloatArray, fold: int) -> None:
    """Shade every other fold and write its number at the foot."""
    if fold < 0:
        return
    if fold % 2 == 0:
        axes.axvspan(time[0], time[-1], color=HELD_OUT, linewidth=0, zorder=0)
    place = axes.get_xaxis_transform()
    axes.text(time.mean(), 0.01, str(fold + 1), transform=place, ha="center", fontsize=7, color=MEASURED)
