"""Loops drawn at random, for measuring how often a diagnosis is right.

All have an OP range of 100 and a sampling time of 1 s. A draw whose loop does not show what its kind
requires is discarded and the next one tried.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from agent.units import FrictionBands
from simulators.draws.periodicity import period_and_strength
from simulators.parameters import (
    ControllerParameters,
    Drift,
    Noise,
    ProcessParameters,
    Quantisation,
    SinusoidParameters,
    ValveParameters,
)
from simulators.plant import simulate
from simulators.scenario import Scenario

Kind = Literal["stiction", "none_noise", "tuning", "sinusoid", "drift"]

DURATION = 2000.0
WARM_UP = 1000.0
PERIODS = (15.0, 200.0)
"""Shortest and longest period of a loop that must oscillate, s."""
STEADY = 0.4
"""Height of the autocorrelation one period on, from which a loop counts as oscillating."""
VISIBLE = 1.0
"""Span of OP from which a loop counts as oscillating, OP units."""
PEAK_SENSITIVITY: dict[Kind, tuple[float, float]] = {
    "stiction": (1.0, 3.0),
    "none_noise": (1.0, 2.0),
    "tuning": (12.0, 40.0),
    "sinusoid": (1.0, 2.0),
    "drift": (1.0, 2.0),
}
"""Range of the peak sensitivity by kind: up to 2 is well tuned, 12 is close to unstable."""
SHAPES = ((0.0, 0.15), (0.25, 0.75), (0.8, 1.0))
"""Ranges of J/S: dead band, both, stick-slip."""
NOISE_SHARE = (0.02, 0.3)
"""Range of the noise, share of the standard deviation that PV has without it."""


@dataclass(frozen=True, slots=True)
class Draw:
    """A random loop, and facts that its scenario does not contain."""

    scenario: Scenario
    noise_share: float | None
    """Standard deviation of the noise over that of PV without it; None where nothing but noise moves PV."""


def random_plant(seed: int, kind: Kind) -> Scenario:
    """Return the loop of ``random_draw``."""
    return random_draw(seed, kind).scenario


def random_draw(seed: int, kind: Kind) -> Draw:
    """Draw a loop of a kind; the same seed gives the same loop.

    - ``stiction``: limit cycle by friction: dead band, stick-slip or both, by Karnopp or LuGre.
    - ``none_noise``: well tuned, with noise only.
    - ``tuning``: just stable, so that noise keeps it oscillating.
    - ``sinusoid``: well tuned, its load oscillates.
    - ``drift``: well tuned, its load wanders.

    Noise on PV is 2 to 30 % of the standard deviation that PV has without it, where it has one.
    """
    rng = np.random.default_rng([seed, *kind.encode()])
    shape = SHAPES[
        rng.integers(len(SHAPES))
    ]  # once: else the shapes that cycle easily would crowd out the rest
    while True:
        scenario = _draw(rng, kind, shape, f"{kind}-{seed}", seed)
        low, high = PEAK_SENSITIVITY[kind]
        if not low <= scenario.peak_sensitivity <= high:
            continue
        noise_alone = kind in {"none_noise", "tuning"}
        spread = rng.uniform(0.5, 5.0) if noise_alone else float(np.std(simulate(scenario).pv))
        share = _log_uniform(rng, *NOISE_SHARE)
        scenario = _with_noise(scenario, rng, spread * share)
        if _keeps_promise(scenario, kind):
            return Draw(scenario, None if noise_alone else share)


def _draw(rng: np.random.Generator, kind: Kind, shape: tuple[float, float], name: str, seed: int) -> Scenario:
    """Draw a loop without noise."""
    acting: Literal["reverse", "direct"] = "direct" if rng.random() < 0.3 else "reverse"
    slack = kind == "stiction" and shape == SHAPES[0]  # a pure dead band cycles only with an integrator
    process = _process(rng, 1.0 if acting == "reverse" else -1.0, integrating=slack)
    disturbance, drift = SinusoidParameters(), Drift()
    if kind == "sinusoid":
        disturbance = SinusoidParameters(
            amplitude=_log_uniform(rng, 1, 10), period=_log_uniform(rng, 25, 150)
        )
    elif kind == "drift":
        drift = Drift(walk=_log_uniform(rng, 0.05, 0.4), ramp=rng.uniform(-0.003, 0.003))
    return Scenario(
        loop=name,
        duration=DURATION,
        warm_up=WARM_UP,
        seed=seed,
        process=process,
        controller=_controller(rng, process, acting, kind),
        valve=_sticking_valve(rng, shape)
        if kind == "stiction"
        else ValveParameters(damping=rng.uniform(0.1, 0.6)),
        disturbance=disturbance,
        drift=drift,
    )


def _process(rng: np.random.Generator, sign: float, *, integrating: bool) -> ProcessParameters:
    delay = _log_uniform(rng, 0.5, 12)
    kind = rng.choice(["first_order", "second_order", "integrating"])
    if integrating or kind == "integrating":
        return ProcessParameters(kind="integrating", gain=sign * _log_uniform(rng, 0.005, 0.05), delay=delay)
    gain, tau = sign * _log_uniform(rng, 0.5, 3), _log_uniform(rng, 3, 30)
    if kind == "first_order":
        return ProcessParameters(gain=gain, tau=tau, delay=delay)
    tau2 = tau * rng.uniform(0.2, 0.8)
    return ProcessParameters(kind="second_order", gain=gain, tau=tau, tau2=tau2, delay=delay)


def _controller(
    rng: np.random.Generator, process: ProcessParameters, acting: Literal["reverse", "direct"], kind: Kind
) -> ControllerParameters:
    """SIMC tuning (Skogestad 2003), varied as plants vary; close to the stability limit for ``tuning``."""
    half_second_lag = min(process.taus) / 2 if process.kind == "second_order" else 0.0
    dead_time = process.delay + 1.0 + half_second_lag
    wanted = dead_time * rng.uniform(1.0, 3.0)
    per_second = abs(process.gain) / (max(process.taus) + half_second_lag if process.taus else 1.0)
    slowest = max(process.taus) + half_second_lag if process.taus else np.inf
    kc = rng.uniform(0.8, 1.4) / (per_second * (wanted + dead_time))
    ti = rng.uniform(0.5, 1.1) * min(slowest, 4 * (wanted + dead_time))
    if kind == "tuning":
        kc *= rng.uniform(1.5, 5.0)
    return ControllerParameters(
        kc=float(kc), ti=float(ti), acting=acting, sp=rng.uniform(30, 150), op=rng.uniform(30, 70)
    )


def _sticking_valve(rng: np.random.Generator, shape: tuple[float, float]) -> ValveParameters:
    s = _log_uniform(rng, 1.5, 12)
    bands = FrictionBands.from_s_j(s, j=s * rng.uniform(*shape))
    return ValveParameters(
        law="karnopp" if rng.random() < 0.5 else "lugre",
        f_s=bands.f_s,
        f_d=bands.f_d,
        damping=rng.uniform(0.1, 0.6),
        tau_ip=rng.uniform(0.05, 0.3),
    )


def _with_noise(scenario: Scenario, rng: np.random.Generator, std: float) -> Scenario:
    """Add noise of ``std`` PV units, and quantisation in proportion to it."""
    correlation = rng.choice([0.0, 0.0, rng.uniform(0.5, 4.0)])
    quantisation = Quantisation(
        pv=rng.choice([0.0, std * rng.uniform(0.2, 2.0)]), op=rng.choice([0.0, 0.0, 0.01, 0.05])
    )
    return scenario.model_copy(
        update={"noise": Noise(std=std, correlation=correlation), "quantisation": quantisation}
    )


def _keeps_promise(scenario: Scenario, kind: Kind) -> bool:
    record = simulate(scenario)
    low, high = scenario.op_range
    if record.op.min() <= low or record.op.max() >= high:
        return False
    if kind in {"none_noise", "drift"}:
        return True
    period, strength = period_and_strength(record.mv)
    visible = bool(np.ptp(record.op) >= VISIBLE)
    return visible and PERIODS[0] <= period * scenario.ts <= PERIODS[1] and strength >= STEADY


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
