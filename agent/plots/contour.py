"""The contour map of Lee, Ren and Huang (2008), section V.D.2: which valves explain a record."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure

from agent.analysis.quantify.valves.error_map import ALIKE
from agent.plots.axes import MODEL, tidy
from agent.report.numbers import band_words
from agent.units import FrictionBands

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from agent.analysis.quantify.valves.error_map import ErrorMap
    from agent.analysis.results import Quantification, StictionEstimate

LEVELS = (1.0, 1.05, ALIKE, 1.2, 1.4, 1.8, 2.5, 4.0, 7.0, 12.0, 25.0, 60.0)
"""Errors over the least where the colour changes; about even in the logarithm of what is above one."""
COLOURS = ScalarMappable(BoundaryNorm(LEVELS, 256, extend="max"), "viridis")
NO_PROCESS = "#eceff2"
NAMES = {"fopdt": "first order", "sopdt": "second order", "integrator": "integrator"}


def contour_figure(loop: str, errors: ErrorMap, found: Quantification | None = None) -> Figure:
    """Draw the error over f_D and f_S (the paper's Fig. 2 (b)), one panel a structure of the process.

    Args:
        loop: Name for the title.
        errors: The map.
        found: Estimate of a quantifier for the same loop: a cross, and the region of its intervals of S and
            J. It may differ from the minimum of the map where it starts the valve with another stored force.
    """
    figure = Figure(figsize=(2.0 + 4.4 * len(errors.kinds), 5.6), layout="constrained")
    panels = figure.subplots(1, len(errors.kinds), squeeze=False, sharey=True)[0]
    for layer, axes in enumerate(panels):
        _draw_layer(axes, errors, layer)
        if found is not None and found.stiction is not None:
            _draw_estimate(axes, found.quantifier, found.stiction)
        axes.set_xlim(0, 0.52 * errors.f_s[-1])
        axes.set_ylim(0, 1.02 * errors.f_s[-1])
        axes.set_xlabel("f_D (OP units)")
        axes.legend(loc="upper right", frameon=False, fontsize=9)
        tidy(axes)
    panels[0].set_ylabel("f_S (OP units)")
    label = "squared error of lee2008 over the least"
    figure.colorbar(COLOURS, ax=panels, ticks=LEVELS, format="%g", label=label)
    figure.suptitle(
        f"{loop}: {_words(errors, None if found is None else found.stiction)}", x=0.01, ha="left", fontsize=11
    )
    return figure


def _draw_layer(axes: Axes, errors: ErrorMap, layer: int) -> None:
    """Draw one map with its minima; grey where no process is plausible."""
    span, basins = errors.f_s[-1], errors.basins(layer)
    name = NAMES[errors.kinds[layer]]
    triangle = (0, 0, span / 2), (0, span, span / 2)
    axes.fill(*triangle, color=NO_PROCESS, linewidth=0, label="no process is plausible")
    if not basins:
        axes.set_title(f"{name}: no process is plausible", fontsize=10)
        return
    shown = np.ma.masked_invalid(errors.error[layer])
    axes.contourf(errors.f_d, errors.f_s, shown, LEVELS, cmap=COLOURS.cmap, norm=COLOURS.norm, extend="max")
    edge = ALIKE * shown.min()
    if edge < shown.max():
        axes.contour(errors.f_d, errors.f_s, shown, (edge,), colors="white", linewidths=0.8)
    for each in basins[1:]:
        axes.plot(each.f_d, each.f_s, "o", color="white", markeredgecolor="black", markersize=4)
    best, label = basins[0], "least error of the panel"
    axes.plot(best.f_d, best.f_s, "o", color="white", markeredgecolor="black", label=label)
    axes.set_title(f"{name}: least error {shown.min():.3g}, minima {len(basins)}", fontsize=10)


def _draw_estimate(axes: Axes, quantifier: str, found: StictionEstimate) -> None:
    """Draw an estimate; intervals of S = f_S + f_D and J = f_S - f_D bound a slanting rectangle."""
    f_s, f_d, label = found.f_s.value, found.f_d.value, f"estimate of {quantifier}"
    axes.plot(f_d, f_s, "+", color=MODEL, markersize=13, markeredgewidth=2, label=label)
    s, j = found.s, found.j
    if s.low is None or s.high is None or j.low is None or j.high is None:
        return
    corners = [(s.low, j.low), (s.low, j.high), (s.high, j.high), (s.high, j.low)]
    bands = [FrictionBands.from_s_j(s_end, min(j_end, s_end)) for s_end, j_end in corners]
    outline = [each.f_d for each in bands], [each.f_s for each in bands]
    axes.fill(*outline, fill=False, edgecolor=MODEL, linewidth=1.4, label="90 % intervals of S and J")


def _words(errors: ErrorMap, found: StictionEstimate | None) -> str:
    """Return the title: the estimate, where there is one, in the numbers of the text; else the map's best."""
    if found is not None:
        return f"{band_words('S', found.s)}, {band_words('J', found.j)} OP units, on the map of lee2008"
    kind, bands = errors.best
    layer = errors.kinds.index(kind)
    count, ends = len(errors.basins(layer)), [f"{s:.3g}" for s in errors.s_of_basins(layer)]
    minima = "one minimum" if count == 1 else f"{count} minima"
    s = f"S = {ends[0]}" if ends[0] == ends[1] else f"S from {ends[0]} to {ends[1]}"
    place = f"least error at f_S = {bands.f_s:.3g}, f_D = {bands.f_d:.3g} OP units"
    return f"{place}; within {100 * (ALIKE - 1):.0f} % of it {minima}, {s}"
