"""By how much each effect that was tried reduces the held-out error."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from agent.plots.axes import MEASURED, MODEL, SET_POINT, tidy
from agent.report.comparison_text import NOT_CONFIRMED, evidence_words
from agent.workbench.paired_blocks import LEAST_PERCENT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.workbench.hypotheses import Candidate

SHOWN = -20.0
"""Lowest reduction on the axis, %: how much worse than that a useless effect is does not matter."""


def candidates_figure(loop: str, tried: Sequence[Candidate]) -> Figure:
    """Draw the reductions with their intervals; red where likely, large enough and not lowered by a check.

    Args:
        loop: Name for the title.
        tried: At least one, the largest reduction first.
    """
    figure = Figure(figsize=(9.0, 1.2 + 0.36 * len(tried)), layout="constrained")
    axes = figure.subplots()
    at = np.arange(len(tried))
    value, low, high = (
        np.maximum([getattr(each, name) for each in tried], SHOWN)
        for name in ("error_reduction_percent", "low", "high")
    )
    found = [each.is_large and each.is_likely and each.objection is None for each in tried]
    axes.barh(at, value, color=[MODEL if each else SET_POINT for each in found], height=0.6)
    axes.errorbar(value, at, xerr=(value - low, high - value), fmt="none", ecolor=MEASURED, capsize=3)
    axes.axvline(LEAST_PERCENT, color=MEASURED, linewidth=0.8, linestyle="--")
    axes.axvline(0, color=MEASURED, linewidth=0.6)
    axes.set_yticks(at, [f"{each.effect.replace('_', ' ')}  ({_beside(each)})" for each in tried])
    axes.invert_yaxis()
    axes.set_xlabel("reduction of held-out squared error, %, 90 % interval\ndashed: the smallest that counts")
    tidy(axes)
    figure.suptitle(f"{loop}: effects on top of this model", x=0.01, ha="left", fontsize=12)
    return figure


def _beside(each: Candidate) -> str:
    return NOT_CONFIRMED if each.surprises else evidence_words(each)
