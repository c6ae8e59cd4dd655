"""The base by name, or the one with which a record is likeliest.

Each linear base is fitted alone. The innovations decide as they do between effects: a larger base must make
the record very much likelier than the one before it, its numbers paid by Schwarz's criterion.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from agent.physics.bases import BASES
from agent.workbench.library import base_named
from agent.workbench.residual.very_strong import VERY_STRONG
from agent.workbench.session.opening import opened

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.physics.bases import Base
    from agent.workbench.hooks import Map, Progress
    from agent.workbench.trial import Tried
    from agent.workbench.trials import Trials

AUTO = "auto"


def based(
    window: LoopWindow, name: str, run: Map, progress: Progress
) -> tuple[Base, tuple[Trials, Tried] | str]:
    """Return a base and the recording opened with it, or in words why it is not testable.

    Args:
        window: The recording.
        name: Of the base; ``auto``: the likeliest of the linear ones.
        run: Tries effects, perhaps in parallel.
        progress: Called with what is tried next.

    Raises:
        ValueError: There is no such base.
    """
    if name != AUTO:
        base = base_named(name)
        return base, opened(window, base, run, progress)
    chosen: tuple[Base, tuple[Trials, Tried] | str] | None = None
    least = math.inf
    for base in (each for each in BASES if each.linear):
        found = opened(window, base, run, progress)
        unlikely = math.inf if isinstance(found, str) else _unlikely(found[1])
        if chosen is None or unlikely < least - VERY_STRONG:
            chosen, least = (base, found), unlikely
    if chosen is None:
        raise ValueError("there is no linear base")
    return chosen


def _unlikely(alone: Tried) -> float:
    """Return minus twice the logarithm of the likelihood, less a constant, its numbers paid."""
    if alone.predicts is None:
        return math.inf
    predicts, best = alone.predicts
    count = len(predicts.pv)
    return count * math.log(max(predicts.variance(best), math.ulp(0.0))) + len(best) * math.log(count)
