"""Trends of S from entries of the history, printed and drawn."""

from __future__ import annotations

import json
import re
from collections import defaultdict
from typing import TYPE_CHECKING

import typer

from agent.cli.common.errors import BAD_INPUT, complain

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from agent.analysis.memory.s_day import SDay
    from agent.runtime.store.history_file import Entry

NOT_KNOWN = {"s": None, "log_ratio": None}
"""Of diagnoses of an older slipjump, which did not compare a window with the former S."""


def show_trends(entries: Sequence[Entry], limit: float | None, plot: Path | None, *, as_json: bool) -> None:
    """Print the trend of each loop that has one; draw it where a folder is given."""
    from agent.analysis.wear.trend import reaches, trend_of
    from agent.report.trend_words import trend_json, trend_lines

    shown = 0
    for loop, days in s_days_of(entries).items():
        trend = trend_of(days)
        if trend is None:
            continue
        shown += 1
        reached = None if limit is None else reaches(trend, limit)
        if as_json:
            typer.echo(json.dumps(trend_json(loop, trend, reached), allow_nan=False))
        else:
            for line in trend_lines(loop, trend, reached):
                typer.echo(line)
        if plot is not None:
            from agent.plots.trend import trend_figure

            try:
                plot.mkdir(parents=True, exist_ok=True)
                name = re.sub(r"[^A-Za-z0-9_-]", "_", loop)
                trend_figure(loop, days, trend, limit).savefig(plot / f"{name}-trend.png")
            except OSError as error:
                complain(f"{plot}: cannot be written: {error.strerror}")
                raise typer.Exit(BAD_INPUT) from error
    if not shown:
        complain("no loop showed S on three days at least: no trend")


def s_days_of(entries: Sequence[Entry]) -> dict[str, tuple[SDay, ...]]:
    """Return S by day of each loop, from the diagnoses among the entries, the oldest first."""
    from agent.analysis.memory.s_day import s_of_window, with_s

    found: dict[str, tuple[SDay, ...]] = defaultdict(tuple)
    for entry in entries:
        if entry.kind != "diagnosis":
            continue
        s = entry.content["stiction"]["s"]
        numbers = (s["value"], s["low"], s["high"])
        former = entry.content.get("as_before", NOT_KNOWN)
        before = None if former["s"] is None else (former["s"], former["log_ratio"])
        shows = entry.content.get("fit", {}).get("would_show")
        seen = s_of_window(entry.time, numbers, entry.content.get("probability"), before, shows)
        if seen is not None:
            found[entry.loop] = with_s(found[entry.loop], seen, 1.0)
    return dict(found)
