"""The routine diagnosis of a running loop: one look at a window, and a fit only where that is due.

What the detectors saw, for their pictures, is 60 to 400 kB; it stays in the worker.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol

from agent.analysis.memory.sticks import with_sticks
from agent.analysis.not_testable import not_testable
from agent.analysis.quiet import quiet
from agent.analysis.seen import look, without_pictures, worth_a_fit

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
    """Whether it is a full diagnosis, with a fit; else the window was quiet or not testable."""


def first_look(window: LoopWindow) -> Routine | Seen:
    """Return the diagnosis of a window that is quiet or not testable, or what was seen where a fit is due.

    Args:
        window: The window.
    """
    seen = look(window)
    if not seen.testable:
        return Routine(with_sticks(not_testable(window, seen)), fitted=False)
    if worth_a_fit(seen):
        return replace(seen, methods=without_pictures(seen.methods))
    return Routine(with_sticks(quiet(window, seen)), fitted=False)


def fitted(window: LoopWindow, seen: Seen, diagnose: Diagnose) -> Routine:
    """Return the full diagnosis of a window from a first look at it.

    Args:
        window: The window.
        seen: What the look showed.
        diagnose: Makes the full diagnosis.
    """
    return Routine(diagnose(window, seen), fitted=True)


def routine_diagnosis(window: LoopWindow, diagnose: Diagnose) -> Routine:
    """Look at a window once, and diagnose it from there where that is due.

    Args:
        window: The window.
        diagnose: Makes the full diagnosis.
    """
    found = first_look(window)
    return found if isinstance(found, Routine) else fitted(window, found, diagnose)


def full_diagnosis(window: LoopWindow, diagnose: Diagnose) -> Routine:
    """Diagnose a window with a fit, whatever a first look would show.

    Args:
        window: The window.
        diagnose: Makes the full diagnosis.
    """
    found = diagnose(window)
    return Routine(replace(found, methods=without_pictures(found.methods)), fitted=True)
