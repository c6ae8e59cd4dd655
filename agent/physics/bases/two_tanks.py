"""Two tanks in cascade: a pump fills the upper, which empties into the lower, whose level is PV.

    dx1/dt = pump u - q1,    dx2/dt = q1 - q2,    q = flow x^exponent

with both levels in the volume that lifts PV by one unit. Torricelli's law has the exponent 1/2; other
resistances in the outlet change it, so it is free. Tanks may have limits (the effect ``overflow``).

Source: M. Schoukens, J.-P. Noel, "Three benchmarks addressing open challenges in nonlinear system
identification", IFAC-PapersOnLine 50 (2017) 446; free exponents as in reference ``missing_effect.md`` 2.3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.jit import kernel
from agent.physics.effect import Facts, Parameter

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

STEPS = 2
"""Of the midpoint rule in each sample: right to 0.1 % of the range where a tank empties in ten samples."""
EXPONENTS = (0.2, 2.0)
"""Bounds of the outlets' exponents."""
DEEPEST = 12.0
"""Bound of the level of the upper tank, spans of PV."""
FARTHEST = 5.0
"""Where the lower tank no longer flows out, below the least PV, spans of PV at most."""
RESIDENCE = (0.02, 0.1, 0.5, 2.5)
"""Mean times that water stays in a tank, parts of OP's dominant period, where fits begin."""


class TwoTanks(NamedTuple):
    """The tanks with all their numbers; levels in PV units, from where a tank is empty."""

    pump: float
    """PV units per second and OP unit."""
    flow_1: float
    """Out of the upper tank at a level of one PV unit, PV units per second."""
    exponent_1: float
    flow_2: float
    exponent_2: float
    zero: float
    """PV at which the lower tank no longer flows out."""
    start_1: float
    """Level of the upper tank at the first sample."""
    start_2: float
    """PV at the first sample."""
    limit_1: float = math.inf
    """Level of the upper tank at which it overflows."""
    limit_2: float = math.inf
    """PV at which the lower tank overflows."""
    share: float = 0.0
    """Part of the upper tank's spill that falls into the lower tank."""

    def respond(self, position: FloatArray, ts: float) -> FloatArray:
        """Return PV, (n,), for what is set at the pump, (n,), OP units, held from sample to sample.

        The first value is PV at the start, before anything was pumped.
        """
        return levels(position, ts / STEPS, self)


@kernel
def inflows(upper: float, lower: float, pumped: float, tanks: TwoTanks) -> tuple[float, float]:
    """Return how fast both levels rise where nothing spills, PV units per second."""
    between = tanks.flow_1 * max(upper, 0.0) ** tanks.exponent_1
    return pumped - between, between - tanks.flow_2 * max(lower, 0.0) ** tanks.exponent_2


@kernel
def levels(command: FloatArray, dt: float, tanks: TwoTanks) -> FloatArray:
    """Return PV at each sample, (n,), by the midpoint rule in steps of ``dt`` s.

    The part of a step above a limit is spilled at its end, so PV is continuous in all numbers, which a search
    by derivatives needs.
    """
    pv = np.empty(command.size)
    full = tanks.limit_2 - tanks.zero
    upper, lower = min(tanks.start_1, tanks.limit_1), min(tanks.start_2 - tanks.zero, full)
    for t in range(command.size):
        pv[t] = tanks.zero + lower
        pumped = max(tanks.pump * command[t], 0.0)
        for _ in range(STEPS):
            rise, rise_2 = inflows(upper, lower, pumped, tanks)
            middle = upper + 0.5 * dt * rise
            spilled = max(middle - tanks.limit_1, 0.0)
            middle_2 = min(lower + 0.5 * dt * rise_2 + tanks.share * spilled, full)
            rise, rise_2 = inflows(middle - spilled, middle_2, pumped, tanks)
            spilled = max(upper + dt * rise - tanks.limit_1, 0.0)
            upper = max(upper + dt * rise - spilled, 0.0)
            lower = min(max(lower + dt * rise_2 + tanks.share * spilled, 0.0), full)
    return pv


@dataclass(frozen=True, slots=True)
class TwoTanksBase:
    """Two tanks with free outlet exponents; the response is PV itself."""

    name: str = "two_tanks"
    linear: bool = False

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the numbers of ``TwoTanks`` in their order, up to the levels at the first sample."""
        span = facts.pv_high - facts.pv_low
        pumped = span / (facts.duration * facts.op_span), span / (facts.ts * facts.op_span)
        low, high = EXPONENTS
        flows = [0.1 * span / facts.duration / span**exponent for exponent in EXPONENTS]
        flow = min(flows), max(each * 10 * facts.samples for each in flows)
        return (
            Parameter("pump", "PV/s/OP", *pumped, log=True),
            Parameter("flow_1", "PV/s", *flow, log=True),
            Parameter("exponent_1", "1", low, high),
            Parameter("flow_2", "PV/s", *flow, log=True),
            Parameter("exponent_2", "1", low, high),
            Parameter("zero", "PV", facts.pv_low - FARTHEST * span, facts.pv_low),
            Parameter("start_1", "PV", 0.0, DEEPEST * span, of_record=True),
            Parameter("start_2", "PV", facts.pv_low, facts.pv_high, of_record=True),
        )

    def process(self, values: FloatArray) -> TwoTanks:
        """Return tanks without limits."""
        return TwoTanks(*(float(each) for each in values))

    def starts(self, op: FloatArray, pv: FloatArray, facts: Facts) -> FloatArray:
        """Return tanks that hold mean OP and mean PV in balance, (32, 8); water stays for long or short."""
        span = facts.pv_high - facts.pv_low
        zero = facts.pv_low - 0.2 * span
        level = float(pv.mean()) - zero
        found = []
        for upper, lower, exponent in product(RESIDENCE, RESIDENCE, (0.5, 1.0)):
            flow = level / (lower * facts.period)
            level_1 = min(flow * upper * facts.period, DEEPEST * span)
            flows = [flow / each**exponent for each in (level_1, level)]
            pump = flow / max(float(op.mean()), 0.1 * facts.op_span)
            found.append((pump, flows[0], exponent, flows[1], exponent, zero, level_1, float(pv[0])))
        return np.array(found)
