"""The next test at the loop: what OP does, and what either model would measure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from agent.plots.axes import MEASURED, MODEL, VALVE, legend_above, tidy
from agent.plots.time_units import time_of

if TYPE_CHECKING:
    from agent.workbench.design.next_test import NextTest


def next_test_figure(loop: str, test: NextTest) -> Figure | None:
    """Draw OP of a test, and PV that both models predict with the band of the noise; None without a test."""
    if test.plan is None or test.predicted is None:
        return None
    figure = Figure(figsize=(10.0, 4.6), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    time, unit = time_of(len(test.plan.op), test.ts)
    above.step(time, test.plan.op, where="post", color=MEASURED, linewidth=1.2)
    above.set_ylabel("OP")
    for pv, name, colour in zip(test.predicted, (test.first, test.second), (MODEL, VALVE), strict=True):
        below.plot(time, pv, color=colour, linewidth=1.2, label=f"PV with {name}")
        below.fill_between(time, pv - test.noise, pv + test.noise, color=colour, alpha=0.15, linewidth=0)
    below.set_ylabel("PV less its mean")
    below.set_xlabel(f"time from the start of the test ({unit})")
    legend_above(below)
    for axes in (above, below):
        tidy(axes)
    figure.suptitle(f"{loop}: the next test", x=0.01, ha="left", fontsize=12)
    return figure
