"""Draw the pictures of the docs again: python docs/pictures/make.py (by hand, after a change of a model)."""
# ruff: noqa: INP001 - a script beside its pictures, no package

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from agent.analysis.diagnose import diagnose
from agent.analysis.quantify.free_run.coarse_grid import J_RATIOS, bank_delays, score_grid
from agent.analysis.quantify.free_run.objective import S, free_run_error
from agent.analysis.quantify.free_run.problem import Problem, pose
from agent.analysis.quantify.free_run.search import STEMS, best_stiction
from agent.analysis.recording import LoopHints, LoopWindow
from agent.cli.recordings import loop_window
from agent.physics.valves.he2007 import he2007
from agent.physics.valves.two_state import two_state
from agent.plots.axes import MEASURED, MODEL, VALVE, tidy
from agent.plots.fit import fit_figure
from connectors.recording import read_recording
from simulators.plant import simulate
from simulators.scenario import load_scenario

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
RECORDINGS = Path(os.environ.get("SLIPJUMP_DATA", ROOT.parent / "shared" / "data"))
DPI = 100


def chem10() -> Figure:
    """Draw the loop of the README: International Stiction Data Base, CHEM10, contributed by B. Huang."""
    window = loop_window(read_recording(RECORDINGS / "isdb" / "CHEM10.csv"), LoopHints())
    return fit_figure(window, diagnose(window))


def free_run_search() -> Figure:
    """Draw where the search looks: the coarse grid, and the needle that it must hit."""
    scenario = load_scenario(ROOT / "config" / "scenarios" / "tic302_second_order.yaml")
    record = simulate(scenario)
    window = LoopWindow(scenario.loop, scenario.start, scenario.ts, record.op, record.pv)
    problem = pose(window)
    if isinstance(problem, str):
        raise TypeError(problem)
    truth = scenario.valve
    figure = Figure(figsize=(11.0, 4.0), layout="constrained")
    grid, needle = figure.subplots(1, 2)

    s_values = np.linspace(0.004, 1.0, 160) * problem.op_span
    taus = np.geomspace(0.7, 4 * problem.period, 8)
    scores, _ = score_grid(problem, STEMS[0], s_values, taus, bank_delays(problem))
    left = 100 * (1 - scores.max(axis=2).T)
    image = grid.pcolormesh(s_values, J_RATIOS, left, cmap="viridis", shading="nearest")
    figure.colorbar(image, ax=grid, label="PV left unexplained, %")
    s, j = truth.f_s + truth.f_d, truth.f_s - truth.f_d
    grid.plot(s, j / s, "o", color="white", markeredgecolor=MODEL, label="truth")
    grid.set_xlabel("S (OP units)")
    grid.set_ylabel("J/S")
    grid.set_title("coarse grid, best start of the valve", fontsize=10)
    grid.legend(loc="lower right")

    fine, left_fine = residual_over_s(problem)
    needle.plot(fine, left_fine, color=MEASURED, linewidth=0.9)
    needle.axvline(s, color=MODEL, linewidth=0.9, linestyle="--", label="truth")
    needle.set_xlabel("S (OP units)")
    needle.set_ylabel("PV left unexplained, %")
    needle.set_title("all but S at the optimum", fontsize=10)
    needle.legend()
    tidy(needle)
    return figure


def residual_over_s(problem: Problem) -> tuple[np.ndarray, np.ndarray]:
    """Return S (OP units) and the share of PV that the optimum leaves when only S is moved, %."""
    best = best_stiction(problem, LoopHints())
    if best is None:
        raise TypeError("nothing was found")
    s_values = np.linspace(0.01, 0.9, 1500) * problem.op_span
    left = []
    for s in s_values:
        candidate = best.candidate.copy()
        candidate[S] = s
        left.append(100 * free_run_error(candidate, best.structure, problem) / np.sum(problem.pv**2))
    return s_values, np.array(left)


def valve_laws() -> Figure:
    """Draw both laws of the valve on a triangle: S = 7, J = 3 (f_S 5, f_D 2), OP units."""
    t = np.arange(1500)
    op = 10 * (2 * np.abs(2 * ((t / 500 + 0.25) % 1) - 1) - 1)
    laws = (("he2007: rests after each slip", he2007, MODEL), ("two_state: slides on", two_state, VALVE))
    figure = Figure(figsize=(11.0, 4.0), layout="constrained")
    over_time, plane = figure.subplots(1, 2, width_ratios=(1.8, 1))
    over_time.plot(t[500:], op[500:], color=MEASURED, linewidth=1.0, label="OP")
    for name, law, colour in laws:
        position = law(op, 5.0, 2.0, op[0])
        over_time.plot(t[500:], position[500:], color=colour, linewidth=1.1, label=name)
        plane.plot(op[500:], position[500:], color=colour, linewidth=1.1, label=name)
    over_time.set_xlabel("sample")
    over_time.set_ylabel("OP, valve position (OP units)")
    plane.set_xlabel("OP (OP units)")
    plane.set_ylabel("valve position (OP units)")
    over_time.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=3, frameon=False, fontsize=9)
    for axes in (over_time, plane):
        tidy(axes)
    return figure


if __name__ == "__main__":
    for draw in (free_run_search, valve_laws, chem10):
        draw().savefig(HERE / f"{draw.__name__}.png", dpi=DPI)
