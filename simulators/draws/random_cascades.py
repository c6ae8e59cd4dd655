"""Random flow loops whose set point another controller moves, or goes one way only.

As a historian of a refinery keeps them, every 5 to 10 s: they are loops of ``random_flows``, whose time
constants are few samples long, with other set points. A valve that sticks and whose stem never turns shows it
once, where it stood while OP moved on. A draw that does not show what its kind requires is discarded and the
next one tried.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from simulators.draws.random_flows import random_draw_of_flow
from simulators.draws.random_moves import keeps_promise, largest_rise, log_uniform
from simulators.parameters import SetPointStep
from simulators.plant import simulate

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from simulators.scenario import Scenario

CascadeKind = Literal["cascade", "cascade_stiction", "one_way", "one_way_stiction"]

TRAVEL = (0.3, 4.0)
"""Range of the standard deviation (cascade) or the whole way (one way) of the set point, as the travel of OP
that it requires over S."""
MEMORY = (0.02, 0.3)
"""Range of the correlation time of a wandering set point, over the length of the record."""
EVERY = (1.0, 30.0)
"""Range of the time between two set points of the outer controller, s."""
STEPS = (1.0, 30.0)
"""Range of the number of steps of a set point that goes one way."""
LEAST_LOST = 0.5
"""Travel of OP that a stem which never turns does not follow, at least, over S; and that it does follow."""
TURN = 0.05
"""Way back from which a stem turns, over S."""


def random_cascade(seed: int, kind: CascadeKind) -> Scenario:
    """Draw a loop of a kind; the same seed gives the same loop.

    - ``cascade``: the valve is sound, the set point wanders.
    - ``cascade_stiction``: it sticks, and its stem travels both ways.
    - ``one_way``: the valve is sound, the set point rises only or falls only.
    - ``one_way_stiction``: it sticks, and its stem stands, travels, and never turns.
    """
    rng = np.random.default_rng([seed, *kind.encode()])
    sticks = kind.endswith("stiction")
    while True:
        flow = random_draw_of_flow(rng, f"{kind}-{seed}", seed, sticks=sticks)
        s = flow.valve.f_s + flow.valve.f_d if sticks else log_uniform(rng, 1.5, 12.0)
        reach = s * abs(flow.process.gain) * log_uniform(rng, *TRAVEL)
        draw = _wandering if kind.startswith("cascade") else _one_way
        scenario = flow.model_copy(update={"set_points": draw(rng, flow.controller.sp, reach, flow.duration)})
        if kind == "one_way_stiction":
            if _sticks_once(scenario, s):
                return scenario
        elif keeps_promise(scenario, sticks=sticks):
            return scenario


def _wandering(
    rng: np.random.Generator, level: float, reach: float, duration: float
) -> tuple[SetPointStep, ...]:
    """Draw a set point that wanders about ``level`` (PV units) with the standard deviation ``reach``."""
    every = log_uniform(rng, *EVERY)
    keep = float(np.exp(-every / (duration * log_uniform(rng, *MEMORY))))
    # Smooth as the output of a controller is: noise of first order behind a lag.
    smooth = rng.uniform(0.0, 0.9)
    times = np.arange(0.0, duration, every)
    fresh = np.sqrt(1 - keep**2) * rng.normal(size=len(times))
    value, slow, levels = rng.normal(), 0.0, np.empty(len(times))
    for i, new in enumerate(fresh):
        value = keep * value + new
        slow = smooth * slow + (1 - smooth) * value if i else value
        levels[i] = level + reach * slow
    return _steps(times, levels)


def _one_way(
    rng: np.random.Generator, level: float, reach: float, duration: float
) -> tuple[SetPointStep, ...]:
    """Draw steps that go from ``level`` (PV units) up only or down only, ``reach`` in all."""
    count = max(1, round(log_uniform(rng, *STEPS)))
    times = np.sort(rng.uniform(0.0, duration, count))
    parts = rng.exponential(size=count)
    way = rng.choice([-1.0, 1.0]) * reach
    return _steps(times, level + way * np.cumsum(parts) / parts.sum())


def _steps(times: NDArray[np.float64], levels: NDArray[np.float64]) -> tuple[SetPointStep, ...]:
    return tuple(SetPointStep(time=float(time), sp=float(sp)) for time, sp in zip(times, levels, strict=True))


def _sticks_once(scenario: Scenario, s: float) -> bool:
    """Whether OP stays between its limits, and a stem stands, travels, and never turns."""
    record = simulate(scenario)
    low, high = scenario.op_range
    if record.op.min() <= low or record.op.max() >= high:
        return False
    forth, back = sorted((largest_rise(record.mv), largest_rise(-record.mv)), reverse=True)
    lost = float(np.ptp(record.op[:-1] - record.mv[1:]))
    return bool(back < TURN * s and forth > LEAST_LOST * s and lost > LEAST_LOST * s)
