"""Pictures of what the search of ``free_run`` sees; ``make.py`` draws them."""
# ruff: noqa: INP001 - beside its pictures, no package

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from agent.analysis.quantify.free_run.found import find
from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.record.recording import FloatArray, LoopWindow
from agent.identify.bank import bank
from agent.identify.free_run_error import free_run_error
from agent.identify.objective import S
from agent.identify.problem import Problem, first_periods
from agent.identify.search.cycle import STRUCTURES
from agent.identify.search.grid import COARSE, DELAYS, FARTHEST, LAGS, LEVEL_STEP, STEMS, scan
from agent.identify.search.process_bank import delays_of, processes_of
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
    processes = processes_of(problem, STRUCTURES, LAGS)
    near = bank(problem, processes.taus, processes.ratios, COARSE.periods)
    delays = delays_of(problem, DELAYS, FARTHEST)
    level_step = LEVEL_STEP * problem.op_span
    scores, _, _ = scan(near, STEMS[:1], s_values, COARSE.j_ratios, level_step, delays)
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

    fine, whole, begun = errors_over_s(window, problem)
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


def errors_over_s(window: LoopWindow, problem: Problem) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return S around the best (OP units), and the errors over all and over five periods, % of variance."""
    found = find(window, problem)
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
