"""One recording of ``slipjump diagnose``: what is to be done with it, and the result."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from agent.analysis.data_quality import DataQuality
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.quantify import Quantifier
    from agent.analysis.record.recording import LoopHints, LoopWindow
    from agent.cli.common.delay import DeadTime
    from agent.report.fleet.thumbnail import Thumbnail
    from connectors.recording import Columns, ReadOptions


@dataclass(frozen=True, slots=True)
class Task:
    """One recording to diagnose, in any process."""

    path: Path
    columns: Columns
    hints: LoopHints
    quantifier: Quantifier | None
    """None: the default one."""
    picture: Path | None
    """Where to draw the fit, and the other pictures beside it; None: nowhere."""
    options: ReadOptions | None = None
    """What else the user states about the file; None: nothing."""
    loop: str | None = None
    """Which loop of the file; None: the only one."""
    delay: DeadTime | None = None
    """Dead time that the user states; None: it is searched."""
    shared: bool = False
    """Whether its valve has other recordings, for which the window is needed again."""
    small_picture: bool = False
    """Whether a report shows it."""


@dataclass(frozen=True, slots=True)
class Answer:
    """The result of a task."""

    task: Task
    diagnosis: Diagnosis | None
    """None where the recording could not be read."""
    faults: tuple[str, ...] = ()
    """What went wrong, a line each."""
    window: LoopWindow | None = None
    """Of a recording whose valve has others."""
    quality: DataQuality | None = None
    """None where the recording could not be read."""
    small_picture: Thumbnail | None = None
    """None where no report shows it."""
