"""Stiction, tuning or load: Karra and Karim (2009), CEP 17:939.

The valve of Kano on a grid of (S, J); behind each a process with coloured noise and a bias that walks
(EARMAX, see ``armax``), so that a drifting load does not pass for stiction; then the cause (``root_cause``).
Written from ``methods.md`` 4.6, the paper's text was not at hand. Ours: plain least squares ranks the valves
of a coarse grid, EARMAX decides between the best and on the fine grid about the winner, and the error is that
of the free run, the bias included.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.processes.armax_model import best_valves, better, without_stiction
from agent.analysis.quantify.root_cause import root_cause
from agent.analysis.quantify.valves.bounded_search import RESOLUTION, grid
from agent.analysis.quantify.valves.joint_fit import (
    CentredRecord,
    answer,
    failed,
    free_delays,
    lack,
    structures_to_try,
)
from agent.analysis.quantify.valves.least_fit import undecided_below_least_fit
from agent.analysis.quantify.valves.valve_law import KANO

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.quantify.valves.joint_fit import Model
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import Quantification

THRESHOLD = 1.3
"""Evidence above which the valve is said to stick: one of 160 simulated loops without stiction and 36 of 40
with it exceed it and fit (``random_plants``, seeds 0 to 39)."""
COARSE = 2 * RESOLUTION
"""Step of the first grid, share of the span of OP."""
WALK = 0.01
"""Step of the bias over the standard deviation of the noise: it follows what takes hundreds of samples. Of 0,
0.005, 0.01 and 0.02 it found most sticking loops of seeds 0 to 39."""


@dataclass(frozen=True, slots=True)
class KarraKarim2009:
    """Kano's valve on a grid, EARMAX process, root cause."""

    name: str = "karra_karim2009"

    def quantify(self, window: LoopWindow) -> Quantification:
        """Measure one window; where that is not possible, ``failure`` states why."""
        missing = lack(window)
        if missing is not None:
            return failed(self.name, missing)
        record = CentredRecord.of(window, KANO)
        structures = structures_to_try(window)
        anywhere = free_delays(window, structures)
        delays = anywhere if window.hints.delay is None else np.array([window.hints.delay])
        best = _search(record, window.op_span, delays, structures)
        linear = without_stiction(record, np.union1d(anywhere, delays), structures, WALK)
        best = better(best, linear, delays)
        found = undecided_below_least_fit(answer(self.name, window, record, best, linear, THRESHOLD))
        if found.failure is not None:
            return found
        return replace(found, cause_shares=root_cause(window, record, found, anywhere, structures))


def _search(
    record: CentredRecord, largest: float, delays: NDArray[np.int64], structures: tuple[int, ...]
) -> Model | None:
    """Return the best model of the coarse grid, or of the fine one about its valve."""
    coarse = best_valves(record, grid(largest, COARSE), delays, structures, WALK)
    if coarse is None:
        return None
    fine = grid(largest)
    steps = np.abs(fine - (coarse.bands.f_s, coarse.bands.f_d)) / (RESOLUTION * largest)
    near = best_valves(record, fine[steps.max(axis=1) < 1.5], delays, structures, WALK)
    return coarse if near is None or coarse.error <= near.error else near
