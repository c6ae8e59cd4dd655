"""The routine diagnosis of a running loop: one look at a window, and a fit only where that is due."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from agent.analysis.memory.sticks import with_sticks
from agent.analysis.quiet import quiet
from agent.analysis.seen import look, worth_a_fit

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.seen import Seen


class Diagnose(Protocol):
    """A full diagnosis, as ``agent.analysis.diagnose.diagnose``."""

    def __call__(self, window: LoopWindow, seen: Seen | None = None, /) -> Diagnosis:
        """Return the diagnosis; ``seen`` is the first look at the window where that was taken already."""
        ...


@dataclass(frozen=True, slots=True)
class Routine:
    """A diagnosis, and how it came about."""

    diagnosis: Diagnosis
    fitted: bool
    """Whether it is a full diagnosis, with a fit; else the window was quiet."""


def routine_diagnosis(window: LoopWindow, diagnose: Diagnose) -> Routine:
    """Look at a window once, and diagnose it from there where that is due.

    Args:
        window: The window.
        diagnose: Makes the full diagnosis.
    """
    seen = look(window)
    if not worth_a_fit(seen):
        return Routine(with_sticks(quiet(window, seen)), fitted=False)
    return Routine(diagnose(window, seen), fitted=True)


def full_diagnosis(window: LoopWindow, diagnose: Diagnose) -> Routine:
    """Diagnose a window with a fit, whatever a first look would show.

    Args:
        window: The window.
        diagnose: Makes the full diagnosis.
    """
    return Routine(diagnose(window), fitted=True)
