"""S of a valve against time, with its interval, jumps and the limit."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import TYPE_CHECKING

from matplotlib.dates import date2num
from matplotlib.figure import Figure

from agent.analysis.results import NORMAL_90

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.memory.s_day import SDay
    from agent.analysis.wear.trend import Trend


def trend_figure(loop: str, days: Sequence[SDay], trend: Trend, limit: float | None = None) -> Figure:
    """Return the figure.

    Args:
        loop: Its name.
        days: What was seen of S, day by day.
        trend: What follows from it.
        limit: OP units; None: none is drawn.
    """
    figure = Figure(figsize=(9, 4), layout="constrained")
    axes = figure.add_subplot()
    shown = [each for each in days if each.above is None]
    axes.errorbar(
        [_date(each.time) for each in shown],
        [each.s for each in shown],
        yerr=[NORMAL_90 * each.sd for each in shown],
        fmt=".",
        color="0.6",
        label="S of a day, 90 %",
    )
    for marker, larger in (("v", False), ("^", True)):
        dividing = [
            (_date(each.time), divides)
            for each in days
            if each.above is not None
            for divides, above in each.divided(recognised=True)
            if (above > 0) == larger
        ]
        if dividing:
            name = f"S is probably {'larger' if larger else 'smaller'}"
            at, bounds = zip(*dividing, strict=True)
            axes.plot(at, bounds, marker, color="0.6", label=name)
    when = [_date(each.time) for each in trend.levels]
    axes.plot(when, [each.s for each in trend.levels], color="C0", label="trend")
    axes.fill_between(
        when, [each.low for each in trend.levels], [each.high for each in trend.levels], alpha=0.2, color="C0"
    )
    for jump in trend.jumps:
        name = "repair" if jump.repair else "jump"
        axes.axvline(_date(jump.time), color="C2" if jump.repair else "C1", linestyle="--", label=name)
    if limit is not None:
        axes.axhline(limit, color="C3", linestyle=":", label=f"limit {limit:.3g}")
    axes.set(title=f"{loop}: stick band plus dead band against time", ylabel="S, OP units")
    axes.set_ylim(bottom=0.0)
    axes.xaxis_date()
    axes.legend(loc="upper left", fontsize="small")
    return figure


def _date(time: float) -> float:
    return float(date2num(datetime.fromtimestamp(time, UTC)))
