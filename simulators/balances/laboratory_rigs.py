"""Laboratory rigs that system identification is tried on, by their equations.

Each is sampled as its original is, far faster than a control loop as a rule. Sources: the benchmarks of
nonlinearbenchmark.org (silverbox, Bouc-Wen, coupled electric drives) and DaISy, KU Leuven (robot arm, wing
flutter, hair dryer, ball and beam); J. Deur et al., "An electronic throttle control strategy including
compensation of friction and limp-home effects", IEEE Trans. Ind. Appl. 40 (2004) 821; J. Hedengren, TCLab.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
from scipy.signal import cont2discrete, lfilter

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]
    Speed = Callable[[FloatArray, float], FloatArray]

LaboratoryRigName = Literal[
    "arm", "plate", "hard_spring", "hysteretic_spring", "drives", "dryer", "ball", "throttle", "thermostat",
    "coarse_heater",
]  # fmt: skip
LABORATORY_RIGS: tuple[LaboratoryRigName, ...] = get_args(LaboratoryRigName)
STEFAN_BOLTZMANN = 5.67e-8
"""W/m2/K4."""
ROOM = 296.0
"""K."""


@dataclass(frozen=True, slots=True)
class LaboratoryRig:
    """A record of one. Arrays have shape (n,)."""

    ts: float
    """s."""
    op: FloatArray
    pv: FloatArray


def laboratory_rig(seed: int, name: LaboratoryRigName) -> LaboratoryRig:
    """Draw a record; the same seed gives the same one."""
    rng = np.random.default_rng([seed, *name.encode()])
    ts, op, clean, noise = RIGS[name](rng)
    pv = clean + noise * rng.standard_normal(len(op))
    if name == "coarse_heater":
        pv = np.round(pv / 0.32) * 0.32  # the converter of the board
    return LaboratoryRig(ts, op, pv)


Drawn = tuple[float, "FloatArray", "FloatArray", float]
"""Sampling time, OP, PV without noise, deviation of the noise."""


def _arm(rng: np.random.Generator) -> Drawn:
    """Two weakly damped resonances with one between them at which nothing moves."""
    op, ts = _multisine(rng, 1024, 10, 256), 0.002
    low, high, still = 2 * np.pi * rng.uniform(0.9, 1.1, 3) * np.array([24.0, 75.0, 40.0])
    pv = _linear(_modes((still, 0.02)), np.convolve(_modes((low, 0.015)), _modes((high, 0.02))), op, ts)
    return ts, op, pv, 0.03 * float(pv.std())


def _plate(rng: np.random.Generator) -> Drawn:
    """A wing in a flow: two resonances near each other, much noise."""
    op, ts = _multisine(rng, 1024, 20, 154), 0.01
    low, high, still = 2 * np.pi * rng.uniform(0.95, 1.05, 3) * np.array([4.5, 6.2, 5.2])
    pv = _linear(_modes((still, 0.01)), np.convolve(_modes((low, 0.03)), _modes((high, 0.02))), op, ts)
    return ts, op, pv, 0.05 * float(pv.std())


def _hard_spring(rng: np.random.Generator) -> Drawn:
    """A mass on a spring that is the stiffer the farther it is bent."""
    op, ts = 0.022 * _multisine(rng, 4096, 1, 1300), 1 / 610.35
    natural, cubic = 2 * np.pi * 68.0, rng.uniform(100.0, 350.0)

    def speed(state: FloatArray, force: float) -> FloatArray:
        place, rate = state
        return np.array([rate, natural**2 * (force - place - cubic * place**3) - 0.1 * natural * rate])

    return ts, op, _run(speed, np.zeros(2), op, ts, 3)[:, 0], 1e-4


def _hysteretic_spring(rng: np.random.Generator) -> Drawn:
    """A mass on a spring with hysteresis (Bouc and Wen)."""
    op, ts = rng.uniform(30, 60) * _multisine(rng, 4096, 28, 820), 1 / 750

    def speed(state: FloatArray, force: float) -> FloatArray:
        place, rate, held = state
        own = 5e4 * rate - 1e3 * (0.8 * abs(rate) * held - 1.1 * rate * abs(held))
        return np.array([rate, (force - 10 * rate - 5e4 * place - held) / 2, own])

    return ts, op, _run(speed, np.zeros(3), op, ts, 10)[:, 0], 5e-6


def _drives(rng: np.random.Generator) -> Drawn:
    """Two drives with a belt, whose sensor does not know which way they turn."""
    op, ts = np.repeat(rng.uniform(-1.5, 3.0, 100), 5), 0.02
    bottom = np.asarray(np.poly([-2.5, -3 + 18j, -3 - 18j]).real, dtype=np.float64)
    return ts, op, np.abs(_linear(np.array([0.5 * bottom[-1]]), bottom, op, ts)), 0.01


def _dryer(rng: np.random.Generator) -> Drawn:
    """Air through a heated tube, moved between two powers."""
    op, ts = np.repeat(rng.choice([3.41, 6.41], 143), 7)[:1000], 0.08
    late = np.concatenate((np.full(2, op[0]), op[:-2])) - 5.0
    bottom = np.convolve(np.convolve([0.25, 1], [0.12, 1]), [0.05, 1])
    slow = lfilter([1.0], [1.0, -0.7], rng.normal(0, 0.03, len(op)))
    return ts, op, 4.9 + _linear(np.array([0.9]), bottom, late, ts) + slow, 1e-3


def _ball(rng: np.random.Generator) -> Drawn:
    """A ball on a beam whose angle is OP, in closed loop: a double integrator."""
    count, ts = 1000, 0.1
    wanted = np.repeat(rng.uniform(-0.2, 0.2, 10), 100)
    op, pv = np.empty(count), np.empty(count)
    place = speed = 0.0
    for t in range(count):
        op[t] = np.clip(0.6 * (wanted[t] - place) - 0.7 * speed, -0.3, 0.3) + rng.normal(0, 0.005)
        pv[t] = place
        for _ in range(10):
            speed += ts / 10 * 5 / 7 * 9.81 * np.sin(op[t]) * 0.4
            place += ts / 10 * speed
    return ts, op, pv, 0.003


def _throttle(rng: np.random.Generator) -> Drawn:
    """A flap with friction between two springs that hold it in the middle."""
    op, ts = np.repeat(rng.uniform(2.0, 8.0, 15), 200), 0.01
    pv = np.empty(len(op))
    angle, rate, fine = 30.0, 0.0, 20
    for t, each in enumerate(op):
        pv[t] = angle
        for _ in range(fine):
            bent = angle - 30.0
            spring = 12 * np.sign(bent) * (1 - np.exp(-abs(bent) / 2)) + 0.35 * bent
            rate += ts / fine * 100 * (12 * (each - 5) - spring - 5 * np.tanh(rate / 2) - 1.2 * rate)
            angle += ts / fine * rate
    return ts, op, pv, 0.1


def _thermostat(rng: np.random.Generator) -> Drawn:
    """A plate that a relay heats, and a sensor behind it."""
    count, ts, heated = 2000, 2.0, False
    wanted = np.repeat(rng.uniform(45, 70, 5), 400)
    op, pv = np.empty(count), np.empty(count)
    plate = shown = 20.0
    for t in range(count):
        heated = shown < wanted[t] + (1.0 if heated else -1.0)
        op[t], pv[t] = 100.0 * heated, shown
        plate += ts * (0.9 * heated - 0.008 * (plate - 20))
        shown += ts * (plate - shown) / 15
    return ts, op, pv, 0.05


def _coarse_heater(rng: np.random.Generator) -> Drawn:
    """A heated transistor that radiates, and a converter of ten bits."""
    op = np.repeat(rng.uniform(0, 80, 9), 200)
    area, heat = 0.0012, 0.01

    def speed(state: FloatArray, power: float) -> FloatArray:
        body, shown = state
        lost = 9 * area * (body - ROOM) + 0.9 * STEFAN_BOLTZMANN * area * (body**4 - ROOM**4)
        return np.array([(heat * power - lost) / 5, (body - shown) / 20])

    return 1.0, op, _run(speed, np.full(2, ROOM), op, 1.0, 2)[:, 1] - 273.0, 0.1


RIGS: dict[LaboratoryRigName, Callable[[np.random.Generator], Drawn]] = {
    "arm": _arm,
    "plate": _plate,
    "hard_spring": _hard_spring,
    "hysteretic_spring": _hysteretic_spring,
    "drives": _drives,
    "dryer": _dryer,
    "ball": _ball,
    "throttle": _throttle,
    "thermostat": _thermostat,
    "coarse_heater": _coarse_heater,
}


def _multisine(rng: np.random.Generator, count: int, first: int, last: int) -> FloatArray:
    """Return lines of a period of ``count`` samples with phases at random, deviation 1."""
    lines = np.zeros(count // 2 + 1, dtype=np.complex128)
    lines[first:last] = np.exp(2j * np.pi * rng.random(last - first))
    wave = np.fft.irfft(lines, count)
    return np.asarray(wave / wave.std(), dtype=np.float64)


def _modes(*pairs: tuple[float, float]) -> FloatArray:
    """Return the polynomial of resonances: rad/s and damping of each."""
    found = np.ones(1)
    for natural, damping in pairs:
        found = np.convolve(found, (1 / natural**2, 2 * damping / natural, 1.0))
    return found


def _linear(top: FloatArray, bottom: FloatArray, op: FloatArray, ts: float) -> FloatArray:
    sampled, own, _ = cont2discrete((top, bottom), ts)
    return np.asarray(lfilter(sampled.ravel(), own, op), dtype=np.float64)


def _run(speed: Speed, state: FloatArray, op: FloatArray, ts: float, fine: int) -> FloatArray:
    """Return the states, (n, k), by the classical Runge-Kutta method."""
    found, step = np.empty((len(op), len(state))), ts / fine
    for t, each in enumerate(op.tolist()):
        found[t] = state
        for _ in range(fine):
            first = speed(state, each)
            second = speed(state + step / 2 * first, each)
            third = speed(state + step / 2 * second, each)
            fourth = speed(state + step * third, each)
            state = state + step / 6 * (first + 2 * second + 2 * third + fourth)
    return found
