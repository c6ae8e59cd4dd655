"""Hammerstein identification with one parameter: Srinivasan, Rengaswamy, Narasimhan and Miller (2005).

Part 2, IECR 44:6719. The valve of Stenman, a dead zone d that ends in a jump to OP, on a grid of d; behind
each an ARMAX process whose order AIC chooses; the d with the least error is the answer, and zero means no
stiction. Written from ``methods.md`` 4.5, the paper's text was not at hand. Ours: the error is that of the
free run, since one step ahead it hardly sees stiction (see ``output_error``), and plain least squares leaves
most d out first.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.processes.armax_model import best_valves, better, without_stiction
from agent.analysis.quantify.valves.bounded_search import RESOLUTION
from agent.analysis.quantify.valves.joint_fit import (
    CentredRecord,
    answer,
    failed,
    free_delays,
    lack,
    structures_to_try,
)
from agent.analysis.quantify.valves.least_fit import undecided_below_least_fit
from agent.analysis.quantify.valves.valve_law import HE

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.analysis.results import Quantification

THRESHOLD = 1.3
"""Evidence above which the drop of the error counts as significant: no simulated loop without stiction and
18 of 40 with it exceed it and fit (``random_plants``, seeds 0 to 39)."""
CONSTANT_LEVEL = 0.0
"""The bias of the ARMAX does not walk."""


@dataclass(frozen=True, slots=True)
class Srinivasan2005:
    """One-parameter valve on a grid, ARMAX process."""

    name: str = "srinivasan2005"

    def quantify(self, window: LoopWindow) -> Quantification:
        """Measure one window; where that is not possible, ``failure`` states why."""
        missing = lack(window)
        if missing is not None:
            return failed(self.name, missing)
        record = CentredRecord.of(window, HE)  # with f_D = 0 it is Stenman's valve
        structures = structures_to_try(window)
        anywhere = free_delays(window, structures)
        delays = anywhere if window.hints.delay is None else np.array([window.hints.delay])
        best = best_valves(record, one_parameter(window.op_span), delays, structures, CONSTANT_LEVEL)
        linear = without_stiction(record, np.union1d(anywhere, delays), structures, CONSTANT_LEVEL)
        best = better(best, linear, delays)
        return undecided_below_least_fit(answer(self.name, window, record, best, linear, THRESHOLD))


def one_parameter(largest: float) -> FloatArray:
    """Return f_S = d and f_D = 0 for d from zero to ``largest``, OP units, shape (k, 2)."""
    d = np.linspace(0.0, largest, round(1 / RESOLUTION) + 1)
    return np.stack([d, np.zeros_like(d)], axis=1)
