"""The parallelogram that the stem draws over OP."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.plots.axes import MODEL, SET_POINT

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.analysis.stiction.kano_b import Parallelogram


SHOWN = 400
"""Samples of the stem in the picture, in widths of its moving mean; a whole day is a solid block."""


def draw(axes: Axes, seen: Parallelogram) -> None:
    """Draw the stem over OP, and on top of it where it stands."""
    stem = seen.stuck.stem
    last = SHOWN * stem.width
    axes.plot(stem.op[:last], stem.position[:last], color=SET_POINT, linewidth=0.7)
    label = f"stem at rest: S of this method {seen.s:.3g} OP units" if seen.s else "stands"
    for each in seen.stuck.intervals:
        if each.stop > last:
            break
        axes.plot(stem.op[each], stem.position[each], color=MODEL, linewidth=1.1, label=label)
        label = "_"  # one entry in the legend is enough
    axes.set_xlabel("OP from its first value (OP units)")
    axes.set_ylabel("stem" if stem.measured else "PV in place of the stem")
    if seen.stuck.intervals:
        axes.legend(loc="upper left", frameon=False, fontsize=8)
