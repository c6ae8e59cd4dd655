"""Further recordings of one loop: the same plant and controller, other days.

Process, controller, valve and converters stay, and so do kind and size of what comes from outside; when it
comes, which way and with which noise is drawn anew. Whether a valve that sticks shows it is left to chance,
as in a plant. Half of the loops have besides something that the models of the analysis do not know.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from simulators.draws.random_moves import log_uniform
from simulators.parameters import Drift, GainStep, LoadStepParameters, SetPointStep
from simulators.plant import simulate

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from simulators.scenario import Scenario

TRIES = 10
"""Draws of a recording before its loop is given up: OP must stay between its limits."""


def recordings_of(
    scenario: Scenario, rng: np.random.Generator, count: int, *, one_way: bool
) -> tuple[Scenario, ...] | None:
    """Return scenarios of one loop; None where its OP does not stay between its limits.

    Args:
        scenario: The loop as its own recording shows it.
        rng: Draws all that differs.
        count: How many recordings.
        one_way: Whether the set point of each goes up only or down only.
    """
    found = []
    for _ in range(count):
        drawn = (other_recording(scenario, rng, one_way=one_way) for _ in range(TRIES))
        kept = next((each for each in drawn if _within_limits(each)), None)
        if kept is None:
            return None
        found.append(kept)
    return tuple(found)


def other_recording(scenario: Scenario, rng: np.random.Generator, *, one_way: bool) -> Scenario:
    """Return the loop on another day."""
    wave = scenario.disturbance
    return scenario.model_copy(
        update={
            "seed": int(rng.integers(2**31)),
            "set_points": _set_points(scenario, rng, one_way=one_way),
            "load_steps": tuple(
                LoadStepParameters(time=float(time), load=float(step.load * rng.choice([-1.0, 1.0])))
                for time, step in zip(
                    _times(rng, scenario, len(scenario.load_steps)), scenario.load_steps, strict=True
                )
            ),
            "gain_steps": tuple(
                GainStep(time=float(time), factor=step.factor)
                for time, step in zip(
                    _times(rng, scenario, len(scenario.gain_steps)), scenario.gain_steps, strict=True
                )
            ),
            "drift": Drift(walk=scenario.drift.walk, ramp=scenario.drift.ramp * rng.choice([-1.0, 1.0])),
            "disturbance": wave.model_copy(update={"period": wave.period * log_uniform(rng, 0.7, 1.4)}),
        }
    )


def with_loads(scenario: Scenario, share: float) -> Scenario:
    """Return the loop with each of its loads by ``share`` as large."""
    drift, wander, wave = scenario.drift, scenario.wander, scenario.disturbance
    return scenario.model_copy(
        update={
            "load_steps": tuple(
                each.model_copy(update={"load": share * each.load}) for each in scenario.load_steps
            ),
            "drift": drift.model_copy(update={"ramp": share * drift.ramp, "walk": share * drift.walk}),
            "wander": wander.model_copy(update={"std": share * wander.std}),
            "disturbance": wave.model_copy(update={"amplitude": share * wave.amplitude}),
        }
    )


def with_something_unknown(scenario: Scenario, rng: np.random.Generator) -> Scenario:
    """Return the loop with one thing that the models of the analysis lack.

    A trim that is not linear, a transmitter that lags, a gain that changes, or, where the process does not
    integrate, an inverse response.
    """
    process, tau = scenario.process, max(scenario.process.taus, default=scenario.controller.ti / 4)
    names = ["trim", "transmitter", "gain", *(["lead"] if process.taus else [])]
    match rng.choice(names):
        case "trim":
            trim = log_uniform(rng, 3.0, 50.0) ** rng.choice([-1.0, 1.0])
            return scenario.model_copy(
                update={"valve": scenario.valve.model_copy(update={"rangeability": float(trim)})}
            )
        case "transmitter":
            return scenario.model_copy(update={"sensor_tau": tau * log_uniform(rng, 0.2, 1.0)})
        case "gain":
            step = GainStep(time=0.0, factor=float(log_uniform(rng, 1.2, 2.0) ** rng.choice([-1.0, 1.0])))
            return scenario.model_copy(update={"gain_steps": (step,)})
        case _:
            lead = process.model_copy(update={"lead": tau * log_uniform(rng, 0.1, 0.5)})
            return scenario.model_copy(update={"process": lead})


def _set_points(scenario: Scenario, rng: np.random.Generator, *, one_way: bool) -> tuple[SetPointStep, ...]:
    """Draw other set points of the same reach.

    One that another controller moves, at even times, gets other phases of the same spectrum; two steps are
    always even, and keep their times. Other steps get other times, and other heights to either side or, one
    way, other parts of the way up or down.
    """
    count = len(scenario.set_points)
    if not count:
        return ()
    level = scenario.controller.sp
    times = np.array([step.time for step in scenario.set_points])
    away = np.array([step.sp for step in scenario.set_points]) - level
    reach = float(np.max(np.abs(away)))
    if one_way:
        times, parts = _times(rng, scenario, count), rng.exponential(size=count)
        away = rng.choice([-1.0, 1.0]) * reach * np.cumsum(parts) / parts.sum()
    elif count > 1 and np.allclose(np.diff(times), times[1] - times[0]):
        away = _other_phases(away, rng)
    else:
        times, away = _times(rng, scenario, count), reach * rng.uniform(-1.0, 1.0, count)
    return tuple(
        SetPointStep(time=float(time), sp=float(level + each)) for time, each in zip(times, away, strict=True)
    )


def _other_phases(values: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.float64]:
    spectrum = np.fft.rfft(values)
    turned = np.abs(spectrum) * np.exp(2j * np.pi * rng.random(len(spectrum)))
    turned[0] = spectrum[0]
    return np.fft.irfft(turned, len(values))


def _times(rng: np.random.Generator, scenario: Scenario, count: int) -> NDArray[np.float64]:
    return np.sort(rng.uniform(0.0, scenario.duration, count))


def _within_limits(scenario: Scenario) -> bool:
    record, (low, high) = simulate(scenario), scenario.op_range
    return bool(record.op.min() > low and record.op.max() < high)
