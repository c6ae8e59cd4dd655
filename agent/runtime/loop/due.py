"""What is due of a loop, and what of it is being judged: a loop that waits for a worker holds no samples.

So ten thousand loops whose windows come due in one second cost no more than ten thousand marks, and a window
is cut when a worker is free for it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Concatenate, ParamSpec, TypeVar

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.runtime.intake.cut import CutWindow, DueStretch

P = ParamSpec("P")
T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Due:
    """A stretch that waits for a worker."""

    stretch: DueStretch
    since: float
    """Monotonic time at which it came due, s."""
    end: float
    """One sampling time after its last sample, s UTC."""


@dataclass(frozen=True, slots=True)
class Judging:
    """A window that a worker has, or that waits for its fit."""

    cut: CutWindow
    since: float
    """Monotonic time at which it came due, s."""

    @property
    def end(self) -> float:
        """One sampling time after its last sample, s UTC."""
        return self.cut.end


class GoneError(Exception):
    """What was due is not held any more: the clock of its source was set back meanwhile."""


def with_window(
    function: Callable[Concatenate[LoopWindow, P], T], cut: CutWindow, *args: P.args, **kwargs: P.kwargs
) -> T:
    """Return what a function makes of a window, for a worker: the event loop only cuts it."""
    return function(cut.open(), *args, **kwargs)
