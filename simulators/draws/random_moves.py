"""Random loops whose valve is moved by more than a limit cycle: by set points that step, by a load as well.

They are those of ``random_plants``, changed. All have an OP range of 100 and a sampling time of 1 s. A draw
that does not show what its kind requires is discarded and the next one tried.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from agent.units import FrictionBands
from simulators.draws.random_plants import SHAPES, random_draw
from simulators.parameters import Drift, SetPointStep, SinusoidParameters, ValveParameters
from simulators.plant import simulate

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from simulators.scenario import Scenario

MovedKind = Literal["set_point", "set_point_stiction", "stiction_sinusoid"]

S = (1.5, 12.0)
"""Range of f_S + f_D, OP units, as in ``random_plants``."""
TRAVEL = (1.0, 4.0)
"""Range of the steps of the set point, as the travel of OP that they require over S."""
STEPS = (1.0, 40.0)
"""Range of the number of steps in a record."""
DURATION = (600.0, 2000.0)
"""Range of the length of a record, s."""
LOAD = (0.3, 1.5)
"""Range of the amplitude of a load that oscillates, over S."""


def random_moved(seed: int, kind: MovedKind) -> Scenario:
    """Draw a loop of a kind; the same seed gives the same loop.

    - ``set_point``: a loop of the kind ``drift`` that wanders less and whose set point steps 1 to 40 times.
    - ``set_point_stiction``: the same, but its valve sticks and its stem travels both ways.
    - ``stiction_sinusoid``: a loop of the kind ``stiction`` whose load oscillates with a period of its own.
    """
    rng = np.random.default_rng([seed, *kind.encode()])
    while True:
        inner = int(rng.integers(2**31))
        scenario = _swung(rng, inner) if kind == "stiction_sinusoid" else _stepped(rng, inner, kind)
        if keeps_promise(scenario, sticks=kind != "set_point"):
            return scenario.model_copy(update={"loop": f"{kind}-{seed}"})


def _swung(rng: np.random.Generator, seed: int) -> Scenario:
    scenario = random_draw(seed, "stiction").scenario
    s = scenario.valve.f_s + scenario.valve.f_d
    load = SinusoidParameters(amplitude=s * log_uniform(rng, *LOAD), period=log_uniform(rng, 25, 150))
    return scenario.model_copy(update={"disturbance": load})


def _stepped(rng: np.random.Generator, seed: int, kind: MovedKind) -> Scenario:
    base = random_draw(seed, "drift").scenario
    s = log_uniform(rng, *S)
    duration = round(log_uniform(rng, *DURATION))
    times = np.sort(rng.uniform(0.0, duration, round(log_uniform(rng, *STEPS))))
    # An integrating process moves on for as long as OP is off: here for the controller's integral time.
    lasting = 1.0 if base.process.taus else base.controller.ti
    height = abs(base.process.gain) * lasting * s * log_uniform(rng, *TRAVEL)
    levels = base.controller.sp + height * rng.uniform(-1.0, 1.0, len(times))
    steps = tuple(
        SetPointStep(time=float(time), sp=float(sp)) for time, sp in zip(times, levels, strict=True)
    )
    walk = Drift(walk=base.drift.walk * log_uniform(rng, 0.03, 1.0), ramp=base.drift.ramp)
    valve = sticking(rng, s, base.valve) if kind == "set_point_stiction" else base.valve
    changed = {"duration": float(duration), "set_points": steps, "drift": walk, "valve": valve}
    return base.model_copy(update=changed)


def sticking(rng: np.random.Generator, s: float, sound: ValveParameters) -> ValveParameters:
    """Draw friction with a stick band of ``s`` OP units for a valve that has none."""
    bands = FrictionBands.from_s_j(s, j=s * rng.uniform(*SHAPES[rng.integers(len(SHAPES))]))
    friction = {"law": "karnopp" if rng.random() < 0.5 else "lugre", "f_s": bands.f_s, "f_d": bands.f_d}
    return sound.model_copy(update={**friction, "tau_ip": rng.uniform(0.05, 0.3)})


def keeps_promise(scenario: Scenario, *, sticks: bool) -> bool:
    """Whether OP stays between its limits and a stem that sticks travels both ways."""
    record = simulate(scenario)
    low, high = scenario.op_range
    if record.op.min() <= low or record.op.max() >= high:
        return False
    if not sticks:
        return True
    half = (scenario.valve.f_s + scenario.valve.f_d) / 2
    return bool(largest_rise(record.mv) > half and largest_rise(-record.mv) > half)


def largest_rise(values: NDArray[np.float64]) -> float:
    """Return the most by which ``values`` (n,) exceed one of those before."""
    return float(np.max(values - np.minimum.accumulate(values)))


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw from ``low`` to ``high``, each factor as likely as another."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
