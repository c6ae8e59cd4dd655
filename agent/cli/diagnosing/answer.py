"""One recording of ``slipjump diagnose``: what is to be done with it, and the result."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from agent.analysis.data_quality import DataQuality
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.quantify import Quantifier
    from agent.analysis.record.recording import LoopHints, LoopWindow
    from agent.cli.common.delay import DeadTime
    from agent.report.fleet.rows import RecordFinding
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
    as_json: bool = False
    """Whether its text is a JSON object."""
    cores: int = 1
    """That the search may take: all of them where nothing else is to be done."""


@dataclass(frozen=True, slots=True)
class Printed:
    """What is shown of a diagnosis, made where the diagnosis is: the process that prints never reads it."""

    text: str
    """For the terminal, as its task states."""
    finding: RecordFinding
    """Its line among those of many."""


@dataclass(frozen=True, slots=True)
class Answer:
    """The result of a task."""

    task: Task
    found: Printed | None
    """None where the recording could not be read."""
    faults: tuple[str, ...] = ()
    """What went wrong, a line each."""
    remarks: tuple[str, ...] = ()
    """What was left out of its file or may be wrong there, a line each."""
    diagnosis: Diagnosis | None = None
    """Of a recording that is judged with others; else None, for it is large and its parts many."""
    window: LoopWindow | None = None
    """As the diagnosis; the whole recording."""
    shown: LoopWindow | None = None
    """The part of it whose numbers the diagnosis has."""


def printed_of(task: Task, diagnosis: Diagnosis, quality: DataQuality, small: Thumbnail | None) -> Printed:
    """Return what is shown of a diagnosis."""
    from agent.report.fleet.rows import finding_of

    name = task.path.name
    return Printed(_text(task, diagnosis), finding_of(name, diagnosis, quality, small))


def _text(task: Task, diagnosis: Diagnosis) -> str:
    if task.as_json:
        from agent.report.diagnosis_json import diagnosis_json

        return json.dumps(diagnosis_json(diagnosis, task.path.name), allow_nan=False)
    from agent.report.diagnosis_text import diagnosis_lines

    return "\n".join(diagnosis_lines(diagnosis))
