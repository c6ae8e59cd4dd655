"""Random loops with one known physical effect, or two, or none: to test whether it is found and named.

A first-order process behind a pneumatic valve, its set point stepping at random, loads and noise on it; OP
range 100, 1 s. The effect is drawn from small to large. Beside OP and PV a loop has the part of PV that no
model of OP can explain: PV less the response of the same field to the same OP without other loads and without
noise.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from simulators.draws.beyond_the_valve import log_uniform
from simulators.draws.effect_draws import HIDE, SETTLING, EffectName
from simulators.field import response
from simulators.parameters import (
    Bursts,
    ControllerParameters,
    Drift,
    Noise,
    ProcessParameters,
    Quantisation,
    SetPointStep,
    ValveParameters,
    Wander,
)
from simulators.plant import simulate
from simulators.scenario import Scenario

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

Nothing = Literal["none", "coloured_noise", "slow_drift", "quantised"]
HiddenTruth = Literal[Nothing, EffectName, "stiction_sinusoid"]
NOTHING: tuple[Nothing, ...] = get_args(Nothing)
TRUTHS: tuple[HiddenTruth, ...] = (*NOTHING, *get_args(EffectName), "stiction_sinusoid")

SAMPLES = (1500.0, 3000.0)
TRAVEL = (4.0, 15.0)
"""Range of the set point's steps to either side, as the OP that they require, OP units."""
EVERY = (60.0, 200.0)
"""Mean time between steps of the set point, s."""
WANDER = (0.02, 0.15)
"""Range of the standard deviation of the load, over ``TRAVEL``."""
NOISE = (0.005, 0.05)
"""Range of that of the noise, over ``TRAVEL`` times the gain."""
PEAK_SENSITIVITY = 2.0
"""No loop is tuned more tightly."""
REACHED = 3.0
"""OP must keep within its limits, and a valve that sticks must have moved by so many times S in all."""
EVEN = Bursts()
"""Noise and loads that are as strong all the time."""


@dataclass(frozen=True, slots=True)
class HiddenEffectPlant:
    """One loop, and the truth about it. Arrays have shape (n,)."""

    truth: HiddenTruth
    effects: tuple[EffectName, ...]
    """That it has, in no order."""
    scenario: Scenario
    op: FloatArray
    """OP units."""
    pv: FloatArray
    """PV units."""
    sp: FloatArray
    """PV units."""
    floor: FloatArray
    """Part of PV that no model of OP explains: loads that are no effect, noise, converters; PV units."""

    @property
    def parameters(self) -> dict[str, tuple[float, ...]]:
        """True parameters of the effects, by the names and in the units of an identifier's.

        Two lags in a row have no order: either may pass for the effect, and so both are true. Instants are
        those of the first sample that PV is moved from: another gain waits for the dead time.
        """
        scenario, valve, process = self.scenario, self.scenario.valve, self.scenario.process
        s, j = scenario.truth.f_s + scenario.truth.f_d, scenario.truth.f_s - scenario.truth.f_d
        loads = tuple(self._instant(step.time) for step in scenario.load_steps)
        gains = tuple(self._instant(step.time) + process.delay for step in scenario.gain_steps)
        known: dict[EffectName, dict[str, tuple[float | None, ...]]] = {
            "deadband": {"s": (s,)},
            "stiction": {"s": (s,), "j_over_s": (j / s if s else None,)},
            "saturation": {"u_high": valve.stops[1:] if valve.stops else ()},
            "rate_limit": {"rate": (valve.rate,)},
            "actuator_lag": {"tau": (valve.tau_ip, process.tau)},
            "second_order": {"tau": (process.tau2, process.tau)},
            "sensor_lag": {"tau": (scenario.sensor_tau, process.tau)},
            "inverse_response": {"lead": (process.lead,)},
            "sinusoid": {"frequency": (1 / scenario.disturbance.period,)},
            "load_step": {"time": loads},
            "gain_change": {"time": gains},
            "wave": {"frequency": (1 / scenario.disturbance.period,)},
            "sensor_deadband": {"band": (scenario.transmitter.dead_band,)},
            "transport_delay": {"volume": (scenario.pipe.volume if scenario.pipe else None,)},
        }
        return {
            f"{effect}.{name}": tuple(value for value in values if value is not None)
            for effect in self.effects
            for name, values in known.get(effect, {}).items()
        }

    def _instant(self, time: float) -> float:
        """Return the first sample of the record from which a change at ``time`` acts, s."""
        ts = self.scenario.ts
        return math.ceil(time / ts) * ts - SETTLING * ts


def hidden_effect_plant(
    seed: int,
    truth: HiddenTruth,
    samples: tuple[float, float] = SAMPLES,
    bursts: Bursts = EVEN,
) -> HiddenEffectPlant:
    """Draw a loop of a length between two numbers of ``samples``; the same seed gives the same loop.

    Its noise and loads come in ``bursts``.

    - ``none``: set-point steps, a load that wanders, white noise; the others have these as well.
    - ``coloured_noise``: noise four times as high, with a memory of 3 to 30 s.
    - ``slow_drift``: the load ramps, and walks at random.
    - ``quantised``: PV in steps of two to six standard deviations of its noise.
    - an effect's name: that effect, as the plant's physics has it (``effect_draws``).
    - ``stiction_sinusoid``: both.
    """
    rng = np.random.default_rng([seed, *truth.encode()])
    effects: tuple[EffectName, ...]
    if truth == "stiction_sinusoid":
        effects = ("stiction", "sinusoid")
    else:
        effects = tuple(name for name in get_args(EffectName) if name == truth)
    while True:
        scenario = _with_nothing(rng, truth, seed, samples).model_copy(update={"bursts": bursts})
        for effect in effects:
            scenario = HIDE[effect](rng, scenario)
        if scenario.peak_sensitivity > PEAK_SENSITIVITY:
            continue
        record = simulate(scenario)
        if _keeps_promise(scenario, record.op, record.mv):
            break
    quiet = {"noise": Noise(), "drift": Drift(), "wander": Wander(), "quantisation": Quantisation()}
    floor = record.pv - response(scenario.model_copy(update=quiet), record.op)
    kept = slice(SETTLING, None)
    return HiddenEffectPlant(
        truth, effects, scenario, record.op[kept], record.pv[kept], record.sp[kept], floor[kept]
    )


def _with_nothing(
    rng: np.random.Generator, truth: HiddenTruth, seed: int, length: tuple[float, float]
) -> Scenario:
    sign = 1.0 if rng.random() < 0.7 else -1.0
    gain, tau, delay = sign * log_uniform(rng, 0.5, 3), log_uniform(rng, 4, 30), log_uniform(rng, 1, 10)
    process = ProcessParameters(gain=gain, tau=tau, delay=delay)
    travel, samples = log_uniform(rng, *TRAVEL), SETTLING + round(log_uniform(rng, *length))
    noise = Noise(std=abs(gain) * travel * log_uniform(rng, *NOISE))
    drift, quantisation = Drift(), Quantisation()
    if truth == "coloured_noise":
        noise = Noise(std=4 * noise.std, correlation=log_uniform(rng, 3, 30))
    elif truth == "slow_drift":
        ramp = rng.uniform(-1, 1) * travel / samples
        drift = Drift(ramp=ramp, walk=travel * log_uniform(rng, 0.1, 0.5) / np.sqrt(samples))
    elif truth == "quantised":
        quantisation = Quantisation(pv=noise.std * rng.uniform(2, 6))
    times = np.cumsum(rng.exponential(log_uniform(rng, *EVERY), samples // 20))
    sp, op = rng.uniform(30, 150), rng.uniform(40, 60)
    height = abs(gain) * travel
    steps = tuple(
        SetPointStep(time=float(time), sp=sp + height * rng.uniform(-1, 1)) for time in times[times < samples]
    )
    return Scenario(
        loop=f"{truth}-{seed}",
        duration=samples,
        warm_up=0,
        seed=int(rng.integers(2**31)),
        controller=_controller(rng, gain, tau, delay, sp=sp, op=op),
        valve=ValveParameters(damping=rng.uniform(0.1, 0.6)),
        process=process,
        noise=noise,
        wander=Wander(std=travel * log_uniform(rng, *WANDER), correlation=log_uniform(rng, 10, 60)),
        drift=drift,
        quantisation=quantisation,
        set_points=steps,
    )


def _controller(
    rng: np.random.Generator, gain: float, tau: float, delay: float, *, sp: float, op: float
) -> ControllerParameters:
    """SIMC tuning (Skogestad 2003) for the process without the effect, varied as plants vary."""
    dead_time = delay + 1.0
    wanted = dead_time * rng.uniform(1.0, 3.0)
    return ControllerParameters(
        kc=rng.uniform(0.8, 1.2) / (abs(gain) / tau * (wanted + dead_time)),
        ti=rng.uniform(0.7, 1.1) * min(tau, 4 * (wanted + dead_time)),
        acting="reverse" if gain > 0 else "direct",
        sp=sp,
        op=op,
    )


def _keeps_promise(scenario: Scenario, op: FloatArray, stem: FloatArray) -> bool:
    low, high = scenario.op_range
    if op.min() <= low or op.max() >= high:
        return False
    truth = scenario.truth
    return bool(np.abs(np.diff(stem[SETTLING:])).sum() >= REACHED * (truth.f_s + truth.f_d))
