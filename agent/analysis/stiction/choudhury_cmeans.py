"""Apparent stiction after a nonlinearity: how far apart OP is on the two ways through the mean of PV.

Source: M. A. A. S. Choudhury, S. L. Shah, N. F. Thornhill and D. S. Shook, "Automatic detection and
quantification of stiction in control valves", Control Engineering Practice 14 (2006) 1395; fuzzy c-means
after J. C. Bezdek (1981). Reconstructed from reference ``methods.md`` 3.8. Settled here: the width of the
strip, and the distance from which there are two clusters. Controller and process widen this distance too, as
they widen the ellipse (``choudhury_ellipse``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.results import MethodKind, MethodResult, Oscillation
from agent.analysis.stiction.bicoherence import error_bicoherence
from agent.analysis.stiction.shapes.op_pv_cycles import LEAST_WIDTH, Cycles, op_pv_cycles, span_of

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

STRIP = 0.25
"""Half width of the strip about the mean of PV, standard deviations of PV."""
FEWEST_POINTS = 6
"""In the strip."""
APART = 4.0
"""Distance of the centres over the deviation within the clusters from which there are two. One cluster of
evenly spread points, cut in the middle, has 3.5; one of Gaussian points 2.6 (derived)."""
MOST_ROUNDS = 100
SETTLED = 1e-9
"""Step of the centres over the span of the points at which the search ends."""


@dataclass(frozen=True, slots=True)
class Clusters:
    """What the detector measured."""

    cycles: Cycles
    inside: FloatArray
    """OP in the strip, OP units, (m,)."""
    strip: float
    """Half width of the strip, unit of ``cycles.pv``."""
    centres: tuple[float, float]
    """OP units, the lower one first."""

    @property
    def apparent(self) -> float:
        """Apparent stiction, OP units."""
        return self.centres[1] - self.centres[0]

    @property
    def apart(self) -> bool:
        """Whether there are two clusters."""
        nearest = np.min(np.abs(self.inside[:, None] - np.array(self.centres)), axis=1)
        return self.apparent > APART * float(np.sqrt(np.mean(nearest**2)))


@dataclass(frozen=True, slots=True)
class ChoudhuryCmeans:
    """For loops with a nonlinearity; the index is apparent stiction over the span of OP."""

    name: str = "choudhury_cmeans"
    kind: MethodKind = "limit_cycle"

    def detect(self, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
        """Judge a nonlinear loop by the distance of its clusters, any other as the bicoherence does."""
        nonlinearity = error_bicoherence(window, oscillation)
        if isinstance(nonlinearity, str):
            return MethodResult("not_applicable", None, nonlinearity)
        cycles = op_pv_cycles(window, nonlinearity)
        seen = None if cycles is None else clusters(cycles)
        if seen is None:
            return MethodResult("undecided", None, "too few points lie near the mean of PV")
        index = seen.apparent / span_of(window)
        found = f"apparent stiction {seen.apparent:.3g}, {index:.0%} of the span of OP"
        if not nonlinearity.nonlinear:
            verdict, reason = nonlinearity.judge()
            return MethodResult(verdict, index, reason, seen)
        if index < LEAST_WIDTH:
            return MethodResult("no_stiction", index, f"not linear, but OP has one path: {found}", seen)
        if not seen.apart:
            return MethodResult(
                "undecided", index, f"not linear, but the clusters of OP overlap: {found}", seen
            )
        return MethodResult("stiction", index, f"not linear, and OP has two paths: {found}", seen)


def clusters(cycles: Cycles) -> Clusters | None:
    """Cluster OP where PV is near its mean; None with fewer than six points, or if all are equal."""
    strip = STRIP * float(np.std(cycles.pv))
    inside = cycles.op[np.abs(cycles.pv) < strip]
    if len(inside) < FEWEST_POINTS or np.ptp(inside) == 0:
        return None
    return Clusters(cycles, inside, strip, fuzzy_two_means(inside))


def fuzzy_two_means(x: FloatArray) -> tuple[float, float]:
    """Return the centres of two fuzzy clusters of ``x`` (m,), which are not all alike; the lower one first.

    The fuzzifier is 2, so a point belongs to a centre with the inverse square of its distance.
    """
    span = float(np.ptp(x))
    centres = np.array([np.min(x), np.max(x)])
    for _ in range(MOST_ROUNDS):
        squared = np.maximum((x[:, None] - centres) ** 2, np.finfo(float).tiny)
        membership = (squared[:, ::-1] / np.sum(squared, axis=1, keepdims=True)) ** 2
        moved = x @ membership / np.sum(membership, axis=0)
        step = float(np.max(np.abs(moved - centres)))
        centres = moved
        if step <= SETTLED * span:
            break
    return float(centres[0]), float(centres[1])
