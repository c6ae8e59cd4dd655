"""A recording as the window that is analysed."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopHints, LoopWindow
    from connectors.recording import RecordedLoop


def remarks_on(recording: RecordedLoop) -> tuple[str, ...]:
    """Return what was left out of a recording's file or may be wrong there, a line each."""
    return tuple(f"{recording.path}: {each}" for each in recording.problems)


def window_of(recording: RecordedLoop, hints: LoopHints) -> LoopWindow:
    """Return the whole recording on a uniform grid.

    Raises:
        RecordingError: The times cannot be put on a grid; the text names the file.
    """
    from agent.analysis.record.window_of_recording import loop_window
    from connectors.recording import RecordingError

    try:
        return loop_window(recording, hints)
    except ValueError as error:
        raise RecordingError(f"{recording.path}: {error}") from error
