"""The window of a loop as the problem of an identification."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.analysis.loop.controller_action import process_gain_sign
from agent.identify.problem import BLOCKS_PER_PERIOD
from agent.identify.problem import pose as pose_signals

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.identify.problem import Problem


def pose(window: LoopWindow, blocks_per_period: float = BLOCKS_PER_PERIOD) -> Problem | str:
    """Return the problem that a window poses, or in plain words why it poses none.

    ``blocks_per_period`` is the least number, as far as there are samples.
    """
    fixed_delay = window.hints.delay or 0
    problem = pose_signals(window.op, window.pv, 0, fixed_delay, blocks_per_period)
    return problem if isinstance(problem, str) else problem._replace(gain_sign=process_gain_sign(window))
