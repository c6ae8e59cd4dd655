"""How sure the parameters of a fitted model are: the delete-a-group jackknife over the folds.

Each fold leaves a fifth of the record out; from the scatter of the K estimates follows the variance of the
one from all, (K - 1) / K times their sum of squares about the mean, with K - 1 degrees of freedom. It asks
nothing of the noise but that fifths of the record are alike (reconstructed from Shao and Tu, The Jackknife
and Bootstrap, 1995). Of friction and slack the interval is at least the ``plateau``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

from agent.physics.effects.hysteresis import HysteresisEffect
from agent.workbench.plateau import plateau
from agent.workbench.space import space_of

if TYPE_CHECKING:
    from agent.workbench.fit import Fit
    from agent.workbench.folds import HeldOut
    from agent.workbench.record import Record

CONFIDENCE = 0.9


@dataclass(frozen=True, slots=True)
class FittedParameter:
    """A number of a model, with its 90 % interval, in ``unit``."""

    name: str
    unit: str
    value: float
    low: float
    high: float
    at_bound: bool = False
    """It ran into a bound of the search, and may lie beyond."""


def fitted_parameters(fitted: Fit, folds: HeldOut, record: Record) -> tuple[FittedParameter, ...]:
    """Return all parameters of a model; of one searched by its logarithm the logarithm is jackknifed."""
    space = space_of(fitted.model, record.facts)
    k = len(folds.values)
    best = space.at(fitted.values)
    spread = np.sqrt((k - 1) * np.var(space.at(folds.values), axis=0))
    wide = spread * stats.t.ppf(0.5 + CONFIDENCE / 2, k - 1)
    low, high = space.values(best - wide), space.values(best + wide)
    needles = {each.name for each in fitted.model.effects if isinstance(each, HysteresisEffect)}
    for i, (name, parameter) in enumerate(zip(space.names, space.parameters, strict=True)):
        if name.partition(".")[0] in needles and not parameter.of_record:
            ends = plateau(fitted, record, name)
            low[i], high[i] = min(low[i], ends[0]), max(high[i], ends[1])
    return tuple(
        FittedParameter(
            name, parameter.unit, float(value), float(lowest), float(highest), name in fitted.at_bound
        )
        for name, parameter, value, lowest, highest in zip(
            space.names, space.parameters, fitted.values, low, high, strict=True
        )
    )
