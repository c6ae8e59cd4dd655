"""Small pictures for a terminal: the staircase as bars, the residual against one axis."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.report.comparison_text import step_name
from agent.workbench.residual.axes import UNITS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agent.workbench.comparison import Comparison
    from agent.workbench.residual.where import Failure

WIDTH = 40
"""Characters of the longest bar; with its labels a line fits in 80."""
HALF = 20
"""Characters to each side of zero."""
BAR = "#"
BAND = "."
"""ASCII: the console of Windows may have no other characters."""


def staircase_lines(found: Comparison) -> Iterator[str]:
    """Yield a bar for the held-out error of each step, and one for the noise floor."""
    longest = max(each.held_out.rmse for each in found.steps)
    for step in found.steps:
        length = round(WIDTH * step.held_out.rmse / longest)
        yield f"  {step_name(step)[:24]:24} {step.held_out.rmse:>9.4g} {BAR * length}"
    if found.noise_floor is not None:
        low, high = (
            min(WIDTH, round(WIDTH * each / longest))
            for each in (found.noise_floor.low, found.noise_floor.high)
        )
        floor = " " * low + BAND * max(1, high - low)
        yield f"  {'noise floor':24} {'':9} {floor}"


def residual_lines(panel: Failure) -> Iterator[str]:
    """Yield the mean residual in each bin of an axis as a bar, with the band of no relation in dots."""
    axis = f"{panel.axis.replace('_', ' ')} ({UNITS[panel.axis]})"
    yield f"  {axis}, mean residual; dots: 95 % without a relation"
    rows = panel.bin_means, panel.band_low, panel.band_high
    largest = max(float(np.max(np.abs(each))) for each in rows) or 1.0
    edges = panel.bin_edges
    for first, last, mean, low, high in zip(edges, edges[1:], *rows, strict=False):
        line = [" "] * (2 * HALF + 1)
        for at in _between(low / largest, high / largest):
            line[at] = BAND
        for at in _between(0.0, mean / largest):
            line[at] = BAR
        line[HALF] = "|"
        yield f"  {first:>9.4g} to {last:>9.4g} {''.join(line)} {mean:+.2g}".rstrip()


def _between(one: float, other: float) -> range:
    low, high = sorted((round(HALF * one), round(HALF * other)))
    return range(HALF + low, HALF + high + 1)
