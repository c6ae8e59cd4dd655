"""How much more likely a record is if its valve sticks: the free run on the whole band, with its noise.

A load that wanders moves OP while PV stands, and so does a dead band; the error of a free run cannot tell
them apart. Its innovations can: what of the error of PV could not be foreseen from the error before, if it
wanders. A slip comes at an instant that only the valve knows; a load leaves the same innovations with and
without a sticking valve. See docs/methods/innovations.md.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.analysis.innovations.noise_models import noise_models
from agent.analysis.innovations.process_search import best_process
from agent.analysis.innovations.valve_search import best_valve
from agent.analysis.innovations.whitened import Fit, log_likelihood
from agent.analysis.quantify.free_run.objective import S, valve_position
from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.quantify.turns import turns

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from agent.analysis.quantify.free_run.problem import Problem
    from agent.analysis.recording import FloatArray, LoopHints, LoopWindow
    from agent.analysis.results import Quantification

LEAST_S = 0.02
"""S below this share of the OP span takes noise off OP, which any record likes a little."""


class Told(NamedTuple):
    """The valve that ``free_run`` found, OP less its least value in OP spans."""

    s: float
    j: float
    stem: FloatArray | None
    """How it moved, (n,); None where the model without stiction was reported."""


def log_likelihood_ratio(window: LoopWindow, found: Quantification) -> float:
    """Return the log of how much more likely the record is with a sticking valve than without, nats, >= 0.

    Both models see the same processes and choose their own noise. Valves: the one that ``found`` tells, and
    those of a search of its own.

    Args:
        window: The record.
        found: Answer of ``free_run`` on it.
    """
    in_spans = scaled(window)
    if in_spans is None:
        return 0.0
    problem = pose(in_spans)
    if isinstance(problem, str):
        return 0.0
    whitened = noise_models(in_spans, problem)
    linear = best_process(whitened, window.hints)
    if linear is None:
        return 0.0
    sound = log_likelihood(linear, whitened[linear.noise])
    sticking = [sound]
    for fit, model in _sticking(told(window, found), whitened, window.hints, linear):
        if turns(valve_position(fit.candidate, model)) > 0:
            sticking.append(log_likelihood(fit, model))
    return max(sticking) - sound


def scaled(window: LoopWindow) -> LoopWindow | None:
    """Return the record with OP and PV in spans from their least values; None where one does not move."""
    pv = window.pv[np.isfinite(window.pv)]
    spread = float(np.ptp(pv)) if pv.size else 0.0
    if not (window.op_span > 0 and spread > 0):
        return None
    low = float(pv.min())
    return replace(
        window,
        op=(window.op - np.nanmin(window.op)) / window.op_span,
        pv=(window.pv - low) / spread,
        sp=None if window.sp is None else (window.sp - low) / spread,
    )


def told(window: LoopWindow, found: Quantification) -> Told | None:
    """Return the valve of an answer; None where it has none."""
    if found.stiction is None or not found.stiction.s.value > 0:
        return None
    stem = None
    if found.model_mv is not None and found.decision != "no_stiction":
        stem = np.ascontiguousarray((found.model_mv - np.nanmin(window.op)) / window.op_span)
    return Told(found.stiction.s.value / window.op_span, found.stiction.j.value / window.op_span, stem)


def _sticking(
    valve: Told | None, whitened: Sequence[Problem], hints: LoopHints, linear: Fit
) -> Iterator[tuple[Fit, Problem]]:
    """Yield the best fit of the valve that was found, its stem as it moved, and that of a search."""
    if valve is not None and valve.s >= LEAST_S and valve.stem is not None:
        moved = [each._replace(op=valve.stem[: len(each.op)]) for each in whitened]
        fit = best_process(moved, hints)
        if fit is not None:
            yield fit, moved[fit.noise]
    searched = best_valve(whitened, hints, linear, None if valve is None else (valve.s, valve.j))
    if searched is not None and searched.candidate[S] >= LEAST_S:
        yield searched, whitened[searched.noise]
