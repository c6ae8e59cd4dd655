"""How much an effect that is not there seems to explain of a record."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.fit import QUICK_ROUNDS, Fit, nested_fit, refit
from agent.workbench.library import happens_once
from agent.workbench.residual.resampling import resampled

if TYPE_CHECKING:
    from agent.workbench.record import Record

DRAWS = 39
"""Simulations, at most: the smallest p is 1 in 40."""
ENOUGH = 1
"""As large as what was seen: p can no longer fall below 0.05."""


@dataclass(frozen=True, slots=True)
class NullTrial:
    """A model without an effect and the same with it, both as fitted to the record."""

    smaller: Fit
    larger: Fit
    record: Record
    block: int
    """Samples over which the residual keeps its correlation."""

    @property
    def seen(self) -> float:
        """Error without over error with the effect, on the record."""
        return self.smaller.error / self.larger.error

    def __call__(self, seed: int) -> float:
        """Return the same on PV of the smaller model plus a residual in another order.

        The effect is searched with less effort than on the record, but also where it was found there. Where
        it is something that happened once, the larger model's residual is taken: that of the smaller one
        holds what happened, and cut in pieces shows it at every joint.
        """
        once = happens_once(self.larger.model.effects[-1], self.record.facts)
        residual = self.record.pv - (self.larger if once else self.smaller).pv
        drawn = resampled(residual[self.record.weight > 0], self.block, np.random.default_rng(seed))
        pv = self.smaller.pv.copy()
        pv[self.record.weight > 0] += drawn
        record = replace(self.record, pv=pv)
        without = refit(self.smaller, record, record.weight)
        starts = self.larger.values[np.newaxis]
        with_effect = nested_fit(without, self.larger.model, record, starts, QUICK_ROUNDS)
        return without.error / with_effect.error
