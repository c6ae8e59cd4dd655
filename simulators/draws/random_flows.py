"""Random flow and pressure loops as a historian keeps them: PV follows the valve within few samples.

The controller is slow, as such loops are tuned; set points step seldom or often, loads wander, ramp or step.
So OP travels for long stretches and seldom reverses, which is rare in ``random_plants``. All have an OP range
of 100 and a sampling time of 1 s. A draw that does not show what its kind requires is discarded and the next
one tried.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from simulators.draws.random_moves import keeps_promise, log_uniform, sticking
from simulators.parameters import (
    ControllerParameters,
    Drift,
    LoadStepParameters,
    Noise,
    ProcessParameters,
    Quantisation,
    SetPointStep,
    SinusoidParameters,
    ValveParameters,
    Wander,
)
from simulators.scenario import Scenario

FlowKind = Literal["flow", "flow_stiction"]

S = (1.5, 12.0)
"""Range of f_S + f_D, OP units, as in ``random_plants``; in sound loops the measure of all moves."""
DURATION = (400.0, 2000.0)
"""Range of the length of a record, s."""
TAU = (0.5, 6.0)
"""Range of the time constant, s: a few samples at most."""
DELAY = (0.2, 3.0)
"""Range of the dead time, s."""
SLOWER = (2.0, 40.0)
"""Range of the closed loop's time constant, over dead time and half a sample."""
STEPS = (1.0, 30.0)
"""Range of the number of steps of the set point, in three loops of four; the fourth has none."""
TRAVEL = (0.5, 4.0)
"""Range of the height of set point steps, as the travel of OP that they require over S."""
LOAD = (0.1, 2.0)
"""Range of the travel of OP that a load requires in the whole record, over S."""
NOISE = (0.01, 0.3)
"""Range of the standard deviation of the noise, over that of PV for a travel of S."""


def random_flow(seed: int, kind: FlowKind) -> Scenario:
    """Draw a loop of a kind; the same seed gives the same loop.

    - ``flow``: the valve is sound.
    - ``flow_stiction``: it sticks, and its stem travels both ways.
    """
    rng = np.random.default_rng([seed, *kind.encode()])
    while True:
        scenario = random_draw_of_flow(rng, f"{kind}-{seed}", seed, sticks=kind == "flow_stiction")
        if keeps_promise(scenario, sticks=kind == "flow_stiction"):
            return scenario


def random_draw_of_flow(rng: np.random.Generator, name: str, seed: int, *, sticks: bool) -> Scenario:
    """Draw a flow loop, without a check of what it does."""
    acting: Literal["reverse", "direct"] = "direct" if rng.random() < 0.3 else "reverse"
    sign = 1.0 if acting == "reverse" else -1.0
    process = ProcessParameters(
        gain=sign * log_uniform(rng, 0.5, 3), tau=log_uniform(rng, *TAU), delay=log_uniform(rng, *DELAY)
    )
    s, duration = log_uniform(rng, *S), float(round(log_uniform(rng, *DURATION)))
    controller = _slow_controller(rng, process, acting)
    sound = ValveParameters(damping=rng.uniform(0.1, 0.6))
    noise = s * abs(process.gain) * log_uniform(rng, *NOISE)
    scenario = Scenario(
        loop=name,
        duration=duration,
        warm_up=1000.0,
        seed=seed,
        process=process,
        controller=controller,
        valve=sticking(rng, s, sound) if sticks else sound,
        set_points=_set_points(rng, controller.sp, s * abs(process.gain), duration),
        noise=Noise(std=noise, correlation=rng.choice([0.0, 0.0, rng.uniform(0.5, 4.0)])),
        quantisation=Quantisation(
            pv=rng.choice([0.0, noise * rng.uniform(0.2, 2.0)]), op=rng.choice([0.0, 0.0, 0.01, 0.05])
        ),
    )
    return scenario.model_copy(update=loads(rng, s, duration))


def _slow_controller(
    rng: np.random.Generator, process: ProcessParameters, acting: Literal["reverse", "direct"]
) -> ControllerParameters:
    """SIMC tuning (Skogestad 2003) for a closed loop that is slow against the dead time."""
    slowest = max(process.taus)
    wanted = (process.delay + 0.5) * log_uniform(rng, *SLOWER)
    kc = slowest / (abs(process.gain) * (wanted + process.delay))
    ti = min(slowest, 4 * (wanted + process.delay)) * rng.uniform(0.7, 2.0)
    return ControllerParameters(
        kc=float(kc), ti=float(ti), acting=acting, sp=rng.uniform(30, 150), op=rng.uniform(30, 70)
    )


def _set_points(
    rng: np.random.Generator, level: float, height: float, duration: float
) -> tuple[SetPointStep, ...]:
    """Draw steps to either side of ``level`` (PV units), ``height`` of them for a travel of S."""
    if rng.random() < 0.25:
        return ()
    times = np.sort(rng.uniform(0.0, duration, round(log_uniform(rng, *STEPS))))
    reach = height * log_uniform(rng, *TRAVEL)
    return tuple(
        SetPointStep(time=float(time), sp=float(level + reach * rng.uniform(-1, 1))) for time in times
    )


def loads(
    rng: np.random.Generator, s: float, duration: float, sizes: tuple[float, float] = LOAD
) -> dict[str, Drift | Wander | SinusoidParameters | tuple[LoadStepParameters, ...]]:
    """Draw one or two loads: a walk, a ramp, one that wanders about zero, steps, a slow wave.

    Args:
        rng: Draws them.
        s: Measure of their size, OP units.
        duration: Of the record, s.
        sizes: Range of the travel of OP that one requires in the whole record, over ``s``.
    """
    names = rng.choice(["walk", "ramp", "wander", "steps", "wave"], size=rng.integers(1, 3), replace=False)
    drawn: dict[str, Drift | Wander | SinusoidParameters | tuple[LoadStepParameters, ...]] = {}
    walk = ramp = 0.0
    for name in names:
        size = s * log_uniform(rng, *sizes)
        if name == "walk":
            walk = float(size / np.sqrt(duration))
        elif name == "ramp":
            ramp = size / duration
        elif name == "wander":
            drawn["wander"] = Wander(std=size / 2, correlation=log_uniform(rng, 10, 300))
        elif name == "wave":
            drawn["disturbance"] = SinusoidParameters(
                amplitude=size / 2, period=duration * log_uniform(rng, 0.05, 1.0)
            )
        else:
            times = np.sort(rng.uniform(0.0, duration, rng.integers(1, 8)))
            drawn["load_steps"] = tuple(
                LoadStepParameters(time=float(time), load=float(size * rng.uniform(-1, 1))) for time in times
            )
    return drawn | {"drift": Drift(walk=walk, ramp=ramp)}
