"""Stiction by a grid over S and J: Choudhury, Jain and Shah (2008).

Journal of Process Control 18:232; after reference ``methods.md`` 4.2. For each S and J <= S the valve
(``choudhury2005``) gives the position, and a low-order process is fitted from there to PV; the least error is
the answer, on a coarse grid first, then on fine ones about its lowest points. The width of the OP-PV ellipse
bounds S. Ours: the error is that of the simulated output (see ``output_error``), the delay is searched as in
``lee2008``, and the bound is several widths of the ellipse.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import ndimage

from agent.analysis.loop.ellipse import apparent_stiction
from agent.analysis.quantify.valves.bounded_search import bands, within
from agent.analysis.quantify.valves.joint_fit import (
    NO_STICTION,
    CentredRecord,
    answer,
    failed,
    free_delays,
    lack,
    structures_to_try,
)
from agent.analysis.quantify.valves.valve_law import CHOUDHURY

if TYPE_CHECKING:
    from agent.analysis.quantify.valves.bounded_search import Objective
    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.analysis.results import Quantification

THRESHOLD = 1.4
"""Evidence above which the valve is said to stick: 4 % of simulated loops without stiction exceed it.

``random_plants``, seeds 0 to 39 of each of four kinds; 1.3 accuses 7 %.
"""
WIDTHS = 4.0
"""Bound on S in widths of the ellipse; the span of OP bounds it as well.

Of 40 simulated sticking valves (seeds 0 to 39) S is within one width for 13 and within 3.7 for 39.
"""
COARSE = 40
"""Steps of the coarse grid up to the bound."""
FINE = 8
"""Steps of the fine grids to a step of the coarse one."""
LOWEST = 3
"""Local minima of the coarse grid that get a fine one."""


@dataclass(frozen=True, slots=True)
class Choudhury2008:
    """The method with its two grids."""

    @property
    def name(self) -> str:
        """``choudhury2008``."""
        return "choudhury2008"

    def quantify(self, window: LoopWindow) -> Quantification:
        """Measure one window; where that is not possible, ``failure`` states why."""
        missing = lack(window)
        if missing is not None:
            return failed(self.name, missing)
        record = CentredRecord.of(window, CHOUDHURY)
        structures = structures_to_try(window)
        anywhere = free_delays(window, structures)
        delays = anywhere if window.hints.delay is None else np.array([window.hints.delay])

        def errors(candidates: FloatArray) -> FloatArray:
            lowest: FloatArray = record.errors(candidates, delays, structures).min(axis=(1, 2))
            return lowest

        best = record.best_model(coarse_then_fine(errors, _bound(window)), delays, structures)
        linear = record.best_model(NO_STICTION, np.union1d(anywhere, delays), structures)
        return answer(self.name, window, record, best, linear, THRESHOLD)


def _bound(window: LoopWindow) -> float:
    width = apparent_stiction(window.op, window.pv)
    return window.op_span if width is None else min(window.op_span, WIDTHS * width)


def coarse_then_fine(objective: Objective, largest: float) -> FloatArray:
    """Return the best bands (2,), OP units, within 0 <= J <= S <= ``largest``, OP units."""
    step = largest / COARSE
    ticks = np.arange(COARSE + 1)
    cells = np.stack(np.meshgrid(ticks, ticks, indexing="ij"), axis=-1)
    inside = cells[..., 1] <= cells[..., 0]
    coarse = cells[inside] * np.float64(step)
    error = np.full(inside.shape, np.inf)
    error[inside] = objective(bands(coarse))
    is_lowest = (ndimage.minimum_filter(error, 3, mode="nearest") == error)[inside]
    minima = coarse[is_lowest][np.argsort(error[inside][is_lowest], kind="stable")[:LOWEST]]
    around = np.linspace(-step, step, 2 * FINE + 1)
    offsets = np.stack(np.meshgrid(around, around), axis=-1).reshape(-1, 2)
    fine = [within(point + offsets, largest) for point in minima]
    candidates = bands(np.unique(np.concatenate([minima, *fine]), axis=0))
    return np.asarray(candidates[np.argmin(objective(candidates))])
