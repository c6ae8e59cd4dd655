"""Records of loops in manual, one known physical effect in each: steps of OP, a bump test, PRBS, on/off.

The loops are those of ``hidden_effects``. No controller acts: OP is what an engineer at the loop would do, or
a thermostat does. OP and PV begin at rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from simulators.disturbance import FirstOrderNoise, strength_of
from simulators.draws.hidden_effects import EVEN, hidden_effect_plant
from simulators.field import Field, response
from simulators.parameters import Drift, Noise, Quantisation, Wander

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from simulators.draws.hidden_effects import HiddenTruth
    from simulators.parameters import Bursts
    from simulators.scenario import Scenario

    FloatArray = NDArray[np.float64]

OpenKind = Literal["steps", "bump", "prbs", "on_off"]
OPEN_KINDS: tuple[OpenKind, ...] = get_args(OpenKind)
SETTLED = 5.0
"""Time that a step of a step test is held, in time constants and dead times."""
SAMPLES = {"steps": 1200, "bump": 600, "prbs": 1200, "on_off": 1500}
REACTS = 30.0
"""Time in which an integrating process, which never settles, has shown what OP does to it, s."""
BAND = 0.3
"""Half the hysteresis of the thermostat, over PV's answer to half the range of its OP."""


@dataclass(frozen=True, slots=True)
class OpenRecord:
    """One record in manual, and the truth about it. Arrays have shape (n,)."""

    kind: OpenKind
    truth: HiddenTruth
    scenario: Scenario
    op: FloatArray
    """OP units."""
    pv: FloatArray
    """PV units."""
    floor: FloatArray
    """Part of PV that no model of OP explains, PV units."""


def open_record(seed: int, kind: OpenKind, truth: HiddenTruth = "none", bursts: Bursts = EVEN) -> OpenRecord:
    """Draw a record; the same seed gives the same one. Its noise and loads come in ``bursts``.

    - ``steps``: OP steps to a new level of either direction whenever PV has settled.
    - ``bump``: OP rests, is moved by one step, stays, and is moved back.
    - ``prbs``: OP changes at random between two levels.
    - ``on_off``: a thermostat: OP goes to one of two levels as PV leaves a band.
    """
    plant = hidden_effect_plant(seed, truth, bursts=bursts)
    rng = np.random.default_rng([seed, *kind.encode()])
    first = plant.scenario.controller.op
    travel = max(abs(each.sp - plant.scenario.controller.sp) for each in plant.scenario.set_points)
    travel /= abs(plant.scenario.process.gain)
    count, ts = SAMPLES[kind], plant.scenario.ts
    memory = (plant.scenario.process.delay + sum(plant.scenario.process.taus or (REACTS,))) / ts
    held = _held(kind, count, memory)
    if plant.scenario.process.kind == "integrating":
        travel /= REACTS  # PV moves as long as OP is away from its balance
    sooner = count * ts / plant.scenario.duration
    events = {
        name: tuple(
            each.model_copy(update={"time": each.time * sooner}) for each in getattr(plant.scenario, name)
        )
        for name in ("load_steps", "gain_steps")
    }
    scenario = plant.scenario.model_copy(update=events)
    if kind == "on_off":
        op = _thermostat(scenario, count, travel)
    else:
        op = first + travel * _moves(rng, kind, count, held)
    pv = response(scenario, op)
    quiet = {"noise": Noise(), "drift": Drift(), "wander": Wander(), "quantisation": Quantisation()}
    floor = pv - response(scenario.model_copy(update=quiet), op)
    noise = FirstOrderNoise(scenario.noise.std, scenario.noise.correlation, ts, rng)
    strength = strength_of(bursts, ts, rng)
    measured = np.array([noise.next() * (strength.next() if strength else 1.0) for _ in range(count)])
    return OpenRecord(kind, truth, scenario, op, pv + measured, floor + measured)


def _held(kind: OpenKind, count: int, memory: float) -> int:
    """Return for how many samples OP stays where it is."""
    if kind == "prbs":
        return max(2, round(0.7 * memory))
    return min(max(5, round(SETTLED * memory)), count // (3 if kind == "bump" else 6))


def _moves(rng: np.random.Generator, kind: OpenKind, count: int, held: int) -> FloatArray:
    """Return OP about its first level, in parts of the travel, (n,)."""
    op = np.zeros(count)
    if kind == "bump":
        op[count // 8 : count // 8 + held] = rng.choice([-1.0, 1.0])
        return op
    if kind == "prbs":
        levels = rng.choice([-0.5, 0.5], count // held + 1)
    else:
        levels = np.concatenate(([0.0], rng.uniform(-1.0, 1.0, count // held)))
    return np.repeat(levels, held)[:count]


def _thermostat(scenario: Scenario, count: int, travel: float) -> FloatArray:
    """Return OP of two levels that change as PV leaves a band, OP units, (n,)."""
    field = Field(scenario, np.random.default_rng(scenario.seed).spawn(2)[1])
    first, gain = scenario.controller.op, scenario.process.gain
    band = BAND * abs(gain) * travel
    on, op = True, np.empty(count)
    for i in range(count):
        off = (field.pv - scenario.controller.sp) * np.sign(gain)
        on = off < band if on else off < -band
        op[i] = first + (travel if on else -travel)
        field.hold(float(op[i]), i * scenario.ts)
    return op
