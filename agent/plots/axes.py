"""Colours and axes that all pictures share."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MEASURED = "#30435b"
MODEL = "#d9541e"
VALVE = "#1f8a70"
SET_POINT = "#9aa5b1"


def tidy(axes: Axes) -> None:
    """Draw a light grid and no frame."""
    axes.grid(visible=True, color="#e4e8ec", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)


def legend_above(axes: Axes, columns: int = 3) -> None:
    """Put the legend above the data, never on it."""
    place = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "borderaxespad": 0.2}
    axes.legend(ncols=columns, handlelength=1.6, frameon=False, fontsize=9, **place)
