"""Where a model fails: would a process that rings, or has more lags than it, do far better?

Only the base that holds most of the linear ones is fitted; ``--base auto`` fits each.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.physics.bases.oscillatory import Oscillatory
from agent.physics.bases.third_order import ThirdOrder
from agent.workbench.hooks import silent
from agent.workbench.session.auto_base import far_likelier, predicted_by
from agent.workbench.session.opening import opened

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.physics.bases import Base
    from agent.workbench.evidence import ModelAtBest

WORDS = "with the base oscillatory the record is far more likely: try --base auto"


def other_base(window: LoopWindow, base: Base, newest: ModelAtBest) -> tuple[str, ...]:
    """Return in words that another base makes the record far likelier than the newest model, or nothing."""
    if not base.linear or base.name in {Oscillatory().name, ThirdOrder().name}:
        return ()
    found, own = opened(window, Oscillatory(), map, silent), predicted_by(newest)
    other = None if isinstance(found, str) else predicted_by(found[1])
    return (WORDS,) if own is not None and other is not None and far_likelier(other, own) else ()
