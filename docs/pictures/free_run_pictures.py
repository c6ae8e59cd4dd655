"""Pictures of what the search of ``free_run`` sees; ``make.py`` draws them."""
# ruff: noqa: INP001 - beside its pictures, no package

from __future__ import annotations

from pathlib import Path

import numpy as np
from agent.analysis.quantify.free_run.coarse_grid import (
    COARSE,
    LEVEL_STEP,
    RATIOS,
    TAUS,
    bank_delays,
    processes,
    scan,
)
from agent.analysis.quantify.free_run.fitted import STEP as PROCESS_STEP
from agent.analysis.quantify.free_run.fitted import searched
from agent.analysis.quantify.free_run.random_shots import settled
from agent.analysis.quantify.free_run.search import best_stiction
from agent.analysis.quantify.free_run.shooting import track_for
from agent.analysis.quantify.free_run.shooting_search import STAGES
from agent.analysis.quantify.free_run.starts import STEMS
from matplotlib.figure import Figure

from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.record.recording import FloatArray, LoopHints, LoopWindow
from agent.identify.bank import bank
from agent.identify.objective import S, free_run_error
from agent.identify.problem import Problem, first_periods
from agent.plots.axes import MEASURED, MODEL, VALVE, tidy
from simulators.parameters import ValveParameters
from simulators.plant import simulate
from simulators.scenario import load_scenario

ROOT = Path(__file__).parents[2]


def free_run_search() -> Figure:
    """Draw where the search looks: the coarse grid, and the basin of each error around the best S."""
    window, truth = recorded("pic401_direct_stick_slip")
    problem = pose(window)
    if isinstance(problem, str):
        raise TypeError(problem)
    figure = Figure(figsize=(11.0, 4.0), layout="constrained")
    grid, basins = figure.subplots(1, 2)

    s_values = np.linspace(0.01, 1.0, 160) * problem.op_span
    near = bank(problem, *processes(problem, TAUS, RATIOS, integrates=None), COARSE.periods)
    level_step = LEVEL_STEP * problem.op_span
    scores, _, _ = scan(near, STEMS[:1], s_values, COARSE.j_ratios, level_step, bank_delays(problem))
    image = grid.pcolormesh(
        s_values, COARSE.j_ratios, 100 * (1 - scores[0].T), cmap="viridis", shading="nearest", vmax=15
    )
    figure.colorbar(image, ax=grid, extend="max", label="PV left unexplained, %")
    s, j = truth.f_s + truth.f_d, truth.f_s - truth.f_d
    grid.plot(s, j / s, "o", color="white", markeredgecolor=MODEL, label="truth")
    grid.set_xlabel("S (OP units)")
    grid.set_ylabel("J/S")
    grid.set_title("coarse grid, best first slip of He's valve", fontsize=10)
    grid.legend(loc="lower right")

    fine, whole, begun = errors_over_s(problem)
    basins.semilogy(fine, whole, color=MEASURED, linewidth=0.9, label="whole record")
    basins.semilogy(fine, begun, color=VALVE, linewidth=0.9, label="first five periods")
    basins.axvline(s, color=MODEL, linewidth=0.9, linestyle="--", label="truth")
    basins.set_xlabel("S (OP units)")
    basins.set_ylabel("error over the variance of PV, %")
    basins.set_title("all but S at the optimum", fontsize=10)
    basins.legend(fontsize=9)
    tidy(basins)
    return figure


def recorded(scenario_name: str) -> tuple[LoopWindow, ValveParameters]:
    """Return what a scenario of ``config/scenarios`` records, and its true valve."""
    scenario = load_scenario(ROOT / "config" / "scenarios" / f"{scenario_name}.yaml")
    record = simulate(scenario)
    return LoopWindow(scenario.loop, scenario.start, scenario.ts, record.op, record.pv), scenario.valve


def errors_over_s(problem: Problem) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return S around the best (OP units), and the errors over all and over five periods, % of variance."""
    found = best_stiction(problem, LoopHints())
    if found is None:
        raise TypeError("nothing was found")
    best = found.best
    s_values = best.candidate[S] + np.linspace(-0.1, 0.1, 1201) * problem.op_span
    errors = []
    for part in (problem, first_periods(problem, 5)):
        squares = []
        for s in s_values:
            candidate = best.candidate.copy()
            candidate[S] = s
            squares.append(100 * free_run_error(candidate, best.structure, part) / np.sum(part.pv**2))
        errors.append(np.array(squares))
    return s_values, errors[0], errors[1]


def shots() -> Figure:
    """Draw the error against S by free run and by shots."""
    window, truth = recorded("pic401_direct_stick_slip")
    problem = pose(window)
    found = None if isinstance(problem, str) else best_stiction(problem, LoopHints())
    if isinstance(problem, str) or found is None:
        raise TypeError(problem)
    best = found.best
    s_values = best.candidate[S] + np.linspace(-0.06, 0.06, 121) * problem.op_span
    axes = np.array(searched(best.structure, problem))
    errors = []
    for s in s_values:
        candidate = best.candidate.copy()
        candidate[S] = s
        track, price = track_for(problem), STAGES[0].shots
        _, _, by_shots = settled(candidate, PROCESS_STEP, axes, best.structure, problem, price, track)
        errors.append((free_run_error(candidate, best.structure, problem), by_shots))
    free, in_shots = 100 * np.array(errors).T / np.sum(problem.pv**2)
    figure = Figure(figsize=(7.0, 4.0), layout="constrained")
    panel = figure.subplots()
    panel.semilogy(s_values, free, color=MEASURED, linewidth=0.9, label="free run")
    panel.semilogy(s_values, in_shots, color=VALVE, linewidth=0.9, label="shots, price included")
    panel.axvline(truth.f_s + truth.f_d, color=MODEL, linewidth=0.9, linestyle="--", label="truth")
    panel.set_xlabel("S (OP units)")
    panel.set_ylabel("error over the variance of PV, %")
    panel.legend(fontsize=9)
    tidy(panel)
    return figure
