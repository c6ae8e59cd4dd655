"""How each physical effect is added to a random loop, by the plant's physics; sizes are small to large."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Literal

import numpy as np

from agent.units import FrictionBands
from simulators.draws.beyond_the_valve import (
    BeyondName,
    changed,
    log_uniform,
    pv_gain,
    sensor_deadband,
    split_range,
    titration,
    transport_delay,
    travel,
    wave,
)
from simulators.parameters import GainStep, LoadStepParameters, SinusoidParameters
from simulators.scenario import Scenario

EffectName = Literal[
    "deadband",
    "stiction",
    "asymmetric_stiction",
    "saturation",
    "characteristic",
    "rate_limit",
    "actuator_lag",
    "second_order",
    "sensor_lag",
    "integrating",
    "inverse_response",
    "sinusoid",
    "load_step",
    "gain_change",
    BeyondName,
]
SETTLING = 600
"""Samples before the record begins."""
SIZE = (0.1, 1.0)
"""Range of an effect in OP units, over the travel of OP that the set point requires."""
LAG = (0.2, 1.0)
"""Range of an effect's time constant, over that of the process."""
ONE_WAY = (0.25, 4.0)
"""Friction of a closing stem over that of an opening one."""


def deadband(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """Slack between stem and plug, or friction that does not fall as the stem moves, in equal parts."""
    size = _size(rng, scenario)
    return changed(scenario, "valve", {"backlash": size} if rng.random() < 0.5 else _friction(rng, size, 0.0))


def stiction(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """Friction that falls to 0.01 to 0.6 of itself as the stem moves."""
    return changed(scenario, "valve", _friction(rng, _size(rng, scenario), rng.uniform(0.25, 0.98)))


def asymmetric_stiction(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """Friction four times as high one way as the other."""
    closing = float(rng.choice(ONE_WAY))
    opening = _size(rng, scenario) / max(closing, 1.0)
    friction = _friction(rng, opening, rng.uniform(0.25, 0.98))
    return changed(scenario, "valve", {**friction, "closing": closing})


def saturation(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """A stop that the set point's higher steps would exceed."""
    high = scenario.controller.op + travel(scenario) * rng.uniform(0.1, 0.8)
    return changed(scenario, "valve", {"stops": (0.0, high)})


def characteristic(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """Equal percentage or quick opening; at the operating point the gain is unchanged."""
    rangeability = log_uniform(rng, 4, 50) ** rng.choice([-1.0, 1.0])
    at = rangeability ** (scenario.controller.op / 100)
    slope = float(np.log(rangeability) * at / (rangeability - 1))
    trimmed = changed(scenario, "valve", {"rangeability": rangeability})
    return changed(trimmed, "process", {"gain": scenario.process.gain / slope})


def rate_limit(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """Air for the travel in 5 to 60 s."""
    return changed(scenario, "valve", {"rate": travel(scenario) / log_uniform(rng, 5, 60)})


def actuator_lag(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """A slow actuator."""
    return changed(scenario, "valve", {"tau_ip": _lag(rng, scenario)})


def second_order(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """A second lag of the process."""
    return changed(scenario, "process", {"kind": "second_order", "tau2": _lag(rng, scenario)})


def sensor_lag(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """A damped transmitter."""
    return scenario.model_copy(update={"sensor_tau": _lag(rng, scenario)})


def integrating(_: np.random.Generator, scenario: Scenario) -> Scenario:
    """An integrator in place of the lag."""
    process = scenario.process
    without_lag = {"kind": "integrating", "gain": process.gain / (process.tau or 1.0), "tau": None}
    return changed(scenario, "process", without_lag)


def inverse_response(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """A first move the wrong way."""
    return changed(scenario, "process", {"lead": _lag(rng, scenario)})


def sinusoid(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """A load that oscillates."""
    wave = SinusoidParameters(amplitude=_size(rng, scenario), period=log_uniform(rng, 25, 150))
    return scenario.model_copy(update={"disturbance": wave})


def load_step(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """One to three steps of the load, up or down."""
    shares = np.sort(rng.uniform(0.1, 0.9, rng.integers(1, 4)))
    loads = np.cumsum(_size(rng, scenario) * rng.choice([-1.0, 1.0], len(shares)))
    steps = [
        LoadStepParameters(time=_within(share, scenario), load=float(load))
        for share, load in zip(shares, loads, strict=True)
    ]
    return scenario.model_copy(update={"load_steps": tuple(steps)})


def gain_change(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """More or less flow for the same stroke from some time on."""
    factor = log_uniform(rng, 1.2, 1.8) ** rng.choice([-1.0, 1.0])
    step = GainStep(time=_within(rng.uniform(0.3, 0.7), scenario), factor=factor)
    return scenario.model_copy(update={"gain_steps": (step,)})


HIDE: Mapping[EffectName, Callable[[np.random.Generator, Scenario], Scenario]] = {
    "deadband": deadband,
    "stiction": stiction,
    "asymmetric_stiction": asymmetric_stiction,
    "saturation": saturation,
    "characteristic": characteristic,
    "rate_limit": rate_limit,
    "actuator_lag": actuator_lag,
    "second_order": second_order,
    "sensor_lag": sensor_lag,
    "integrating": integrating,
    "inverse_response": inverse_response,
    "sinusoid": sinusoid,
    "load_step": load_step,
    "gain_change": gain_change,
    "pv_gain": pv_gain,
    "titration": titration,
    "split_range": split_range,
    "sensor_deadband": sensor_deadband,
    "wave": wave,
    "transport_delay": transport_delay,
}
"""Each returns the loop with the effect, drawn at random."""


def _size(rng: np.random.Generator, scenario: Scenario) -> float:
    return travel(scenario) * log_uniform(rng, *SIZE)


def _lag(rng: np.random.Generator, scenario: Scenario) -> float:
    return max(scenario.process.taus) * log_uniform(rng, *LAG)


def _within(share: float, scenario: Scenario) -> float:
    """A time in the record, s from the start of the run."""
    return SETTLING * scenario.ts + float(share) * (scenario.duration - SETTLING * scenario.ts)


def _friction(rng: np.random.Generator, s: float, slip: float) -> dict[str, object]:
    """Friction with S ``s``, OP units, and J/S ``slip``."""
    bands = FrictionBands.from_s_j(s, j=s * slip)
    return {"law": "karnopp" if rng.random() < 0.5 else "lugre", "f_s": bands.f_s, "f_d": bands.f_d}
