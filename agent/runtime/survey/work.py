"""The two tasks of a survey, for any process that finds its sources: list the loops, diagnose one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from connectors.base import ConfigError
from connectors.sources.kinds import opened
from connectors.sources.last_source import LastSource

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopHints
    from connectors.exports.recorded import ReadOptions
    from connectors.sources.archive import ArchivePart


@dataclass(frozen=True, slots=True)
class ToList:
    """One source whose loops are to be listed."""

    part: ArchivePart
    options: ReadOptions


@dataclass(frozen=True, slots=True)
class Listed:
    """The loops of one source."""

    loops: tuple[str, ...]
    version: str
    """Of the content: another one means that results are out of date."""
    problems: tuple[str, ...] = ()
    """What was left out, a line each."""
    faults: tuple[str, ...] = ()
    """Why it cannot be read, a line each."""


@dataclass(frozen=True, slots=True)
class ToDiagnose:
    """One loop to diagnose."""

    part: ArchivePart
    loop: str
    version: str
    """Of the content, as it was listed: a process that has read another one reads it anew."""
    options: ReadOptions
    hints: LoopHints


@dataclass(frozen=True, slots=True)
class Surveyed:
    """The result of one loop."""

    row: dict[str, object]
    """As ``diagnose --json`` prints it; empty where there are faults."""
    finding: dict[str, object]
    """``RecordFinding`` as JSON."""
    faults: tuple[str, ...] = ()


_LAST = LastSource()
"""Of this process: loops of one file come one after the other."""


def list_loops(task: ToList) -> Listed:
    """Return the loops of one source."""
    try:
        with opened(task.part.name, task.options) as source:
            held = source.loops()
            return Listed(held.loops, source.version(), held.problems)
    except ConfigError as error:
        return Listed((), "", faults=tuple(error.faults))


def survey_loop(task: ToDiagnose) -> Surveyed:
    """Read and diagnose one loop."""
    from agent.analysis.data_quality import data_quality  # noqa: PLC0415 - only workers need the analysis
    from agent.analysis.record.window_of_recording import loop_window  # noqa: PLC0415
    from agent.analysis.recording_diagnosis import diagnose_recording  # noqa: PLC0415
    from agent.report.diagnosis_json import diagnosis_json  # noqa: PLC0415
    from agent.report.fleet.rows import finding_of  # noqa: PLC0415
    from agent.report.fleet.stored_finding import finding_json  # noqa: PLC0415
    from agent.report.fleet.thumbnail import thumbnail  # noqa: PLC0415

    recording = task.part.recording
    try:
        recorded = _LAST.get(task.part.name, task.options, task.version).read(task.loop)
    except ConfigError as error:
        _LAST.close()  # a connection that failed is opened again
        return Surveyed({}, {}, tuple(error.faults))
    try:
        window = loop_window(recorded, task.hints)
    except ValueError as error:
        return Surveyed({}, {}, (f"{recording}: {task.loop}: {error}",))
    diagnosis, _ = diagnose_recording(window)
    quality = data_quality(window, diagnosis)
    finding = finding_of(recording, diagnosis, quality, thumbnail(window, diagnosis))
    return Surveyed(diagnosis_json(diagnosis, recording), finding_json(finding))
