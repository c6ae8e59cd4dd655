"""Random loops that move seldom: set points move a few times in hours, OP ramps over a valve that stands.

As plants keep them: the controller acts every second, the historian keeps a sample every 5 to 10 s, often
with exception reporting. The controller is slow, so that a valve that sticks stands for tens of minutes while
OP ramps, slips once, and stands again. Moves may be smaller than S: then a window need not show anything,
and no draw is discarded for that.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from simulators.draws.random_flows import loads
from simulators.draws.random_moves import log_uniform, sticking
from simulators.historian import Historian
from simulators.parameters import (
    ControllerParameters,
    Noise,
    ProcessParameters,
    Quantisation,
    SetPointStep,
    ValveParameters,
)
from simulators.plant import simulate
from simulators.scenario import Scenario

SeldomKind = Literal["seldom", "seldom_stiction"]

S = (0.5, 8.0)
"""Range of f_S + f_D, OP units; in sound loops the measure of all moves."""
DURATION = 7200.0
"""s"""
EVERY = (5, 10)
"""Samples of the controller (1 s) to one that the historian keeps."""
FLOW_TAU, SLOW_TAU = (1.0, 10.0), (20.0, 300.0)
"""Ranges of the time constant of a flow, and of a pressure or temperature, s."""
DELAY_SHARE = (0.1, 1.0)
"""Range of the dead time over the time constant."""
LEVEL_GAIN = (5e-4, 1e-2)
"""Range of the gain of an integrating process, PV units per OP unit and second."""
PROCESSES = (0.5, 0.25, 0.25)
"""Shares of flow, of pressure or temperature, of level."""
SLOWER = (2.0, 60.0)
"""Range of the closed loop's time constant, over dead time and half a second."""
MOST_STEPS = 5
"""Steps of the set point in a window: none up to this many."""
TRAVEL = (0.1, 2.0)
"""Range of the height of set point steps, as the travel of OP that they require over S."""
LOAD = (0.03, 1.0)
"""Range of the travel of OP that a load requires in the window, over S."""
NOISE = (0.01, 0.5)
"""Range of the standard deviation of the noise, over that of PV for a travel of S."""
EXCEPTION_SHARE = 0.4
"""Part of the loops with exception reporting."""


class SeldomMoved(NamedTuple):
    """A loop, and how its historian keeps it."""

    scenario: Scenario
    historian: Historian


def seldom_moved(seed: int, kind: SeldomKind) -> SeldomMoved:
    """Draw a loop; the same seed gives the same loop. OP stays between its limits.

    - ``seldom``: the valve is sound.
    - ``seldom_stiction``: it sticks; what of it a window shows is left to chance.
    """
    rng = np.random.default_rng([seed, *kind.encode()])
    while True:
        drawn = _draw(rng, f"{kind}-{seed}", seed, sticks=kind == "seldom_stiction")
        op = simulate(drawn.scenario).op
        low, high = drawn.scenario.op_range
        if low < op.min() and op.max() < high:
            return drawn


def _draw(rng: np.random.Generator, name: str, seed: int, *, sticks: bool) -> SeldomMoved:
    acting: Literal["reverse", "direct"] = "direct" if rng.random() < 0.3 else "reverse"
    process = _process(rng, 1.0 if acting == "reverse" else -1.0)
    s = log_uniform(rng, *S)
    controller = _controller(rng, process, acting)
    # An integrating process moves on for as long as OP is off: here for the controller's integral time.
    lasting = 1.0 if process.taus else controller.ti
    height = s * abs(process.gain) * lasting
    noise = height * log_uniform(rng, *NOISE)
    sound = ValveParameters(damping=rng.uniform(0.1, 0.6))
    scenario = Scenario(
        loop=name,
        duration=DURATION,
        warm_up=1800.0,
        seed=seed,
        process=process,
        controller=controller,
        valve=sticking(rng, s, sound) if sticks else sound,
        set_points=_set_points(rng, controller.sp, height),
        sensor_tau=float(rng.choice([0.0, rng.uniform(0.5, 10.0)])),
        noise=Noise(std=noise, correlation=rng.choice([0.0, 0.0, rng.uniform(0.5, 20.0)])),
        quantisation=Quantisation(
            pv=rng.choice([0.0, noise * rng.uniform(0.2, 3.0)]), op=rng.choice([0.0, 0.01, 0.05])
        ),
    )
    scenario = scenario.model_copy(update=loads(rng, s, DURATION, LOAD))
    exceptions = rng.random() < EXCEPTION_SHARE
    historian = Historian(
        every=int(rng.choice(EVERY)),
        pv_band=float(noise * rng.uniform(0.5, 3.0)) if exceptions else 0.0,
        op_band=float(s * rng.uniform(0.0, 0.05)) if exceptions else 0.0,
    )
    return SeldomMoved(scenario, historian)


def _process(rng: np.random.Generator, sign: float) -> ProcessParameters:
    match rng.choice(["flow", "slow", "level"], p=PROCESSES):
        case "level":
            return ProcessParameters(
                kind="integrating", gain=sign * log_uniform(rng, *LEVEL_GAIN), delay=log_uniform(rng, 1, 30)
            )
        case "flow":
            tau, gain = log_uniform(rng, *FLOW_TAU), sign * log_uniform(rng, 0.5, 3)
            return ProcessParameters(gain=gain, tau=tau, delay=tau * log_uniform(rng, *DELAY_SHARE))
        case _:
            tau, gain = log_uniform(rng, *SLOW_TAU), sign * log_uniform(rng, 0.5, 3)
            delay = tau * log_uniform(rng, *DELAY_SHARE)
            return ProcessParameters(
                kind="second_order", gain=gain, tau=tau, tau2=tau * rng.uniform(0.1, 0.8), delay=delay
            )


def _controller(
    rng: np.random.Generator, process: ProcessParameters, acting: Literal["reverse", "direct"]
) -> ControllerParameters:
    """SIMC tuning (Skogestad 2003) for a slow closed loop, varied as plants vary."""
    lags = process.taus
    dead_time = process.delay + 0.5 + (min(lags) / 2 if len(lags) > 1 else 0.0)
    wanted = dead_time * log_uniform(rng, *SLOWER)
    per_second = abs(process.gain) / (max(lags) if lags else 1.0)
    kc = rng.uniform(0.7, 1.4) / (per_second * (wanted + dead_time))
    slowest = max(lags) if lags else np.inf
    ti = rng.uniform(0.7, 2.0) * min(slowest, 4 * (wanted + dead_time))
    return ControllerParameters(
        kc=float(kc), ti=float(ti), acting=acting, sp=rng.uniform(30, 150), op=rng.uniform(30, 70)
    )


def _set_points(rng: np.random.Generator, level: float, height: float) -> tuple[SetPointStep, ...]:
    """Draw the moves of an operator: steps that stay, each from the level of the one before."""
    times = np.sort(rng.uniform(0.0, DURATION, rng.integers(MOST_STEPS + 1)))
    moves = height * log_uniform(rng, *TRAVEL) * rng.uniform(-1, 1, len(times))
    levels = level + np.cumsum(moves)
    return tuple(SetPointStep(time=float(t), sp=float(sp)) for t, sp in zip(times, levels, strict=True))
