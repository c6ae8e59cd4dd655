"""The window of a loop as the problem of an identification."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.analysis.loop.controller_action import process_gain_sign
from agent.analysis.record.spans import in_spans_of
from agent.identify.objective import FOPDT, INTEGRATOR, SOPDT
from agent.identify.problem import PASS_TIME
from agent.identify.problem import pose as pose_signals

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopHints, LoopWindow
    from agent.identify.problem import Problem

SLOW, QUICK = PASS_TIME, 0.1
"""Time constants of the high-pass filters through which a record is seen, periods. Behind the second one a
load that wanders is nearly white, and what a slip does to PV remains."""
FINE = 3000
"""Blocks of a record where the instants of slips count; fewer samples are a block each."""


def pose(window: LoopWindow, pass_time: float = SLOW, least_blocks: int = 1) -> Problem | str:
    """Return the problem that a window poses, or in plain words why it poses none.

    ``pass_time`` is the time constant of the high-pass filter, periods; ``least_blocks`` of the record, as
    far as there are samples.
    """
    fixed_delay = window.hints.delay or 0
    problem = pose_signals(window.op, window.pv, 0, fixed_delay, pass_time, least_blocks)
    return problem if isinstance(problem, str) else problem._replace(gain_sign=process_gain_sign(window))


def in_spans(window: LoopWindow, pass_time: float = SLOW, least_blocks: int = 1) -> Problem | str:
    """Return the problem in spans from the least values, or in plain words why there is none."""
    spans = in_spans_of(window)
    if spans is None:
        return "OP or PV does not move"
    return pose(spans, pass_time, least_blocks)


def structures(hints: LoopHints) -> tuple[int, ...]:
    """Return the processes that the engineer's knowledge leaves possible."""
    if hints.integrating:
        return (INTEGRATOR,)
    lags = {1: (FOPDT,), 2: (SOPDT,)}.get(hints.order or 0, (FOPDT, SOPDT))
    return lags if hints.integrating is False else (*lags, INTEGRATOR)
