"""All pictures of a session, by name, in the order of the five questions of the workbench."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.plots.workbench.candidates import candidates_figure
from agent.plots.workbench.contributions import contributions_figure
from agent.plots.workbench.correlations import correlations_figure
from agent.plots.workbench.next_test import next_test_figure
from agent.plots.workbench.overlay import overlay_figure
from agent.plots.workbench.residual_panels import residual_panels_figure
from agent.plots.workbench.spectrum import spectrum_figure
from agent.plots.workbench.staircase import Stair, staircase_figure
from agent.report.comparison_text import step_name
from agent.workbench.paired_blocks import error_interval
from agent.workbench.residual.independence import independence
from agent.workbench.residual.line_spectrum import line_spectrum
from agent.workbench.residual.whiteness import whiteness

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from agent.workbench.comparison import Comparison
    from agent.workbench.session import Workbench
    from agent.workbench.step import Step


def comparison_figures(bench: Workbench, found: Comparison) -> dict[str, Figure]:
    """Return the figures that can be drawn; none where the recording is not testable.

    Args:
        bench: The session.
        found: Its ``comparison()``.
    """
    if not found.steps:
        return {}
    loop, record, folds = found.loop, bench.record, bench.folds
    ts, residual = record.facts.ts, bench.residual()
    pv = np.where(record.weight > 0, record.pv, np.nan)
    fold = np.where(folds.block >= 0, folds.fold[folds.block], -1)
    models = {step_name(step): step.fit.pv for step in found.steps}
    added = {name: each for name, each in bench.compare().items() if name not in ("model", "base")}
    figures = {"overlay": overlay_figure(loop, ts, pv, models, fold)}
    if added:
        figures["contributions"] = contributions_figure(loop, ts, added)
    figures["staircase"] = staircase_figure(loop, [_stair(each) for each in found.steps], found.noise_floor)
    if found.candidates:
        figures["candidates"] = candidates_figure(loop, found.candidates)
    drawn = None if found.next_test is None else next_test_figure(loop, found.next_test)
    if drawn is not None:
        figures["next_test"] = drawn
    if found.where_it_fails:
        figures["where_it_fails"] = residual_panels_figure(loop, found.where_it_fails)
    lines = line_spectrum(residual, record.op, ts)
    if lines is not None:
        figures["spectrum"] = spectrum_figure(loop, lines)
    figures["correlations"] = correlations_figure(
        loop, whiteness(residual), independence(residual, record.op)
    )
    return figures


def _stair(step: Step) -> Stair:
    low, high = error_interval(step.held_out.losses, np.random.default_rng(0))
    return Stair(step_name(step), step.held_out.rmse, low, high, step.rmse_validation)
