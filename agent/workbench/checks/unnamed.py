"""The nearest rival that nobody named: a linear process with more dynamics than any effect of the library.

A true cause need not be in the library. What is there then often goes along with it: a rate limit with a
missing lag, a load step with a first move the wrong way. So an effect must also beat a rival without a name:
two lags and a zero, each number paid by Schwarz's criterion. Effects that are linear dynamics are parts of
the rival and have none in it (``rivals.py``). What remains beside an effect: ``remainder.py``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.bases.linear_process import lagged
from agent.physics.effect import Facts, Parameter, Stage
from agent.physics.effects.inverse_response import MOST_LEAD

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.physics.bases import Base
    from agent.physics.bases.linear_process import LinearProcess
    from agent.physics.effect import Effect

    FloatArray = NDArray[np.float64]

LINEAR = frozenset({"extra_lag", "process_dynamics"})
"""Families whose effects are parts of the rival."""
AS_LIKELY = "linear dynamics that have no name here make the record as likely"


@dataclass(frozen=True, slots=True)
class LinearDynamics:
    """Two lags and a zero in the right half plane; a rival only, no effect that is named."""

    name: str = "linear_dynamics"
    family: str = "linear_dynamics"
    stage: Stage = "process"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return both time constants and that of the zero."""
        return _numbers(facts)

    def change(self, process: LinearProcess, values: FloatArray) -> LinearProcess:
        """Return the process with them."""
        first, second, lead = values.tolist()
        return replace(process, lags=(*process.lags, first, second), lead=process.lead + lead)


@dataclass(frozen=True, slots=True)
class DynamicsBehind:
    """The same behind a process that has no lags of its own to add to."""

    name: str = "linear_dynamics"
    family: str = "linear_dynamics"
    stage: Stage = "sensor"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return both time constants and that of the zero."""
        return _numbers(facts)

    def apply(self, pv: FloatArray, values: FloatArray, ts: float) -> FloatArray:
        """Return PV behind them."""
        first, second, lead = (values / ts).tolist()
        slow = lagged(lagged(pv, first), second)
        return np.asarray(slow - lead * np.diff(slow, prepend=slow[0]), dtype=np.float64)


def dynamics_on(base: Base) -> Effect:
    """Return the rival on a base."""
    return LinearDynamics() if base.linear else DynamicsBehind()


def _numbers(facts: Facts) -> tuple[Parameter, ...]:
    return (
        Parameter("first", "s", 0.0, facts.period, null=0.0),
        Parameter("second", "s", 0.0, facts.period, null=0.0),
        Parameter("lead", "s", 0.0, MOST_LEAD * facts.period, null=0.0),
    )
