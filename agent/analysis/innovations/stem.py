"""How a valve that sticks moved, and the process behind it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from agent.analysis.innovations.whitened import Fit, log_likelihood

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.identify.problem import Problem


@dataclass(frozen=True)
class StickingStem:
    """A stem and the process behind it."""

    fit: Fit
    behind: Sequence[Problem]
    """The record behind each filter, with the stem in place of OP."""
    bands: tuple[float, float]
    """S and J, OP spans."""
    price: float = 0.0
    """What the freedom of its slips costs, nats, <= 0."""

    @cached_property
    def likelihood(self) -> float:
        """Return the log likelihood, nats, less a constant."""
        return log_likelihood(self.fit, self.behind[self.fit.noise]) + self.price
