"""The residual against each physical axis, with the band of no relation."""

from __future__ import annotations

from math import ceil
from textwrap import fill
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from agent.plots.axes import MEASURED, tidy
from agent.plots.workbench.palette import BAND, FAILS
from agent.report.comparison_text import causes_words
from agent.report.numbers import p_words, share_words
from agent.workbench.residual.axes import UNITS
from agent.workbench.residual.state_dependence import LEVEL

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from agent.workbench.residual.where import Failure

COLUMNS = 3
TITLE_WIDTH = 52
"""Characters of a line of a title that fit above one panel."""


def residual_panels_figure(loop: str, panels: Sequence[Failure]) -> Figure:
    """Draw the mean residual in each bin; red where the residual follows the axis beyond chance.

    Args:
        loop: Name for the title.
        panels: At least one.
    """
    rows = ceil(len(panels) / COLUMNS)
    figure = Figure(figsize=(12.0, 0.8 + 2.6 * rows), layout="constrained")
    places = figure.subplots(rows, COLUMNS, sharey=True, squeeze=False).ravel()
    for axes, panel in zip(places, panels, strict=False):
        _draw(axes, panel)
    for axes in places[len(panels) :]:
        axes.set_axis_off()
    for axes in places[::COLUMNS]:
        axes.set_ylabel("mean residual (PV units)")
    failing = [each.axis.replace("_", " ") for each in panels if each.p < LEVEL]
    words = f"depends on {', '.join(failing)}" if failing else "depends on no axis beyond chance"
    figure.suptitle(f"{loop}: the residual {words}", x=0.01, ha="left", fontsize=12)
    return figure


def _draw(axes: Axes, panel: Failure) -> None:
    fails = panel.p < LEVEL
    axes.stairs(
        panel.band_high,
        panel.bin_edges,
        baseline=panel.band_low,
        fill=True,
        color=BAND,
        label="95 % where residual and axis are unrelated",
    )
    axes.stairs(
        panel.bin_means, panel.bin_edges, baseline=None, color=FAILS if fails else MEASURED, linewidth=1.4
    )
    chance = p_words(panel.p) if fails else f"{p_words(panel.p)}, no failure"
    made_by = f"\n{fill('made by: ' + causes_words(panel.axis), TITLE_WIDTH)}" if fails else ""
    axes.set_title(f"{share_words(panel.share)} of the variance, {chance}{made_by}", fontsize=9, loc="left")
    axes.set_xlabel(f"{panel.axis.replace('_', ' ')} ({UNITS[panel.axis]})")
    tidy(axes)
