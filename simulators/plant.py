"""A control loop in simulated time: a pure function of the scenario, with no clock of its own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from simulators.controller import Controller
from simulators.disturbance import FirstOrderNoise, strength_of
from simulators.field import Field

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from simulators.scenario import Scenario, Truth

    FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Row:
    """What a loop shows at one moment."""

    time: float
    """Source time, s UTC."""
    values: Mapping[str, float | str]
    """By role: pv, op, sp, mv, mode. NaN is a value of bad quality."""


@dataclass(frozen=True, slots=True)
class SimulatedRecord:
    """A whole run of a scenario. Arrays have shape (n,)."""

    time: FloatArray
    """s UTC."""
    op: FloatArray
    """OP units, held from this sample to the next."""
    pv: FloatArray
    """PV units."""
    sp: FloatArray
    """PV units."""
    mv: FloatArray
    """Stem position when PV was sampled, OP units."""
    truth: Truth


def quantised(value: float, quantum: float) -> float:
    """``value`` to the nearest multiple of ``quantum``; as it is where the quantum is 0."""
    return round(value / quantum) * quantum if quantum > 0.0 else value


class SimulatedPlant:
    """One loop: PI controller, and the field that it acts on.

    At each sample PV is measured, the controller sets OP, and OP is held while valve and process move on
    to the next sample in steps of milliseconds.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        ts = scenario.ts
        noise_rng, load_rng = np.random.default_rng(scenario.seed).spawn(2)
        self._controller = Controller(scenario.controller, scenario.op_range, ts)
        self._field = Field(scenario, load_rng)
        strength = strength_of(scenario.bursts, ts, noise_rng)
        self._noise = FirstOrderNoise(scenario.noise.std, scenario.noise.correlation, ts, noise_rng, strength)
        self._held: float | None = None
        self._sample = -round(scenario.warm_up / ts)
        while self._sample < 0:
            self.advance()

    def advance(self, load: float = 0.0) -> Row:
        """Return the loop's values now, and move it on by one sampling time.

        Args:
            load: Of other loops on the process input meanwhile, OP units.
        """
        scenario = self._scenario
        elapsed = self._sample * scenario.ts
        sp = scenario.set_point(elapsed)
        measured = self._field.pv + self._noise.next()
        pv = self._transmitted(quantised(measured, scenario.quantisation.pv), elapsed)
        op = quantised(self._controller.update(sp, pv, self._field.load), scenario.quantisation.op)
        row = Row(scenario.start + elapsed, {"pv": pv, "op": op, "sp": sp, "mv": self._field.position})
        self._field.hold(op, elapsed, load)
        self._sample += 1
        return row

    def _transmitted(self, pv: float, elapsed: float) -> float:
        """Return what the transmitter sends for a measured ``pv``, PV units."""
        fault = self._scenario.fault
        if fault.kind in {"none", "jammed"} or elapsed < fault.time:
            return pv
        if fault.kind == "no_flow":
            return 0.0 if pv < fault.cut_off else pv
        if self._held is None:
            self._held = pv if fault.kind == "transmitter_holds" else fault.value
        return self._held


def rows(scenario: Scenario) -> Iterator[Row]:
    """All rows of a scenario, in order of time."""
    plant = SimulatedPlant(scenario)
    for _ in range(scenario.samples):
        yield plant.advance()


def simulate(scenario: Scenario) -> SimulatedRecord:
    """Run a scenario to its end."""
    columns: dict[str, FloatArray] = {
        name: np.empty(scenario.samples) for name in ("time", "op", "pv", "sp", "mv")
    }
    for i, row in enumerate(rows(scenario)):
        columns["time"][i] = row.time
        for role in ("op", "pv", "sp", "mv"):
            columns[role][i] = row.values[role]
    return SimulatedRecord(**columns, truth=scenario.truth)
