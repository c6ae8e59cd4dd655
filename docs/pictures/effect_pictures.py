"""Pictures of effects in a loop, and of what a model without them leaves; ``make.py`` draws them."""
# ruff: noqa: INP001 - beside its pictures, no package

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from agent.physics.bases import BASES
from agent.physics.bases.linear_process import LinearProcess
from agent.physics.bases.two_tanks import TwoTanks
from agent.physics.effect import Effect, Facts
from agent.physics.effects.process_friction import ProcessFriction
from agent.physics.loop_model import LoopModel
from agent.plots.axes import MEASURED, MODEL, VALVE, legend_above, tidy
from simulators.draws.random_plants import random_plant
from simulators.plant import simulate

FloatArray = NDArray[np.float64]
Curve = tuple[str, FloatArray]
"""Label and values, (n,)."""
EFFECT_VALUES: dict[str, tuple[float, ...]] = {
    "deadband": (0.5, 0.3, 0.1),
    "stiction": (0.5, 0.5, 0.3, 0.3, 0.1, 0.01, 0.01),
    "asymmetric_stiction": (0.25, 0.1, 0.4, 0.3, 0.3, 0.1, 0.01),
    "saturation": (0.2, 0.75),
    "characteristic": (3.0,),
    "split_range": (0.35, 0.15, 2.0),
    "pv_gain": (2.0,),
    "loss_curve": (1.5, 0.5),
    "square_law": (-0.1,),
    "titration": (0.5, 0.1),
    "sensor_deadband": (0.25, 0.0),
    "transport_delay": (16.0, -0.2, 0.13),
    "rate_limit": (0.02,),
    "actuator_lag": (10.0,),
    "second_order": (10.0,),
    "sensor_lag": (10.0,),
    "integrating": (0.05,),
    "inverse_response": (15.0,),
    "sinusoid": (0.031,),
    "wave": (0.021,),
    "load_step": (40.0, 100.0, 150.0, 15.0),
    "gain_change": (100.0, 0.0, 8.0),
}
"""Values in s, and in OP spans where the unit has OP in it."""
FROM_ZERO = {"u_low", "u_high", "place", "middle", "no_flow", "level"}
"""Parameters that are values of OP, given above the least OP."""


def rubbing_drive() -> Figure:
    """Draw the place of a driven mass with Coulomb friction and without, for the same drive."""
    t = np.arange(0.0, 400.0)
    op = 50 + 10 * np.sin(2 * np.pi * t / 100) * np.linspace(0.4, 1.0, len(t))
    free = LinearProcess(4.0, (8.0, 0.0), integrates=True)
    rubbing = ProcessFriction().change(free, np.array([3.0, 50.0]))
    return _beside(
        t,
        ("OP", op),
        ("PV with friction", rubbing.respond(op, 1.0)),
        ("PV without", free.respond(op, 1.0)),
    )


def overflowing_tanks() -> Figure:
    """Draw PV of two tanks with limits and without, for the same pump."""
    t = np.arange(0.0, 1600.0, 4.0)
    pump = 3.0 + 2.0 * np.sin(2 * np.pi * t / 400) * np.linspace(0.4, 1.0, len(t))
    free = TwoTanks(0.05, 0.05, 0.5, 0.05, 0.5, 0.0, 6.0, 6.0)
    full = free._replace(limit_1=12.0, limit_2=10.0, share=0.5)
    return _beside(
        t,
        ("pump (OP units)", pump),
        ("PV with overflow", full.respond(pump, 4.0)),
        ("PV of tanks without limits", free.respond(pump, 4.0)),
    )


def _beside(t: FloatArray, given: Curve, with_effect: Curve, without: Curve) -> Figure:
    """Draw what is given over time, t (n,), s, and below it PV with an effect and without."""
    figure = Figure(figsize=(9.0, 4.4), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    curves = ((above, given, MEASURED, 1.1), (below, with_effect, MODEL, 1.2), (below, without, VALVE, 1.2))
    for axes, (label, values), color, width in curves:
        axes.plot(t, values, color=color, linewidth=width, label=label)
    below.set_xlabel("time (s)")
    for axes in (above, below):
        tidy(axes)
        axes.legend(fontsize=9)
    return figure


def effect_in_the_loop(effect: Effect) -> Figure:
    """Draw valve and PV of a first-order process with an effect, and what a model without it leaves.

    OP is that of a simulated loop, stretched to 40 to 80.
    """
    low, span = 40.0, 40.0
    recorded_op = simulate(random_plant(1, "sinusoid")).op[:200]
    op = np.interp(recorded_op, (recorded_op.min(), recorded_op.max()), (low, low + span))
    facts = Facts(1.0, len(op), low, low + span, 0.0, 1.0, 50.0, 1.6, 1)
    scale = {"OP": span, "OP/s": span, "OP*s": span, "1/OP": 1 / span}
    own = [
        value * scale.get(each.unit, 1.0) + (low if each.name in FROM_ZERO else 0.0)
        for value, each in zip(EFFECT_VALUES[effect.name], effect.parameters(facts), strict=True)
    ]
    model, values = LoopModel(BASES[0], (effect,)), np.array([4.0, 8.0, *own])
    columns = model.columns(op, values, facts)
    pv = columns @ np.array([1.0, *np.full(columns.shape[1] - 1, 0.6 if effect.family == "gain" else 12.0)])
    without = np.column_stack((LoopModel(BASES[0]).columns(op, values[:2], facts), np.ones(len(op))))
    fitted = without @ np.linalg.lstsq(without, pv, rcond=None)[0]
    figure = Figure(figsize=(11.0, 3.0), layout="constrained")
    valve, process, residual = figure.subplots(1, 3)
    valve.plot(op, color=MEASURED, linewidth=1.0, label="OP")
    if effect.stage == "valve":
        position = model.position(op, values, facts)
        if effect.family == "valve_characteristic":
            position = np.interp(position, (position.min(), position.max()), (low, low + span))
        valve.plot(position, color=VALVE, linewidth=1.2, label="valve")
    valve.set_ylabel("OP units")
    process.plot(fitted, color=MEASURED, linewidth=1.0, label="model without")
    process.plot(pv, color=MODEL, linewidth=1.2, label=f"PV with {effect.name}")
    process.set_ylabel("PV over gain (OP units)")
    residual.plot(pv - fitted, color=MODEL, linewidth=1.0, label="PV less model")
    for axes in (valve, process, residual):
        axes.set_xlabel("time (s)")
        legend_above(axes)
        tidy(axes)
    return figure
