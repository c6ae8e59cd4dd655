"""The evidence once more, from what is quick: does the valve explain strokes, or only what wanders?

A load that wanders and that the controller cancels moves OP while PV stands, and so does a dead band. What
remains of it behind a high-pass filter of a tenth of a period is little; what a slip does to PV remains.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from agent.analysis.quantify.free_run.problem import structures
from agent.identify.problem import Problem, behind_high_pass, bridge
from agent.identify.search.linear import best_linear, process_behind
from agent.physics.processes.decimation import block_means

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.identify.fitted import Fitted

PASS_TIME = 0.1
"""Time constant of the filter, periods."""
LEAST_BLOCKS = 2.0
"""Its least time constant, blocks."""


def quick_evidence(window: LoopWindow, problem: Problem, sticking: Fitted) -> float:
    """Return the linear over the sticking error (squared) behind the quicker filter, >= 0.

    The valve stays as it was found; its process is fitted again, and so is the model without stiction.
    """
    quicker = filtered(window, problem)
    again = process_behind(sticking, quicker)
    linear = best_linear(quicker, structures(window.hints), sticking)
    return 1.0 if linear is None else linear.error / max(again.error, 1e-300)


def filtered(window: LoopWindow, problem: Problem) -> Problem:
    """Return the same problem behind the quicker filter."""
    keep = math.exp(-problem.block / max(PASS_TIME * problem.period, LEAST_BLOCKS * problem.block))
    pv, basis = behind_high_pass(block_means(bridge(window.pv), problem.block), problem.weight, keep)
    return problem._replace(keep=keep, pv=pv, basis=basis)
