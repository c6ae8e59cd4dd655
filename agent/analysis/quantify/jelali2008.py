"""Stiction by separable least squares with a search for the valve outside: Jelali (2008).

Journal of Process Control 18:632; outline as in Lee, Ren and Huang (2008), details from reference
``methods.md`` 4.3. Given S and J the process is a matter of least squares, so that only S and J are searched,
by a genetic algorithm or a pattern search that starts from the width of the OP-PV ellipse. The process is
of second order and its delay is fixed beforehand. Ours: the error is that of the simulated output (see
``output_error``), and the pattern search has several starts, because from one start it seldom gets far.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from agent.analysis.loop.delay import estimate_delay
from agent.analysis.loop.ellipse import apparent_stiction
from agent.analysis.quantify.valves.bounded_search import bands, pattern_search, within
from agent.analysis.quantify.valves.genetic_search import genetic_search
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
"""Evidence above which the valve is said to stick: 2 % of simulated loops without stiction exceed it.

``random_plants``, seeds 0 to 39 of each of four kinds, genetic search; 1.3 accuses 6 %.
"""
WITHOUT_ELLIPSE = 0.5
"""Start of S where OP and PV give no ellipse, share of the span of OP."""
JUMP = 0.5
"""Start of J, share of that of S."""
STARTS = np.array([(s, j) for s in (0.5, 1.0, 2.0) for j in (0.2, 0.5, 1.0)])
"""Starts of the pattern search: S as a multiple of the ellipse's width, J as a share of S."""
FIRST_STEP = 0.25
"""Of the pattern search, share of the span of OP."""


@dataclass(frozen=True, slots=True)
class Jelali2008:
    """The method with one of its two searches."""

    search: Literal["genetic", "pattern"] = "genetic"

    @property
    def name(self) -> str:
        """``jelali2008`` or ``jelali2008_pattern``."""
        return "jelali2008" if self.search == "genetic" else f"jelali2008_{self.search}"

    def quantify(self, window: LoopWindow) -> Quantification:
        """Measure one window; where that is not possible, ``failure`` states why."""
        missing = lack(window)
        if missing is not None:
            return failed(self.name, missing)
        record = CentredRecord.of(window, CHOUDHURY)
        structures = structures_to_try(window)
        highest = structures[-1:]
        delays = np.array([_fixed_delay(window)])

        def errors(candidates: FloatArray) -> FloatArray:
            lowest: FloatArray = record.errors(candidates, delays, highest).min(axis=(1, 2))
            return lowest

        width = apparent_stiction(window.op, window.pv)
        width = WITHOUT_ELLIPSE * window.op_span if width is None else min(width, window.op_span)
        search = _genetic if self.search == "genetic" else _pattern
        candidates = bands(np.stack([NO_STICTION, search(errors, width, window.op_span)]))
        best = record.best_model(candidates[np.argmin(errors(candidates))], delays, highest)
        # The rival without stiction may take any delay and order: a wrong one must not make a valve sticky.
        anywhere = np.union1d(free_delays(window, structures), delays)
        linear = record.best_model(NO_STICTION, anywhere, structures)
        return answer(self.name, window, record, best, linear, THRESHOLD)


def _fixed_delay(window: LoopWindow) -> int:
    """Return the engineer's delay or the one estimated from OP to PV, samples; 1 where none can be.

    By second differences, whatever the order: on 40 simulated sticking loops (seeds 0 to 39) they were off by
    2 samples in the median, first differences by 22.
    """
    if window.hints.delay is not None:
        return window.hints.delay
    estimate = estimate_delay(window.op, window.pv, order=2, longest=max(1, len(window) // 10))
    return 1 if estimate is None else estimate


def _genetic(errors: Objective, width: float, largest: float) -> FloatArray:
    start = np.array([width, JUMP * width])
    return genetic_search(errors, start, largest)


def _pattern(errors: Objective, width: float, largest: float) -> FloatArray:
    s = width * STARTS[:, 0]
    starts = within(np.stack([s, s * STARTS[:, 1]], axis=1), largest)
    ends = [pattern_search(errors, start, largest, FIRST_STEP * largest) for start in starts]
    point, _ = min(ends, key=lambda end: end[1])
    return point
