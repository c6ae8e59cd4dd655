"""The profile over S: which stick bands and delays explain the record equally well."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from scipy import ndimage

from agent.plots.axes import MEASURED, MODEL, VALVE, legend_above, tidy
from agent.report.numbers import band_words

if TYPE_CHECKING:
    from agent.analysis.results import IntervalEstimate, Profile

INSIDE = "#f6d9cc"


def profile_figure(loop: str, profile: Profile, s: IntervalEstimate | None = None) -> Figure:
    """Draw how well each S agrees with the record, and below it the delay and J that go with each S.

    Args:
        loop: Name for the title.
        profile: Where p is at least ``limit``, S is within the 90 % interval; that is shaded.
        s: The estimate for the title: its interval has the movement of OP within a sample as well.
    """
    figure = Figure(figsize=(9.0, 7.0), layout="constrained")
    upper, delay, j = panels = figure.subplots(3, 1, sharex=True, height_ratios=(1.8, 1.0, 1.0))
    upper.plot(profile.s, profile.p, color=MEASURED, linewidth=1.1, label="best model at this S")
    upper.axhline(profile.limit, color=MODEL, linewidth=0.9, linestyle="--", label="limit of the interval")
    delay.plot(profile.s, profile.delay, color=VALVE, linewidth=1.1)
    j.plot(profile.s, profile.j, color=VALVE, linewidth=1.1)
    basins = _basins(profile)
    for basin in basins:
        for axes in panels:
            axes.axvspan(profile.s[basin][0], profile.s[basin][-1], color=INSIDE, linewidth=1.0, zorder=0)
    best = [basin.start + int(np.argmax(profile.p[basin])) for basin in basins]
    for axes, values in ((upper, profile.p), (delay, profile.delay), (j, profile.j)):
        axes.plot(profile.s[best], values[best], "o", color=MODEL, markersize=5, label="best of a basin")
        tidy(axes)
    upper.set_ylim(-0.05, 1.05)
    upper.set_ylabel("p of the best model")
    delay.set_ylabel("delay (s)")
    j.set_ylabel("J (OP units)")
    j.set_xlabel("S (OP units)")
    legend_above(upper)
    figure.align_ylabels(panels)
    figure.suptitle(f"{loop}: {_words(basins, s)}", x=0.01, ha="left", fontsize=12)
    return figure


def _basins(profile: Profile) -> list[slice]:
    """Return the stretches of S that the record allows, ascending."""
    labels, _ = ndimage.label(profile.p >= profile.limit)
    return [found[0] for found in ndimage.find_objects(labels)]


def _words(basins: list[slice], s: IntervalEstimate | None) -> str:
    if not basins:
        return "no S within the interval"
    count = "one basin" if len(basins) == 1 else f"{len(basins)} basins"
    return f"{count} of models that fit" if s is None else f"{band_words('S', s)} OP units, {count}"
