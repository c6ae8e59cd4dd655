"""Draw the pictures of the docs again: python docs/pictures/make.py (by hand, after a change of a model)."""
# ruff: noqa: INP001 - a script beside its pictures, no package

from __future__ import annotations

import os
from pathlib import Path
from typing import Literal

import numpy as np
from effect_pictures import EFFECT_VALUES, effect_in_the_loop, overflowing_tanks, rubbing_drive
from free_run_pictures import free_run_search, recorded
from matplotlib.figure import Figure

from agent.analysis.diagnose import diagnose
from agent.analysis.oscillation import detect_oscillation
from agent.analysis.oscillation.acf_filtered import band_passed, peaks
from agent.analysis.oscillation.acf_zero_crossings import autocorrelation
from agent.analysis.oscillation.spectrum import spectrum
from agent.analysis.quantify import quantifier
from agent.analysis.quantify.valves.error_map import error_map
from agent.analysis.record.recording import FloatArray, LoopWindow
from agent.analysis.record.signals import detrended
from agent.analysis.record.window_of_recording import loop_window
from agent.analysis.stiction import DETECTORS, StictionDetector
from agent.physics.effects import EFFECTS
from agent.physics.processes import PROCESSES
from agent.physics.valves import LAWS, StictionLaw
from agent.plots.axes import MEASURED, MODEL, SET_POINT, VALVE, legend_above, tidy
from agent.plots.contour import contour_figure
from agent.plots.detectors import PICTURES
from agent.plots.fit import fit_figure
from agent.plots.profile import profile_figure
from agent.plots.workbench.candidates import candidates_figure
from agent.plots.workbench.comparison_figures import comparison_figures
from agent.plots.workbench.residual_panels import residual_panels_figure
from agent.units import FrictionBands
from agent.workbench.session import Workbench
from connectors.recording import read_recording
from simulators.draws.random_moves import random_moved
from simulators.draws.random_plants import Kind, random_plant
from simulators.parameters import ProcessParameters, ValveParameters
from simulators.plant import simulate
from simulators.process import SimulatedProcess
from simulators.valve import STEP, SimulatedValve

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
RECORDINGS = Path(os.environ.get("SLIPJUMP_DATA", ROOT.parent / "shared" / "data"))
DPI = 100
BANDS = FrictionBands(f_s=5.0, f_d=2.0)
STUCK_AND_FREE: tuple[tuple[Kind, int], ...] = (("stiction", 13), ("sinusoid", 1))
"""Loops of ``simulators.draws.random_plants`` for the pictures of the stiction detectors: kind and seed."""
MANY_PERIODS: tuple[tuple[Kind, int], ...] = (("stiction", 37), ("sinusoid", 1))
"""The same with periods enough for the tests of nonlinearity."""
OF_NONLINEARITY = ("bicoherence", "choudhury_ellipse", "choudhury_cmeans", "thornhill_surrogates")


def chem10() -> Figure:
    """Draw the loop of the README: International Stiction Data Base, CHEM10, contributed by B. Huang."""
    window = loop_window(read_recording(RECORDINGS / "isdb" / "CHEM10.csv"))
    return fit_figure(window, diagnose(window))


def contour_map() -> Figure:
    """Draw the contour map of a simulated loop with stick and slip."""
    window, _ = recorded("pic401_direct_stick_slip")
    errors = error_map(window)
    if errors is None:
        raise TypeError("no process follows PV")
    return contour_figure(window.loop, errors, quantifier("free_run").quantify(window))


def profile() -> Figure:
    """Draw what the same loop says of S, and the delay and J that go with it."""
    window, _ = recorded("pic401_direct_stick_slip")
    found = quantifier("free_run").quantify(window)
    if found.profile is None:
        raise TypeError("no stiction was found")
    return profile_figure(window.loop, found.profile, found.s)


def slow_triangle() -> tuple[FloatArray, FloatArray]:
    """Return time, s, and OP, OP units, of three strokes of 10 either way."""
    t = np.arange(1500.0)
    return t, 10 * (2 * np.abs(2 * ((t / 500 + 0.25) % 1) - 1) - 1)


def integrated_valve(friction: Literal["karnopp", "lugre"], op: FloatArray) -> FloatArray:
    """Return the positions of a physical valve with the friction of ``BANDS``, OP units, OP held for 1 s."""
    parameters = ValveParameters(law=friction, f_s=BANDS.f_s, f_d=BANDS.f_d)
    valve = SimulatedValve(parameters, (-50.0, 50.0), float(op[0]))
    return np.array([valve.stroke(each, round(1 / STEP[friction]), STEP[friction])[-1] for each in op])


def law_on_triangle(law: StictionLaw) -> Figure:
    """Draw one law on a triangle, over time and over OP, with an integrated valve behind it."""
    t, op = slow_triangle()
    figure = Figure(figsize=(10.0, 3.4), layout="constrained")
    over_time, plane = figure.subplots(1, 2, width_ratios=(1.9, 1))
    over_time.plot(t[500:], op[500:], color=MEASURED, linewidth=1.0, label="OP")
    for name, position, colour in (
        ("Karnopp, integrated", integrated_valve("karnopp", op), SET_POINT),
        (law.name, law.position(op, BANDS, 0.0), VALVE),
    ):
        over_time.plot(t[500:], position[500:], color=colour, linewidth=1.2, label=name)
        plane.plot(op[500:], position[500:], color=colour, linewidth=1.2)
    over_time.set_xlabel("time (s)")
    over_time.set_ylabel("OP, valve position (OP units)")
    plane.set_xlabel("OP (OP units)")
    plane.set_ylabel("valve position (OP units)")
    legend_above(over_time)
    for axes in (over_time, plane):
        tidy(axes)
    return figure


def stiction_laws() -> Figure:
    """Draw valve position over OP for each law, and for the two frictions that the simulator integrates."""
    _, op = slow_triangle()
    positions = {law.name: law.position(op, BANDS, 0.0) for law in LAWS}
    positions["karnopp"] = integrated_valve("karnopp", op)
    positions["lugre"] = integrated_valve("lugre", op)
    figure = Figure(figsize=(9.0, 9.0), layout="constrained")
    panels = figure.subplots(3, 3, sharex=True, sharey=True)
    for axes, (name, position) in zip(panels.flat, positions.items(), strict=True):
        axes.plot(op[500:], op[500:], color=SET_POINT, linewidth=0.8)
        axes.plot(op[500:], position[500:], color=VALVE, linewidth=1.2)
        axes.set_title(name, fontsize=10)
        tidy(axes)
    for axes in panels[-1]:
        axes.set_xlabel("OP (OP units)")
    for axes in panels[:, 0]:
        axes.set_ylabel("valve position (OP units)")
    return figure


def process_steps() -> Figure:
    """Draw the answers of the processes to a step, beside the simulator's and an interpolated lag's."""
    lags = {"fopdt": (0.5,), "sopdt": (2.0, 1.2), "integrator": ()}
    simulated = {
        "fopdt": ProcessParameters(gain=1, tau=0.5, delay=2.5),
        "sopdt": ProcessParameters(kind="second_order", gain=1, tau=2.0, tau2=1.2, delay=2.5),
        "integrator": ProcessParameters(kind="integrating", gain=1, delay=2.5),
    }
    t = np.arange(20)
    step = np.where(t < 5, 0.0, 1.0)
    fine = np.arange(1, 500 * len(t) + 1) / 500
    figure = Figure(figsize=(11.0, 3.5), layout="constrained")
    for process, axes in zip(PROCESSES, figure.subplots(1, len(PROCESSES)), strict=True):
        truth = SimulatedProcess(simulated[process.name], 1 / 500)
        line = []
        for flow in np.repeat(step, 500):
            truth.respond(np.array([flow]), 0.0)
            line.append(truth.pv)
        axes.plot(fine, line, color=MEASURED, linewidth=0.9, label="simulator")
        response = process.respond(step, (*lags[process.name], 3.5))
        axes.plot(t, response, "o", color=MODEL, markersize=4, label="exact")
        if process.name == "fopdt":
            whole, later = (process.respond(step, (*lags["fopdt"], delay)) for delay in (3.0, 4.0))
            axes.plot(t, (whole + later) / 2, "x", color=VALVE, label="interpolated")
        axes.set_title(process.name, fontsize=10)
        axes.set_xlabel("sample")
        axes.set_ylabel("PV over gain")
        axes.legend(loc="upper left", frameon=False, fontsize=9)
        tidy(axes)
    return figure


def oscillation_peak() -> Figure:
    """Draw how a wave is found under a drift: a simulated OP and a random walk of twice its size."""
    window, _ = recorded("pic401_direct_stick_slip")
    walk = np.cumsum(np.random.default_rng(1).normal(size=len(window)))
    op = detrended(window.op + 2 * np.std(window.op) / np.std(walk) * walk)
    found = spectrum(op)
    line = max(peaks(found), key=found.prominence)
    filtered = band_passed(op, found.period(line))
    correlations = [autocorrelation(values) for values in (op, filtered)]
    figure = Figure(figsize=(11.0, 3.6), layout="constrained")
    over_time, power, lags = figure.subplots(1, 3, width_ratios=(1.4, 1, 1))
    over_time.plot(op, color=MEASURED, linewidth=0.8, label="OP with drift")
    over_time.plot(filtered, color=MODEL, linewidth=0.9, label="peak filtered out")
    over_time.set_xlabel("sample")
    power.loglog(found.frequency[1:], found.power[1:], color=MEASURED, linewidth=0.7)
    power.axvline(found.frequency[line], color=MODEL, linewidth=0.8, linestyle="--")
    power.set_xlabel("cycles a sample")
    power.set_title(f"prominence {found.prominence(line):.0f}", fontsize=10)
    for acf, colour, name in zip(correlations, (MEASURED, MODEL), ("OP", "filtered"), strict=True):
        if acf is not None:
            lags.plot(acf.r, color=colour, linewidth=0.9, label=name)
    lags.axhline(0, color=SET_POINT, linewidth=0.6)
    lags.set_xlabel("lag of the autocorrelation (samples)")
    for axes in (over_time, power, lags):
        tidy(axes)
    for axes in (over_time, lags):
        legend_above(axes)
    return figure


def load_like_a_dead_band() -> Figure:
    """Draw a simulated sound valve whose load wanders, and the dead band that explains it by mistake."""
    record = simulate(random_moved(3014, "set_point"))
    window = LoopWindow("load", 0.0, 1.0, record.op, record.pv, record.sp)
    found = quantifier("free_run").quantify(window)
    figure = Figure(figsize=(10.0, 3.6), layout="constrained")
    pv, op = figure.subplots(1, 2)
    pv.plot(record.sp, color=SET_POINT, linewidth=0.8, label="SP")
    pv.plot(record.pv, color=MEASURED, linewidth=0.8, label="PV")
    pv.plot(found.model_pv, color=MODEL, linewidth=0.9, label=f"model, evidence {found.evidence:.1f}")
    op.plot(record.op, color=MEASURED, linewidth=0.8, label="OP and true valve")
    op.plot(found.model_mv, color=VALVE, linewidth=0.9, label=f"valve of the model, turns {found.turns}")
    for axes in (pv, op):
        axes.set_xlabel("sample")
        tidy(axes)
        legend_above(axes)
    return figure


def stiction_detector(detector: StictionDetector) -> Figure:
    """Draw what a detector sees where a valve sticks, and where the load swings and no valve does."""
    figure = Figure(figsize=(10.0, 3.6), layout="constrained")
    loops = MANY_PERIODS if detector.name in OF_NONLINEARITY else STUCK_AND_FREE
    for axes, (kind, seed) in zip(figure.subplots(1, 2), loops, strict=True):
        record = simulate(random_plant(seed, kind))
        window = LoopWindow(kind, 0.0, 1.0, record.op, record.pv, record.sp, record.mv)
        result = detector.detect(window, detect_oscillation(window))
        if result.seen is not None:
            PICTURES[detector.name](axes, result.seen)
        axes.set_title(f"{kind}: {result.verdict.replace('_', ' ')}", fontsize=10)
        tidy(axes)
    return figure


def workbench() -> dict[str, Figure]:
    """Draw the pages of the workbench: a valve that sticks, and a loop that lacks nothing."""
    pictures = {}
    drawn: tuple[tuple[str, Kind, int], ...] = (("stiction", "stiction", 3), ("nothing", "none_noise", 4))
    for name, kind, seed in drawn:
        record = simulate(random_plant(seed, kind))
        bench = Workbench(LoopWindow(name, 0.0, 1.0, record.op, record.pv, record.sp, record.mv))
        pictures[f"where_{name}"] = residual_panels_figure(name, bench.where_it_fails())
        if name == "stiction":
            pictures["candidates"] = candidates_figure(name, bench.candidates().candidates)
            bench.auto()
            pictures["staircase"] = comparison_figures(bench, bench.comparison())["staircase"]
    return pictures


if __name__ == "__main__":
    for draw in (
        oscillation_peak,
        free_run_search,
        contour_map,
        profile,
        process_steps,
        stiction_laws,
        chem10,
        load_like_a_dead_band,
    ):
        draw().savefig(HERE / f"{draw.__name__}.png", dpi=DPI)
    for each in LAWS:
        law_on_triangle(each).savefig(HERE / f"law_{each.name}.png", dpi=DPI)
    for detector in DETECTORS:
        stiction_detector(detector).savefig(HERE / f"detector_{detector.name}.png", dpi=DPI)
    overflowing_tanks().savefig(HERE / "effect_overflow.png", dpi=DPI)
    rubbing_drive().savefig(HERE / "effect_process_friction.png", dpi=DPI)
    for each_effect in EFFECTS:
        if each_effect.name in EFFECT_VALUES:
            effect_in_the_loop(each_effect).savefig(HERE / f"effect_{each_effect.name}.png", dpi=DPI)
    for name, figure in workbench().items():
        figure.savefig(HERE / f"workbench_{name}.png", dpi=DPI)
