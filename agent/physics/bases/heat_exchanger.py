"""A heat exchanger whose flow is set: the more flows, the less it is heated and the sooner it is through.

    dT/dt = turnover f (Tin - T) + transfer f / (f + half) (Ts - T),    f = u - no_flow

T: outlet, PV; Tin: inlet; Ts: the other side, steam or cooling water. The film on the side of the flow
hinders less the more flows, the wall always: ``half`` is the flow at which both hinder alike. Gain and time
constant depend on the flow. Stirred, as one cell.
Source: F. Incropera, D. DeWitt, Fundamentals of Heat and Mass Transfer, 6th ed., 11.2 (overall coefficient);
S. Bittanti, L. Piroddi, J. Franklin Inst. 334B (1997) 135 (a liquid-saturated steam exchanger).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.jit import kernel
from agent.physics.bases.lag_bases import delay_of
from agent.physics.bases.late import late
from agent.physics.effect import Facts, Parameter

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

TAUS = (0.1, 0.4, 1.5)
"""Times in the exchanger where fits begin, parts of OP's dominant period."""
NO_FLOWS = (0.1, 1.0)
"""OP of no flow below the least OP where fits begin, spans."""
FARTHEST = 5.0
"""The same, at most."""
OUTSIDE = 5.0
"""How far inlet and other side may be beyond the range of PV, spans."""


class HeatExchanger(NamedTuple):
    """The exchanger with all its numbers."""

    delay: float
    """s, as in ``LinearProcess``."""
    turnover: float
    """Part of the content that one OP unit moves through in a second, 1/s per OP unit."""
    no_flow: float
    """OP at which nothing flows."""
    transfer: float
    """1/s, where the flow does not hinder."""
    half: float
    """OP units."""
    inlet: float
    """PV units."""
    other_side: float
    """PV units."""
    start: float
    """PV at the first sample."""

    def respond(self, position: FloatArray, ts: float) -> FloatArray:
        """Return PV, (n,), for a flow set at ``position``, (n,), OP units, held from sample to sample."""
        flow = np.maximum(late(position, self.delay, ts) - self.no_flow, 0.0)
        return outlets(flow, ts, self)


@kernel
def outlets(flow: FloatArray, ts: float, exchanger: HeatExchanger) -> FloatArray:
    """Return PV at each sample, (n,); exact for a ``flow`` (n,), OP units, held from sample to sample."""
    pv = np.empty(flow.size)
    warm = exchanger.start
    for t in range(flow.size):
        pv[t] = warm
        passed = exchanger.turnover * flow[t]
        heated = exchanger.transfer * flow[t] / (flow[t] + exchanger.half)
        rate = passed + heated
        if rate > 0.0:
            end = (passed * exchanger.inlet + heated * exchanger.other_side) / rate
            warm = end + (warm - end) * np.exp(-rate * ts)
    return pv


@dataclass(frozen=True, slots=True)
class HeatExchangerBase:
    """A heat exchanger; the response is PV itself."""

    name: str = "heat_exchanger"
    linear: bool = False

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the numbers of ``HeatExchanger`` in their order."""
        span, swing = facts.pv_high - facts.pv_low, facts.op_span
        beyond = facts.pv_low - OUTSIDE * span, facts.pv_high + OUTSIDE * span
        fast = 1.0 / facts.ts
        return (
            delay_of(facts),
            Parameter("turnover", "1/s/OP", 0.01 / facts.duration / swing, 10 * fast / swing, log=True),
            Parameter(
                "no_flow", "OP", facts.op_low - FARTHEST * swing, facts.op_low - 0.01 * swing, natural=True
            ),
            Parameter("transfer", "1/s", 0.01 / facts.duration, 10 * fast, log=True),
            Parameter("half", "OP", 0.01 * swing, 100 * swing, log=True, natural=True),
            Parameter("inlet", "PV", *beyond, natural=True),
            Parameter("other_side", "PV", *beyond, natural=True),
            Parameter("start", "PV", facts.pv_low, facts.pv_high, of_record=True, natural=True),
        )

    def process(self, values: FloatArray) -> HeatExchanger:
        """Return the exchanger."""
        return HeatExchanger(*(float(each) for each in values))

    def starts(self, op: FloatArray, pv: FloatArray, facts: Facts) -> FloatArray:
        """Return exchangers with mean PV half way between both sides, (m, 8), heated or cooled."""
        span = facts.pv_high - facts.pv_low
        found = []
        for tau, below, side in product(TAUS, NO_FLOWS, (-1.0, 1.0)):
            rate, no_flow = 0.5 / (tau * facts.period), facts.op_low - below * facts.op_span
            flow, middle = float(op.mean()) - no_flow, float(pv.mean())
            half = 0.3 * flow
            sides = middle - side * 2 * span, middle + side * 2 * span
            numbers = rate / flow, no_flow, rate * (flow + half) / flow, half
            found.append((2 * facts.ts, *numbers, *sides, float(pv[0])))
        return np.array(found)
