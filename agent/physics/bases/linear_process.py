"""A linear process of gain one: dead time, lags, perhaps an integrator or a first move the wrong way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid

from agent.jit import kernel
from agent.physics.processes.fopdt import fopdt
from agent.physics.processes.integrator import integrator
from agent.physics.processes.lag import lag_of_lines
from agent.physics.processes.sopdt import sopdt
from agent.physics.rows import row_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.physics.bases.base import RespondingProcess

    FloatArray = NDArray[np.float64]

NO_LAG = 0.01
"""Time constant, samples, below which a lag has no visible effect: it ends within the sample."""


@dataclass(frozen=True, slots=True)
class LinearProcess:
    """Between valve position and PV."""

    superposes: ClassVar[bool] = True
    """Whether the response to two moves is the sum of those to each."""
    delay: float
    """Dead time plus the sample for which a position is held, s, at least one sample."""
    lags: tuple[float, ...] = ()
    """Time constants, s, >= 0."""
    integrates: bool = False
    lead: float = 0.0
    """Time constant of a first move the wrong way, s: the response is reduced by this times its own speed. It
    has no effect on a dead time alone."""
    creep: float = 0.0
    """Speed at which the response goes on, over the response, 1/s: it adds this times the integral
    of its deviation from its mean."""

    @property
    def settling(self) -> float:
        """Time in which the response has settled, s: three time constants."""
        return 3 * sum(self.lags)

    def respond(self, position: FloatArray, ts: float) -> FloatArray:
        """Return the deviation of PV for gain one, (n,), in OP units (integrating: OP units times s).

        From rest at the first position, an integrator constant at the mean position. Exact for a position
        that is held between samples, except that third and further lags, lags behind an integrator and the
        integral of ``creep`` use straight lines from sample to sample.

        Args:
            position: OP units, (n,), no NaN.
            ts: s.
        """
        taus = self._taus(ts)
        response = self._behind(taus, position, ts)
        if self.lead > 0.0:
            response = response - self.lead * self._speed(taus, response, position, ts)
        if self.creep > 0.0:
            beyond = cumulative_trapezoid(response - response.mean(), dx=ts, initial=0)
            response = response + self.creep * beyond
        return response

    def behind_lags(self, ts: float) -> tuple[float, float, float] | None:
        """Return delay and up to two time constants, samples, the shorter first; None of any other process.

        A first-order lag has 0 for the second.
        """
        if self.integrates or self.lead > 0.0 or self.creep > 0.0:
            return None
        taus = self._taus(ts)
        if len(taus) > 2:
            return None
        return max(self.delay / ts, 1.0), taus[0] if taus else NO_LAG, taus[1] if len(taus) > 1 else 0.0

    def _taus(self, ts: float) -> list[float]:
        """Return the time constants that are seen, samples, the shorter first."""
        return sorted(lag / ts for lag in self.lags if lag > NO_LAG * ts)

    def counted_from(self, position: FloatArray) -> float:
        """Return the level of OP that the response to a position, (n,), is counted from, OP units."""
        return 0.0 if self.integrates else float(position[0])

    def _behind(self, taus: list[float], position: FloatArray, ts: float) -> FloatArray:
        """Return the response behind these lags, samples, the shorter first, and the integrator."""
        response = np.empty_like(position)
        delay = max(self.delay / ts, 1.0)
        first = float(position[0])
        if self.integrates:
            integrator(position, float(np.mean(position)), delay, response)
            response *= ts
            rest = taus
        elif len(taus) < 2:
            fopdt(position, first, taus[0] if taus else NO_LAG, delay, response)
            rest = []
        else:
            sopdt(position, first, taus[0], taus[1], delay, response)
            rest = taus[2:]
        for tau in rest:
            response = lagged(response, tau)
        return response

    def _speed(self, taus: list[float], response: FloatArray, position: FloatArray, ts: float) -> FloatArray:
        """Return the speed of the response, its unit per s: of a lag, how far it is behind what drives it."""
        if taus:
            return (self._behind(taus[:-1], position, ts) - response) / (taus[-1] * ts)
        passed = np.empty_like(position)
        fopdt(position, float(np.mean(position)), NO_LAG, max(self.delay / ts, 1.0), passed)
        return passed if self.integrates else np.zeros_like(passed)


def responses(processes: Sequence[RespondingProcess], positions: FloatArray, ts: float) -> FloatArray:
    """Return ``respond`` of each of many processes, (m, n), to ``positions`` (m, n) or one row for all."""
    # Those that are more than linear lags have a ``respond`` of their own.
    lags = [each.behind_lags(ts) if type(each) is LinearProcess else None for each in processes]
    plain = [each for each in lags if each is not None]
    if len(plain) == len(processes):
        return responses_behind_lags(positions, np.array(plain))
    return np.array([each.respond(row_of(positions, i), ts) for i, each in enumerate(processes)])


@kernel
def responses_behind_lags(positions: NDArray[np.float64], lags: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``responses`` of processes with the numbers of ``LinearProcess.behind_lags``, (m, 3)."""
    found = np.empty((len(lags), positions.shape[1]))
    for i in range(len(lags)):
        position = row_of(positions, i)
        if lags[i, 2] > 0.0:
            sopdt(position, position[0], lags[i, 1], lags[i, 2], lags[i, 0], found[i])
        else:
            fopdt(position, position[0], lags[i, 1], lags[i, 0], found[i])
    return found


def lagged(signal: FloatArray, tau: float) -> FloatArray:
    """Return ``signal`` (n,) behind a first-order lag of ``tau`` samples, from rest.

    Exact for a signal that goes in straight lines from sample to sample (first-order hold).
    """
    response = np.empty_like(signal)
    lag_of_lines(signal, 0.0, tau, 0.0, response)
    return response
