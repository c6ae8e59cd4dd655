"""The spectrum of the residual with the lines that noise does not make."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from agent.plots.axes import MEASURED, MODEL, SET_POINT, VALVE, legend_above, tidy

if TYPE_CHECKING:
    from agent.workbench.residual.line_spectrum import Line, LineSpectrum

COLOUR = {"locked": MODEL, "coherent": VALVE, "either": "#7b4fa3"}
WORDS = {"locked": "locked to OP", "coherent": "comes from outside", "either": "origin unknown"}


def spectrum_figure(loop: str, found: LineSpectrum) -> Figure:
    """Draw power over frequency, what noise does not pass, and the lines above it."""
    figure = Figure(figsize=(12.0, 3.8), layout="constrained")
    axes = figure.subplots()
    axes.loglog(found.frequency, found.power, color=MEASURED, linewidth=0.8, label="residual")
    axes.loglog(
        found.frequency, found.threshold, color=SET_POINT, linestyle="--", label="noise exceeds this in 1 %"
    )
    for line in found.lines:
        power = found.power[np.argmin(np.abs(found.frequency - line.frequency))]
        axes.loglog(line.frequency, power, "o", color=COLOUR[line.kind], label=_words(line))
    axes.set_xlabel("frequency (1/s)")
    axes.set_ylabel("power")
    tidy(axes)
    legend_above(axes, columns=4)
    figure.suptitle(f"{loop}: spectrum of the residual", x=0.01, ha="left", fontsize=12)
    return figure


def _words(line: Line) -> str:
    where = f"period {1 / line.frequency:.3g} s"
    if line.harmonic is not None:
        where += f", harmonic {line.harmonic} of OP"
    return f"{where}: {WORDS[line.kind]}"
