"""The error of each step, with its interval, over the noise floor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from agent.plots.axes import MEASURED, MODEL, VALVE, legend_above, tidy
from agent.plots.workbench.palette import BAND

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.workbench.residual.noise_floor import NoiseFloor


@dataclass(frozen=True, slots=True)
class Stair:
    """One step; errors are RMSE in PV units."""

    name: str
    held_out: float
    low: float
    """Of the 90 % interval of ``held_out``."""
    high: float
    validation: float | None = None
    """On another recording."""


def staircase_figure(loop: str, stairs: Sequence[Stair], floor: NoiseFloor | None) -> Figure:
    """Draw the error of the steps in their order.

    Args:
        loop: Name for the title.
        stairs: The base first, at least one.
        floor: None where it is not known.
    """
    figure = Figure(figsize=(max(5.0, 2.0 + 1.6 * len(stairs)), 4.4), layout="constrained")
    axes = figure.subplots()
    at = np.arange(len(stairs))
    error = np.array([each.held_out for each in stairs])
    away = np.array([[each.held_out - each.low, each.high - each.held_out] for each in stairs]).T
    if floor is not None:
        axes.axhspan(floor.low, floor.high, color=BAND, linewidth=0, label="noise floor interval")
    axes.step(at, error, where="mid", color=MEASURED, linewidth=1.4)
    axes.errorbar(at, error, away, fmt="o", color=MEASURED, capsize=4, label="held out, 90 % interval")
    validation = [(k, each.validation) for k, each in enumerate(stairs) if each.validation is not None]
    if validation:
        axes.plot(*zip(*validation, strict=True), "s", color=VALVE, label="another recording")
    if len(stairs) > 1:
        change = f"{100 * (error[-1] / error[0] - 1):+.0f} %"
        axes.annotate(change, (at[-1], error[-1]), (8, 8), textcoords="offset points", color=MODEL)
    axes.set_xticks(at, [each.name.replace("_", " ") for each in stairs])
    axes.set_xlim(-0.5, len(stairs) - 0.5)
    axes.set_ylim(0, 1.1 * max(each.high for each in stairs))
    axes.set_ylabel("RMSE in free run (PV units)")
    tidy(axes)
    legend_above(axes)
    figure.suptitle(f"{loop}: error with each effect", x=0.01, ha="left", fontsize=12)
    return figure
