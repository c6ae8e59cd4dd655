"""Records in manual of plants whose process is nonlinear, with one known physical effect in each, or none.

Four balances by the equations of textbooks, integrated in small steps: two tanks by Torricelli's law, a
furnace that radiates, a heat exchanger, a neutralisation. Before them the valve of ``simulators.valve``. A
load wanders at the inflow, PV has white noise. OP goes to a new level at random, in ramps or steps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from simulators.disturbance import FirstOrderNoise
from simulators.draws.beyond_the_valve import log_uniform
from simulators.parameters import ValveParameters
from simulators.valve import STEP, SimulatedValve

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]
    Speed = Callable[[FloatArray, float], FloatArray]

NonlinearName = Literal["two_tanks", "heater", "heat_exchanger", "neutralisation"]
NONLINEAR: tuple[NonlinearName, ...] = get_args(NonlinearName)
HiddenName = Literal["none", "deadband", "stiction", "saturation", "load_step"]
HIDDEN: tuple[HiddenName, ...] = get_args(HiddenName)
SAMPLES, SETTLING = 600, 200
"""s, the record and what is before it."""
FIRST = 50.0
"""OP about which it moves."""
TRAVEL = (10.0, 25.0)
"""Range of OP's moves to either side, OP units."""
TAU = (5.0, 25.0)
"""Range of the time constant at ``FIRST``, s."""
WANDER, NOISE = (0.01, 0.08), (0.003, 0.02)
"""Deviation of the load over the travel, and of the noise over PV's span."""
SIZE = (0.2, 0.6)
"""Of the effect, over the travel."""
FINE = 10
"""Steps of the process in a sample of a second."""


@dataclass(frozen=True, slots=True)
class NonlinearRecord:
    """One record, and the truth about it. Arrays have shape (n,)."""

    process: NonlinearName
    truth: HiddenName
    op: FloatArray
    """OP units."""
    pv: FloatArray
    """PV units."""
    floor: FloatArray
    """Part of PV that no model of OP explains, PV units."""


@dataclass(frozen=True, slots=True)
class Balance:
    """A process: how fast its states move at an inflow in OP units, where they rest, and what is measured."""

    speed: Speed
    rest: FloatArray
    """At ``FIRST``, as good as known: it settles before the record."""
    shown: Callable[[FloatArray], FloatArray]
    """PV of the states, (n, k) to (n,)."""


def nonlinear_record(seed: int, process: NonlinearName, truth: HiddenName) -> NonlinearRecord:
    """Draw a record; the same seed gives the same one."""
    rng = np.random.default_rng([seed, *process.encode(), *truth.encode()])
    tau, travel = log_uniform(rng, *TAU), log_uniform(rng, *TRAVEL)
    balance = BALANCES[process](rng, tau)
    op = FIRST + travel * _moves(rng, tau)
    flow = _through(_valve(rng, truth, travel), op)
    step = np.zeros(len(op))
    if truth == "load_step":
        step[SETTLING + round(SAMPLES * rng.uniform(0.3, 0.7)) :] = (
            rng.choice([-1.0, 1.0]) * travel * rng.uniform(*SIZE)
        )
    load = FirstOrderNoise(travel * log_uniform(rng, *WANDER), log_uniform(rng, 10, 60), 1.0, rng)
    wander = np.array([load.next() for _ in op])
    clean = _run(balance, flow + step[:, np.newaxis])
    pv = _run(balance, flow + (step + wander)[:, np.newaxis])
    noise = log_uniform(rng, *NOISE) * float(np.ptp(clean)) * rng.standard_normal(len(op))
    kept = slice(SETTLING, None)
    return NonlinearRecord(process, truth, op[kept], (pv + noise)[kept], (pv + noise - clean)[kept])


def _moves(rng: np.random.Generator, tau: float) -> FloatArray:
    """Return OP about its first level, in parts of the travel, (n,): steps to levels, or ramps."""
    count, held = SETTLING + SAMPLES, tau * rng.uniform(1.0, 3.0)
    at = np.cumsum(rng.uniform(0.5, 1.5, count) * held)
    at = np.concatenate(([0.0], SETTLING / 2 + at[at < SAMPLES + SETTLING / 2]))
    levels = np.concatenate(([0.0], rng.uniform(-1.0, 1.0, len(at) - 1)))
    time = np.arange(count, dtype=np.float64)
    stepped = levels[np.searchsorted(at, time, side="right") - 1]
    return stepped if rng.random() < 0.5 else np.interp(time, at, levels)


def _valve(rng: np.random.Generator, truth: HiddenName, travel: float) -> ValveParameters:
    size = travel * rng.uniform(*SIZE)
    if truth == "deadband":
        return ValveParameters(backlash=size)
    if truth == "stiction":
        jump = size * rng.uniform(0.25, 0.9)
        return ValveParameters(f_s=(size + jump) / 2, f_d=(size - jump) / 2)
    if truth == "saturation":
        return ValveParameters(stops=(0.0, FIRST + travel - size))
    return ValveParameters()


def _through(parameters: ValveParameters, op: FloatArray) -> FloatArray:
    """Return the position of the plug, OP units, (n, ``FINE``)."""
    valve, dt = SimulatedValve(parameters, (0.0, 100.0), FIRST), STEP[parameters.law]
    steps = round(1 / dt)
    held = [valve.stroke(float(each), steps, dt) for each in op]
    return np.array([each.reshape(FINE, -1).mean(axis=1) for each in held])


def _run(balance: Balance, inflow: FloatArray) -> FloatArray:
    """Return PV at each sample, (n,), of an inflow, (n, ``FINE``), by the midpoint rule."""
    state, dt = balance.rest.copy(), 1.0 / FINE
    states = np.empty((len(inflow), len(state)))
    for t, held in enumerate(inflow.tolist()):
        states[t] = state
        for each in held:
            state = state + dt * balance.speed(state + 0.5 * dt * balance.speed(state, each), each)
    return balance.shown(states)


def _two_tanks(rng: np.random.Generator, tau: float) -> Balance:
    """Torricelli: k sqrt(level); a tank's time constant is twice its content over what flows."""
    rest = FIRST * np.array([tau, tau * rng.uniform(0.5, 2.0)]) / 2
    outlet = FIRST / np.sqrt(rest)

    def speed(level: FloatArray, inflow: float) -> FloatArray:
        first, second = outlet * np.sqrt(np.maximum(level, 0.0))
        return np.array([max(inflow, 0.0) - first, first - second])

    return Balance(speed, rest, lambda states: states[:, 1])


def _heater(rng: np.random.Generator, tau: float) -> Balance:
    """A furnace at 500 to 900 degrees Celsius, in a room of 20."""
    hot, room, zero = rng.uniform(500, 900), 20.0, -273.15
    radiated = rng.uniform(0.5, 1.0)
    per_kelvin = 4 * (hot - zero) ** 3 * radiated + (1 - radiated) * (hot - zero) ** 3
    scale = 1 / tau / per_kelvin
    radiation, loss = radiated * scale, (1 - radiated) * scale * (hot - zero) ** 3

    def lost(warm: float) -> float:
        return loss * (warm - room) + radiation * ((warm - zero) ** 4 - (room - zero) ** 4)

    heat = lost(hot) / FIRST

    def speed(state: FloatArray, inflow: float) -> FloatArray:
        return np.array([heat * inflow - lost(float(state[0]))])

    return Balance(speed, np.array([hot]), lambda states: states[:, 0])


def _heat_exchanger(rng: np.random.Generator, tau: float) -> Balance:
    """Water of 15 degrees is heated by steam of 120; the film's coefficient goes as flow to the power 0.8."""
    inlet, steam = 15.0, 120.0
    turnover = 1 / tau / FIRST / rng.uniform(1.5, 3.0)
    transfer = 1 / tau - turnover * FIRST
    wall = rng.uniform(0.2, 0.8)

    def speed(state: FloatArray, inflow: float) -> FloatArray:
        flow = max(inflow, 0.1)
        heated = transfer / (wall + (1 - wall) * (FIRST / flow) ** 0.8)
        return np.array([turnover * flow * (inlet - state[0]) + heated * (steam - state[0])])

    rest = (turnover * FIRST * inlet + transfer * steam) / (turnover * FIRST + transfer)
    return Balance(speed, np.array([rest]), lambda states: states[:, 0])


def _neutralisation(rng: np.random.Generator, tau: float) -> Balance:
    """Lye against an acid with a buffer of pKa 5 to 8; charges are balanced on a table."""
    neutral, pka = FIRST + rng.uniform(-5, 5), rng.uniform(5.0, 8.0)
    strength = log_uniform(rng, 3.0, 300.0)
    buffer = strength * rng.uniform(5.0, 30.0)
    ph = np.linspace(0.0, 14.0, 5601)
    held = buffer * (1 / (1 + 10 ** (pka - ph)) - 1 / (1 + 10 ** (pka - 7.0)))
    excess = (10 ** (ph - 7.0) - 10 ** (7.0 - ph) + held) / strength

    def speed(state: FloatArray, inflow: float) -> FloatArray:
        return np.array([(inflow - neutral - state[0]) / tau])

    return Balance(speed, np.array([FIRST - neutral]), lambda states: np.interp(states[:, 0], excess, ph))


BALANCES: dict[NonlinearName, Callable[[np.random.Generator, float], Balance]] = {
    "two_tanks": _two_tanks,
    "heater": _heater,
    "heat_exchanger": _heat_exchanger,
    "neutralisation": _neutralisation,
}
