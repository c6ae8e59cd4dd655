"""The evidence once more, from what is quick: does the valve explain strokes, or only what wanders?

A load that wanders and that the controller cancels moves OP while PV stands, and so does a dead band. What
remains of it behind a high-pass filter of a tenth of a period is little; what a slip does to PV remains.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.analysis.quantify.free_run.problem import QUICK, pose, structures
from agent.identify.search.linear import best_linear, process_behind

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.identify.fitted import Fitted


def quick_evidence(window: LoopWindow, sticking: Fitted) -> float:
    """Return the linear over the sticking error (squared) behind the quick filter, >= 0.

    The valve stays as it was found; its process is fitted again, and so is the model without stiction.
    """
    quick = pose(window, pass_time=QUICK)
    linear = None if isinstance(quick, str) else best_linear(quick, structures(window.hints), sticking)
    if isinstance(quick, str) or linear is None:
        return 1.0
    return linear.error / max(process_behind(sticking, quick).error, 1e-300)
