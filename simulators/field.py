"""What lies between OP and PV: valve, process and transmitter, with the loads on the process."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from simulators.disturbance import Load, at_time
from simulators.parameters import TransmitterParameters
from simulators.parts.pipe import Pipe
from simulators.parts.transmitter import Transmitter
from simulators.process import SimulatedProcess
from simulators.valve import STEP, SimulatedValve

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from simulators.scenario import Scenario

    FloatArray = NDArray[np.float64]

PLAIN = TransmitterParameters()


class Field:
    """Valve, process and transmitter of one loop, moving through time."""

    def __init__(self, scenario: Scenario, rng: np.random.Generator) -> None:
        self._scenario = scenario
        ts = scenario.ts
        self._steps = math.ceil(ts / STEP[scenario.valve.law])
        self._dt = ts / self._steps
        self._valve = SimulatedValve(
            scenario.valve, scenario.op_range, scenario.controller.op, rng.spawn(1)[0]
        )
        self._balance = float(self._valve.flow(np.array([scenario.controller.op]))[0])
        op = scenario.controller.op
        self._process = SimulatedProcess(scenario.process, self._dt, op)
        self._pipe = None if scenario.pipe is None else Pipe(scenario.pipe, op, self._dt)
        self._transmitter = Transmitter(scenario.transmitter)
        self._load = Load(
            scenario.disturbance,
            scenario.drift,
            scenario.load_steps,
            scenario.wander,
            scenario.bursts,
            ts,
            rng,
        )
        self.load = 0.0
        """On the process input in the last sampling time, OP units."""
        self._keep = math.exp(-ts / scenario.sensor_tau) if scenario.sensor_tau else 0.0
        self._sensed = 0.0
        self._jammed_at: float | None = None

    @property
    def pv(self) -> float:
        """Output of the transmitter now, without noise, PV units."""
        return self._scenario.controller.sp + self._sensed

    @property
    def position(self) -> float:
        """Stem position now, OP units."""
        return self._valve.position

    def hold(self, op: float, elapsed: float, others: float = 0.0) -> None:
        """Hold ``op`` from ``elapsed`` s after the start of the record to the next sample.

        Args:
            op: OP units.
            elapsed: s.
            others: Load of other loops on the process input, OP units.
        """
        scenario = self._scenario
        flow = self._valve.flow(self._valve.stroke(op, self._steps, self._dt)) - self._balance
        if scenario.fault.kind != "none" and elapsed >= scenario.fault.time:
            flow = self._faulty(flow)
        factor = at_time([(step.time, step.factor) for step in scenario.gain_steps], elapsed, 1.0)
        self.load = load = self._load.over(elapsed) + others
        stopped = scenario.fault.kind == "no_flow" and elapsed >= scenario.fault.time
        if self._pipe is not None:
            flow = self._pipe.carry(flow)
        self._process.respond(factor * flow, 0.0 if stopped else load)
        pv = self._process.pv
        if scenario.transmitter != PLAIN:
            pv = scenario.process.gain * self._transmitter.shown(self._process.level)
        self._sensed = pv + (self._sensed - pv) * self._keep

    def _faulty(self, flow: FloatArray) -> FloatArray:
        """Return what flows in place of ``flow`` (steps,) where plug or line have a fault."""
        if self._jammed_at is None:
            self._jammed_at = float(flow[0])
        if self._scenario.fault.kind == "jammed":
            return np.full_like(flow, self._jammed_at)
        if self._scenario.fault.kind == "no_flow":
            return np.full_like(flow, -self._scenario.controller.sp / self._scenario.process.gain)
        return flow


def response(scenario: Scenario, op: FloatArray) -> FloatArray:
    """PV of the field for a given OP, without noise and converters, PV units, (n,).

    Args:
        scenario: Of its controller only the operating point counts, where the field begins; no warm-up.
        op: Held from sample to sample, OP units, (n,).
    """
    field = Field(scenario, np.random.default_rng(scenario.seed).spawn(2)[1])
    pv = np.empty(len(op))
    for i, each in enumerate(op):
        pv[i] = field.pv
        field.hold(float(each), i * scenario.ts)
    return pv
