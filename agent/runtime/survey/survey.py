"""A survey from its archive to its ledger: what is not done yet is done, each loop once."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from typing import TYPE_CHECKING, Protocol

from agent.runtime.survey.ledger import LoopKey
from agent.runtime.survey.work import Listed, ToDiagnose, ToList, list_loops, survey_loop

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopHints
    from agent.runtime.survey.executor import BatchExecutor
    from agent.runtime.survey.ledger import Ledger
    from connectors.exports.recorded import ReadOptions
    from connectors.sources.archive import ArchivePart


class Watcher(Protocol):
    """Is informed of the progress."""

    def begins(self, work: str, total: int, done: int) -> None:
        """Note that a stretch of work begins, of which a part may be done."""
        ...

    def advances(self) -> None:
        """Note that one more is done."""
        ...

    def fault(self, line: str) -> None:
        """Note what could not be read or diagnosed."""
        ...


@dataclass(slots=True)
class SurveySummary:
    """What became of the loops of an archive."""

    loops: int = 0
    """There are so many, with those that failed."""
    resumed: int = 0
    """Of these, done by an earlier run."""
    faults: list[str] = field(default_factory=list)
    """Sources and loops that could not be read or diagnosed, a line each."""
    problems: list[str] = field(default_factory=list)
    """What was left out of sources that were read, a line each."""


def survey(
    parts: Sequence[ArchivePart],
    options: ReadOptions,
    hints: LoopHints,
    executor: BatchExecutor,
    ledger: Ledger,
    watcher: Watcher,
) -> SurveySummary:
    """List the loops of all sources, then diagnose those that the ledger does not have.

    Args:
        parts: The sources.
        options: How they are read.
        hints: What is known of all loops.
        executor: Where the work is done.
        ledger: Keeps each result as it comes.
        watcher: Is informed of the progress.

    Raises:
        ConfigError: There is nothing to run on.
        StoreError: The ledger cannot be written.
    """
    summary = SurveySummary()

    def fault(line: str) -> None:
        summary.faults.append(line)
        watcher.fault(line)

    held = _listed(parts, options, executor, watcher, summary, fault)
    same = f"{version('slipjump')} {options!r} {hints!r}"
    stamps = {part: _stamp(f"{held[part].version} {same}") for part in held}
    tasks = [
        ToDiagnose(part, loop, held[part].version, options, hints)
        for part in held
        for loop in held[part].loops
    ]
    ledger.plan(LoopKey(each.part.recording, each.loop, stamps[each.part]) for each in tasks)
    done = ledger.done()
    waiting = [each for each in tasks if (each.part.recording, each.loop) not in done]
    summary.loops, summary.resumed = len(tasks), len(tasks) - len(waiting)
    watcher.begins("diagnosing", len(tasks), summary.resumed)
    for end in executor.results(survey_loop, waiting):
        part, loop = end.task.part, end.task.loop
        if end.result is None:
            fault(f"{part.recording}: {loop}: not diagnosed: {end.fault}")
        elif end.result.faults:
            for line in end.result.faults:
                fault(line)
        else:
            ledger.write(LoopKey(part.recording, loop, stamps[part]), end.result.row, end.result.finding)
        watcher.advances()
    return summary


def _listed(
    parts: Sequence[ArchivePart],
    options: ReadOptions,
    executor: BatchExecutor,
    watcher: Watcher,
    summary: SurveySummary,
    fault: Callable[[str], None],
) -> dict[ArchivePart, Listed]:
    """Return the loops of each source that could be read, in the order of the archive."""
    found: dict[ArchivePart, Listed] = {}
    watcher.begins("reading the archive", len(parts), 0)
    for end in executor.results(list_loops, (ToList(part, options) for part in parts)):
        if end.result is None:
            fault(f"{end.task.part.recording}: not read: {end.fault}")
        else:
            for line in end.result.faults:
                fault(line)
            summary.problems += end.result.problems
            found[end.task.part] = end.result
        watcher.advances()
    return {part: found[part] for part in parts if part in found}


def _stamp(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:16]
