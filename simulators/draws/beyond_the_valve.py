"""How effects beyond the valve are added to a random loop: trim, pipe, process, transmitter, waves."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np

from simulators.parameters import PipeParameters, SinusoidParameters, TransmitterParameters
from simulators.scenario import Scenario

BeyondName = Literal[
    "pv_gain",
    "titration",
    "split_range",
    "sensor_deadband",
    "wave",
    "transport_delay",
]
SHAPES = ("square", "sawtooth", "pulses")


def pv_gain(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """A root that is not extracted, or a vessel that radiates, in equal parts."""
    reach = travel(scenario)
    if rng.random() < 0.5:
        flow = reach * log_uniform(rng, 1.2, 4)
        return scenario.model_copy(update={"transmitter": TransmitterParameters(kind="square", flow=flow)})
    return changed(scenario, "process", {"absolute": reach * log_uniform(rng, 3, 10)})


def titration(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """A pH behind a buffer, from one that hardly bends to one that hardly helps."""
    strength = 2e-7 / (travel(scenario) * log_uniform(rng, 0.05, 0.5))
    shown = TransmitterParameters(
        kind="ph",
        ph=7.0 + rng.uniform(-0.8, 0.8),
        strength=strength,
        buffer=strength * travel(scenario) * rng.uniform(0.0, 0.5),
    )
    return scenario.model_copy(update={"transmitter": shown})


def split_range(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """A gap between two trims, the upper with another slope."""
    reach = travel(scenario)
    place = scenario.controller.op + reach * rng.uniform(-0.5, 0.5)
    width, slope = reach * rng.uniform(0.0, 0.6), log_uniform(rng, 0.4, 2.5)
    return changed(scenario, "valve", {"split": (place - width / 2, place + width / 2, slope)})


def sensor_deadband(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """A float that rubs."""
    shown = TransmitterParameters(dead_band=travel(scenario) * log_uniform(rng, 0.1, 0.6))
    return scenario.model_copy(update={"transmitter": shown})


def wave(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """A load that repeats itself and is no sinusoid."""
    shape = SHAPES[rng.integers(len(SHAPES))]
    amplitude, period = travel(scenario) * log_uniform(rng, 0.15, 1.0), log_uniform(rng, 50, 200)
    load = SinusoidParameters.model_validate({"amplitude": amplitude, "period": period, "shape": shape})
    return scenario.model_copy(update={"disturbance": load})


def transport_delay(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """A pipe before the process; the controller is tuned for the dead time of mean flow."""
    op, reach, dead_time = scenario.controller.op, travel(scenario), scenario.process.delay + scenario.ts
    no_flow, added = op - reach * rng.uniform(1.3, 2.5), max(scenario.process.taus) * log_uniform(rng, 0.5, 2)
    slower = changed(
        scenario, "controller", {"kc": scenario.controller.kc * dead_time / (dead_time + 1.5 * added)}
    )
    pipe = PipeParameters(volume=added * (op - no_flow), no_flow=no_flow)
    return slower.model_copy(update={"pipe": pipe})


def travel(scenario: Scenario) -> float:
    """OP that the largest step of the set point requires, OP units."""
    height = max(abs(step.sp - scenario.controller.sp) for step in scenario.set_points)
    return height / abs(scenario.process.gain)


def changed(scenario: Scenario, part: str, changes: Mapping[str, object]) -> Scenario:
    """Return the scenario with some parameters of a part changed."""
    new = getattr(scenario, part).model_copy(update=changes)
    return scenario.model_copy(update={part: new})


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw a number whose logarithm is spread evenly."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
