"""A stirred tank in which a strong base neutralises an acid, with a weak acid as buffer; its pH is PV.

    tau dx/dt = u - neutral - x                       excess of base, OP units
    strength x = 10^(pH - 7) - 10^(7 - pH) + buffer (1 / (1 + 10^(pKa - pH)) - 1 / (1 + 10^(pKa - 7)))

The second line is the balance of charges, in 1e-7 mol/l. The gain is a hundred times larger about pH 7 than
at either end, unless buffered. An acid dosed into a base is the same with OP counted downward.
Source: T. McAvoy, E. Hsu, S. Lowenthal, Dynamics of pH in controlled stirred tank reactor, Ind. Eng. Chem.
Process Des. Dev. 11 (1972) 68.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.jit import kernel
from agent.physics.bases.lag_bases import delay_of, lag_of
from agent.physics.bases.late import late
from agent.physics.effect import Facts, Parameter

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

NEUTRAL = 7.0
"""pH of pure water."""
CLOSE = 1e-9
"""pH to which a balance is solved."""
TURNS = 60
"""At most: Newton's method takes five, halving where it leaves the scale takes fifty."""
SCALE = (-2.0, 16.0)
"""pH between which a balance is sought."""
TAUS, STRENGTHS, BUFFERS = (0.1, 0.4, 1.5), (10.0, 1e3, 1e5), (1.0, 1e3)
"""Where fits begin: time constants in dominant periods; what OP's span adds, the buffer, in 1e-7 mol/l."""


class Neutralisation(NamedTuple):
    """The tank with all its numbers."""

    delay: float
    """s, as in ``LinearProcess``."""
    tau: float
    """Mean time in the tank, s."""
    neutral: float
    """OP at which neither acid nor base is left."""
    strength: float
    """What an OP unit adds, 1e-7 mol/l."""
    buffer: float
    """Weak acid, 1e-7 mol/l."""
    pka: float
    """Of the weak acid."""
    start: float
    """pH at the first sample."""

    def respond(self, position: FloatArray, ts: float) -> FloatArray:
        """Return pH, (n,), for a base dosed at ``position``, (n,), OP units, held from sample to sample."""
        return acidities(late(position, self.delay, ts), ts, self)


@kernel
def charge(ph: float, tank: Neutralisation) -> float:
    """Return the excess of strong base that balances the charges, 1e-7 mol/l."""
    own = 1.0 / (1.0 + 10.0 ** (tank.pka - ph)) - 1.0 / (1.0 + 10.0 ** (tank.pka - NEUTRAL))
    return float(10.0 ** (ph - NEUTRAL) - 10.0 ** (NEUTRAL - ph) + tank.buffer * own)


@kernel
def balanced(excess: float, ph: float, tank: Neutralisation) -> float:
    """Return the pH for an ``excess`` of strong base, 1e-7 mol/l, sought from ``ph``."""
    low, high = SCALE
    for _ in range(TURNS):
        off = charge(ph, tank) - excess
        if off > 0.0:
            high = ph
        else:
            low = ph
        held = 10.0 ** (tank.pka - ph)
        slope = 10.0 ** (ph - NEUTRAL) + 10.0 ** (NEUTRAL - ph) + tank.buffer * held / (1.0 + held) ** 2
        after = ph - off / (np.log(10.0) * slope)
        if not low < after < high:
            after = 0.5 * (low + high)
        if abs(after - ph) < CLOSE:
            return float(after)
        ph = float(after)
    return ph


@kernel
def acidities(dose: FloatArray, ts: float, tank: Neutralisation) -> FloatArray:
    """Return the pH at each sample, (n,); the tank is exact for a held ``dose`` (n,), OP units."""
    pv = np.empty(dose.size)
    ph, excess = tank.start, charge(tank.start, tank) / tank.strength
    keep = np.exp(-ts / tank.tau)
    for t in range(dose.size):
        pv[t] = ph
        end = dose[t] - tank.neutral
        excess = end + (excess - end) * keep
        ph = balanced(tank.strength * excess, ph, tank)
    return pv


@dataclass(frozen=True, slots=True)
class NeutralisationBase:
    """A neutralisation tank; the response is PV itself, which must be a pH."""

    name: str = "neutralisation"
    linear: bool = False

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the numbers of ``Neutralisation`` in their order."""
        span = facts.op_span
        return (
            delay_of(facts),
            lag_of("tau", facts),
            Parameter("neutral", "OP", facts.op_low - span, facts.op_high + span),
            Parameter("strength", "1/OP", 0.1 / span, 1e7 / span, log=True),
            Parameter("buffer", "1", 0.01, 1e7, log=True, natural=True),
            Parameter("pka", "PV", 2.0, 12.0, natural=True),
            Parameter("start", "PV", *SCALE, of_record=True),
        )

    def process(self, values: FloatArray) -> Neutralisation:
        """Return the tank."""
        return Neutralisation(*(float(each) for each in values))

    def starts(self, op: FloatArray, pv: FloatArray, facts: Facts) -> FloatArray:
        """Return tanks that are neutral at the OP at which PV is nearest to pH 7, (m, 7)."""
        neutral = float(op[int(np.argmin(np.abs(pv - NEUTRAL)))])
        first = min(max(float(pv[0]), SCALE[0]), SCALE[1])
        return np.array(
            [
                (2 * facts.ts, tau * facts.period, neutral, strength / facts.op_span, buffer, 6.5, first)
                for tau, strength, buffer in product(TAUS, STRENGTHS, BUFFERS)
            ]
        )
