"""The list of valves as pages of a PDF."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from agent.durations import duration_words
from agent.plots.axes import MEASURED, MODEL, VALVE, tidy
from agent.report.fleet.quality_words import quality_words
from agent.report.fleet.table import probability_words, stick_band, what_next

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from matplotlib.axes import Axes

    from agent.report.fleet.rows import ValveRow

A4 = (11.7, 8.3)
"""Landscape, inches."""
ROWS = 6
"""Valves on a page."""
LETTERS = 62
"""Characters of a line of text beside a picture."""
LINES, PAGE_LETTERS = 50, 190
"""Lines of a page of text, and characters of each."""


def fleet_pages(rows: Sequence[ValveRow], title: str, not_read: Sequence[str] = ()) -> Iterator[Figure]:
    """Yield the pages, the most urgent valve first.

    Args:
        rows: At least one.
        title: At the top of each page.
        not_read: What could not be read, a line each; on a page of its own.
    """
    pages = -(-len(rows) // ROWS)
    for page in range(pages):
        figure = Figure(figsize=A4, layout="constrained")
        figure.suptitle(f"{title} ({page + 1} of {pages})", x=0.01, ha="left", fontsize=12)
        grid = figure.subplots(ROWS, 3, width_ratios=(1.5, 1.0, 1.0), squeeze=False)
        for place, (text, pv, op) in enumerate(grid):
            number = page * ROWS + place
            for axes in (text, pv, op):
                axes.set_axis_off()
            if number < len(rows):
                _draw(number + 1, rows[number], text, pv, op)
        yield figure
    for first in range(0, len(not_read), LINES):
        figure = Figure(figsize=A4)
        figure.suptitle(f"{title}: not read", x=0.01, ha="left", fontsize=12)
        words = "\n".join(textwrap.shorten(each, PAGE_LETTERS) for each in not_read[first : first + LINES])
        figure.text(0.01, 0.93, words, va="top", fontsize=7)
        yield figure


def _draw(number: int, row: ValveRow, text: Axes, pv: Axes, op: Axes) -> None:
    lead = row.lead
    s = stick_band(lead)
    band = f", S {s} OP units" if s else ""
    colour = MODEL if row.group in ("sticks", "suspected") else MEASURED
    head = f"{number}  {row.name}: {row.words.lower()}, probability {probability_words(lead)}{band}"
    text.text(0, 0.98, head, va="top", fontsize=9, weight="bold", color=colour, wrap=True)
    lines = [f"why: {lead.reason}", f"next: {what_next(row)}", f"record: {quality_words(lead.quality)}"]
    words = "\n".join(textwrap.fill(each, LETTERS) for each in lines)
    text.text(0, 0.72, words, va="top", fontsize=7)
    small = lead.thumbnail
    if small is None:
        return
    for axes, values, colour, name in ((pv, small.pv, MEASURED, "PV"), (op, small.op, VALVE, "OP")):
        axes.set_axis_on()
        axes.plot(np.linspace(small.start, small.end, len(values)), values, color=colour, linewidth=0.8)
        axes.set_title(f"{name}, {duration_words(small.start)} to {duration_words(small.end)}", fontsize=7)
        axes.tick_params(labelsize=6, labelbottom=False)  # the title has the ends, with their units
        tidy(axes)
