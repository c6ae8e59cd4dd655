"""Measurement and model of one loop in one picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from agent.analysis.record.interesting_stretch import interesting_stretch
from agent.plots.axes import MEASURED, MODEL, SET_POINT, VALVE, legend_above, tidy
from agent.plots.time_units import time_of
from agent.report.numbers import band_words, percent_words

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.analysis.results import Quantification


def fit_figure(window: LoopWindow, diagnosis: Diagnosis) -> Figure:
    """Draw PV with the model's PV on top, OP with the model's valve position, and OP against PV.

    Args:
        window: The measurement.
        diagnosis: Its diagnosis; where it has no model, the measurement alone is drawn.
    """
    figure = Figure(figsize=(12.0, 6.0), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(2.3, 1.0))
    pv_axes = figure.add_subplot(grid[0, 0])
    op_axes = figure.add_subplot(grid[1, 0], sharex=pv_axes)
    plane = figure.add_subplot(grid[:, 1])
    period = None if diagnosis.oscillation is None else diagnosis.oscillation.period
    shown = interesting_stretch(window, period)
    time, unit = time_of(len(window), window.ts)
    time = time[shown]
    found = diagnosis.quantification
    whole = len(time) == len(window)
    model_pv = None if found is None or found.model_pv is None else found.model_pv[shown]
    if model_pv is not None and not whole:
        model_pv = model_pv + _level(window.pv[shown] - model_pv)
    valve = None if found is None else _valve(window, found)
    op, pv = window.op[shown], window.pv[shown]

    if window.sp is not None:
        pv_axes.plot(time, window.sp[shown], color=SET_POINT, linewidth=1.0, label="SP")
    pv_axes.plot(time, pv, color=MEASURED, linewidth=1.1, label="PV measured")
    if model_pv is not None:
        pv_axes.plot(
            time,
            model_pv,
            color=MODEL,
            linewidth=1.1,
            label=f"PV of the model{'' if whole else ' at the level of PV'}"
            f"{_fit(diagnosis, sticks=valve is not None)}",
        )
    op_axes.plot(time, op, color=MEASURED, linewidth=1.1, label="OP measured")
    if valve is not None:
        op_axes.plot(time, valve[shown], color=VALVE, linewidth=1.1, label="valve position of the model")
    plane.plot(op, pv, color=MEASURED, linewidth=0.6, alpha=0.7, label="measured")
    if model_pv is not None:
        plane.plot(op, model_pv, color=MODEL, linewidth=0.6, alpha=0.8, label="model")

    pv_axes.set_ylabel("PV (PV units)")
    pv_axes.tick_params(labelbottom=False)
    op_axes.set_ylabel("OP (OP units)")
    op_axes.set_xlabel(f"time from the start of the record ({unit})")
    plane.set_xlabel("OP (OP units)")
    plane.set_ylabel("PV (PV units)")
    plane.xaxis.set_major_locator(MaxNLocator(5))
    for axes in (pv_axes, op_axes, plane):
        tidy(axes)
        legend_above(axes)
    figure.align_ylabels((pv_axes, op_axes))
    part = "" if whole else f",  shown: {time[0]:.4g} to {time[-1]:.4g} {unit}"
    figure.suptitle(f"{_title(diagnosis)}{part}", x=0.01, ha="left", fontsize=12)
    return figure


def _level(residual: FloatArray) -> float:
    """Return what of a stretch is slower than it, which the model does not explain and the fit leaves out."""
    known = residual[np.isfinite(residual)]
    return float(known.mean()) if len(known) else 0.0


def _valve(window: LoopWindow, found: Quantification) -> FloatArray | None:
    """Return the model's valve position, OP units, (n,); None where the valve just follows OP."""
    if found.model_mv is None:
        return None
    known = np.isfinite(window.op)
    return None if np.array_equal(found.model_mv[known], window.op[known]) else found.model_mv


def _fit(diagnosis: Diagnosis, *, sticks: bool) -> str:
    """Return the fit of the model that is drawn, as the text has it."""
    found = diagnosis.quantification
    if found is None:
        return ""
    percent = found.free_run_percent if sticks else found.linear_percent
    return "" if percent is None else f" (fit {percent_words(percent)})"


def _title(diagnosis: Diagnosis) -> str:
    title = f"{diagnosis.loop}: {diagnosis.verdict.replace('_', ' ')}"
    found = diagnosis.quantification
    if diagnosis.verdict == "stiction" and found is not None and found.stiction is not None:
        title += f",  {band_words('S', found.stiction.s)},  {band_words('J', found.stiction.j)} OP units"
    if diagnosis.oscillation is not None and diagnosis.oscillation.detected:
        title += f",  period {diagnosis.oscillation.period:.4g} s"
    return title
