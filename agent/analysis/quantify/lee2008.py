"""Closed-loop stiction quantification by system identification: Lee, Ren and Huang (2008).

For each valve of a bounded space (f_S, f_D; model of He et al. 2007) the position MV' follows from OP, a
first- or second-order process with delay is fitted from MV' to PV, and the valve with the least model error
is the answer. Kept from the paper: the valve starts without stored force, u_r(0) = 0; means are removed,
nothing is filtered; order and delay are searched where the engineer doesn't give them. Ours: the error is
that of the simulated output (see ``output_error``), and implausible processes are refused.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from agent.analysis.quantify.valves.bounded_search import grid_search, random_search
from agent.analysis.quantify.valves.joint_fit import (
    NO_STICTION,
    CentredRecord,
    answer,
    failed,
    free_delays,
    lack,
    structures_to_try,
)

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.analysis.results import Quantification

THRESHOLD = 1.4
"""Evidence above which the valve is said to stick: 5 % of simulated loops without stiction exceed it."""


@dataclass(frozen=True, slots=True)
class Lee2008:
    """The paper's method with one of its two searches."""

    search: Literal["grid", "random"] = "grid"
    """Contour map at 1 % of the OP span, as in the paper's Table I, or multistart adaptive random search."""

    @property
    def name(self) -> str:
        """``lee2008`` or ``lee2008_random``."""
        return "lee2008" if self.search == "grid" else f"lee2008_{self.search}"

    def quantify(self, window: LoopWindow) -> Quantification:
        """Measure one window; where that is not possible, ``failure`` states why."""
        missing = lack(window)
        if missing is not None:
            return failed(self.name, missing)
        record = CentredRecord.of(window)
        structures = structures_to_try(window)
        anywhere = free_delays(window, structures)
        delays = anywhere if window.hints.delay is None else np.array([window.hints.delay])

        def errors(bands: FloatArray) -> FloatArray:
            lowest: FloatArray = record.errors(bands, delays, structures).min(axis=(1, 2))
            return lowest

        search = grid_search if self.search == "grid" else random_search
        best = record.best_model(search(errors, window.op_span), delays, structures)
        # The rival without stiction may take any delay: a wrong hint must not make a valve look sticky.
        linear = record.best_model(NO_STICTION, np.union1d(anywhere, delays), structures)
        return answer(self.name, window, record, best, linear, THRESHOLD)
