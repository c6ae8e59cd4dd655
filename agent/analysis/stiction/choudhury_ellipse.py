"""Apparent stiction after a nonlinearity: the width of the ellipse of OP and PV.

Source: M. A. A. S. Choudhury, S. L. Shah, N. F. Thornhill and D. S. Shook, "Automatic detection and
quantification of stiction in control valves", Control Engineering Practice 14 (2006) 1395; reconstructed
from reference ``methods.md`` 3.8. The paper requires a good fit without a number; ours is
``LARGEST_MISFIT``. A loop with another nonlinearity than the valve's gives an ellipse too, and the width is
no measure of S: controller and process widen it (``agent.analysis.loop.ellipse``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.loop.ellipse import Ellipse, fit_ellipse
from agent.analysis.results import MethodKind, MethodResult, Oscillation
from agent.analysis.stiction.bicoherence import error_bicoherence
from agent.analysis.stiction.shapes.op_pv_cycles import LEAST_WIDTH, Cycles, op_pv_cycles, span_of

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow

LARGEST_MISFIT = 0.3
"""Distance of the points from the ellipse, rms over its radius. Points spread evenly over a rectangle have
0.35, a Gaussian cloud 0.47; no simulated sticking loop has more than 0.2
(``simulators.draws.random_plants``, kind stiction, seeds 0 to 39)."""


@dataclass(frozen=True, slots=True)
class OpPvEllipse:
    """What the detector measured."""

    cycles: Cycles
    ellipse: Ellipse

    @property
    def apparent(self) -> float:
        """Apparent stiction, OP units."""
        return self.ellipse.chord

    @property
    def misfit(self) -> float:
        """Distance of the points from the ellipse along the ray from its centre, rms over its radius."""
        u, v = self.cycles.op - self.ellipse.x0, self.cycles.pv - self.ellipse.y0
        squared = self.ellipse.a * u * u + self.ellipse.b * u * v + self.ellipse.c * v * v
        return float(np.sqrt(np.mean((np.sqrt(np.maximum(squared, 0.0)) - 1) ** 2)))


@dataclass(frozen=True, slots=True)
class ChoudhuryEllipse:
    """For loops with a nonlinearity; the index is apparent stiction over the span of OP."""

    name: str = "choudhury_ellipse"
    kind: MethodKind = "limit_cycle"

    def detect(self, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
        """Judge a nonlinear loop by the width of its ellipse, any other as the bicoherence does."""
        nonlinearity = error_bicoherence(window, oscillation)
        if isinstance(nonlinearity, str):
            return MethodResult("not_applicable", None, nonlinearity)
        cycles = op_pv_cycles(window, nonlinearity)
        ellipse = None if cycles is None else fit_ellipse(cycles.op, cycles.pv)
        if cycles is None or ellipse is None:
            return MethodResult("undecided", None, "no ellipse fits OP over PV")
        seen = OpPvEllipse(cycles, ellipse)
        index = seen.apparent / span_of(window)
        found = f"apparent stiction {seen.apparent:.3g}, {index:.0%} of the span of OP"
        if not nonlinearity.nonlinear:
            verdict, reason = nonlinearity.judge()
            return MethodResult(verdict, index, reason, seen)
        if index < LEAST_WIDTH:
            return MethodResult("no_stiction", index, f"not linear, but the ellipse is narrow: {found}", seen)
        if seen.misfit > LARGEST_MISFIT:
            return MethodResult("undecided", index, f"not linear, but no ellipse fits well: {found}", seen)
        return MethodResult("stiction", index, f"not linear, and an ellipse fits OP over PV: {found}", seen)
