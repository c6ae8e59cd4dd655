"""The linear bases: first order, second order, integrator alone or behind two lags, each plus dead time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.physics.bases.linear_process import LinearProcess
from agent.physics.effect import Facts, Parameter

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


def delay_of(facts: Facts) -> Parameter:
    """Dead time, from one sample to 0.8 periods and an eighth of the record."""
    longest = max(8 * facts.ts, min(0.8 * facts.period, facts.duration / 8))
    return Parameter("delay", "s", facts.ts, longest)


def lag_of(name: str, facts: Facts) -> Parameter:
    """Time constant, from a fifth of a sample to four periods."""
    return Parameter(name, "s", 0.2 * facts.ts, 4 * facts.period, log=True)


@dataclass(frozen=True, slots=True)
class Fopdt:
    """First-order lag plus dead time."""

    name: str = "fopdt"
    linear: bool = True

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return delay and time constant."""
        return delay_of(facts), lag_of("tau", facts)

    def process(self, values: FloatArray) -> LinearProcess:
        """Return the process with these values."""
        return LinearProcess(delay=float(values[0]), lags=(float(values[1]),))


@dataclass(frozen=True, slots=True)
class Sopdt:
    """Two first-order lags plus dead time."""

    name: str = "sopdt"
    linear: bool = True

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return delay and time constants."""
        return delay_of(facts), lag_of("tau", facts), lag_of("tau2", facts)

    def process(self, values: FloatArray) -> LinearProcess:
        """Return the process with these values."""
        return LinearProcess(delay=float(values[0]), lags=(float(values[1]), float(values[2])))


@dataclass(frozen=True, slots=True)
class Integrator:
    """Integrator plus dead time."""

    name: str = "integrator"
    linear: bool = True

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the delay."""
        return (delay_of(facts),)

    def process(self, values: FloatArray) -> LinearProcess:
        """Return the process with these values."""
        return LinearProcess(delay=float(values[0]), integrates=True)


@dataclass(frozen=True, slots=True)
class LagsIntegrator:
    """Integrator behind two lags, plus dead time: a level behind a slow valve, the place of a driven mass."""

    name: str = "lags_integrator"
    linear: bool = True

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return delay and time constants."""
        return (delay_of(facts), lag_of("tau", facts), lag_of("tau2", facts))

    def process(self, values: FloatArray) -> LinearProcess:
        """Return the process with these values."""
        delay, tau, tau2 = (float(each) for each in values)
        return LinearProcess(delay=delay, lags=(tau, tau2), integrates=True)
