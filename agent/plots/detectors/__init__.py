"""Measurements of each stiction detector, one panel a detector, drawn by the file of its name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import ceil, sqrt
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

from agent.plots.axes import tidy
from agent.plots.detectors import (
    bicoherence,
    choudhury_cmeans,
    choudhury_ellipse,
    damarla,
    fitted_half_cycles,
    hagglund_backlash,
    horch_ccf,
    horch_histogram,
    kano_a,
    kano_b,
    singhal_salsbury,
    srinivasan_dtw,
    thornhill_surrogates,
    yamashita,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.analysis.results import MethodResult

Picture = Callable[["Axes", Any], None]
"""Draws into axes what a detector stored in ``MethodResult.seen``."""

PICTURES: dict[str, Picture] = {
    "horch_ccf": horch_ccf.draw,
    "horch_histogram": horch_histogram.draw,
    "singhal_salsbury": singhal_salsbury.draw,
    "kano_a": kano_a.draw,
    "kano_b": kano_b.draw,
    "yamashita": yamashita.draw,
    "he_curve_fit": fitted_half_cycles.draw,
    "rossi_scali": fitted_half_cycles.draw,
    "hagglund_shape": fitted_half_cycles.draw,
    "hagglund_backlash": hagglund_backlash.draw,
    "damarla": damarla.draw,
    "srinivasan_dtw": srinivasan_dtw.draw,
    "bicoherence": bicoherence.draw,
    "choudhury_ellipse": choudhury_ellipse.draw,
    "choudhury_cmeans": choudhury_cmeans.draw,
    "thornhill_surrogates": thornhill_surrogates.draw,
}
"""By name of the detector."""


def detectors_figure(loop: str, methods: Mapping[str, MethodResult]) -> Figure | None:
    """Draw a panel for each method that has measurements; None where none has.

    Args:
        loop: Name for the title.
        methods: Results by name of the method; those without a picture are left out.
    """
    shown = {name: result for name, result in methods.items() if name in PICTURES and result.seen is not None}
    if not shown:
        return None
    columns = ceil(sqrt(len(shown)))
    rows = ceil(len(shown) / columns)
    figure = Figure(figsize=(5.0 * columns, 3.6 * rows + 0.4), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False).flat
    for (name, result), axes in zip(shown.items(), panels, strict=False):
        PICTURES[name](axes, result.seen)
        axes.set_title(_title(name, result), fontsize=10, loc="left")
        tidy(axes)
    for axes in panels:  # the unused panels of the last row
        axes.remove()
    figure.suptitle(f"{loop}: measurements of the detectors", x=0.01, ha="left", fontsize=12)
    return figure


def _title(name: str, result: MethodResult) -> str:
    verdict = f"{name}: {result.verdict.replace('_', ' ')}"
    return verdict if result.index is None else f"{verdict}, index {result.index:.3g}"
