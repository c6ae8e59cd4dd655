"""Recordings worked out on all cores, with progress."""

from __future__ import annotations

import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from agent.cli.common.compilation import announce_compilation
from agent.cli.common.window import remarks_on, window_of
from agent.cli.diagnosing.answer import Answer, Task, printed_of

if TYPE_CHECKING:
    from connectors.recording import LastSource

NEEDED = (
    "agent.analysis.recording_diagnosis",
    "agent.analysis.data_quality",
    "agent.cli.diagnosing.work",
    "agent.report.diagnosis_json",
    "agent.report.diagnosis_text",
    "agent.report.fleet.rows",
    "agent.report.fleet.thumbnail",
    "connectors.recording",
)
"""What every process imports."""
FOR_PICTURES = ("agent.plots.fit", "agent.plots.contour", "agent.plots.profile", "agent.plots.detectors")
DIED = "not diagnosed: its process was ended, for want of memory or by somebody"


def get_ready(files: int, *, pictures: bool) -> None:
    """Begin to import what the processes need, where several files make several of them probable."""
    from agent.runtime.capabilities import cores

    if min(files, cores()) > 1:
        from agent.runtime.loop.process_pool import import_early

        import_early([*NEEDED, *(FOR_PICTURES if pictures else ())])


def work_out(task: Task) -> Answer:
    """Read, diagnose and draw one recording; runs in a process of the pool."""
    from agent.analysis.data_quality import data_quality
    from agent.analysis.recording_diagnosis import diagnose_recording
    from agent.identify.slices import on_cores
    from agent.report.fleet.thumbnail import thumbnail
    from connectors.base import ConfigError
    from connectors.recording import read_recording

    try:
        recording = read_recording(task.path, task.columns, task.options, task.loop, _last())
        window = window_of(recording, task.hints)
    except ConfigError as error:
        return Answer(task, None, tuple(error.faults))
    remarks = remarks_on(recording)
    if task.delay is not None:
        remarks += task.delay.remarks(window.ts)
        window = window.with_hints(replace(task.hints, delay=task.delay.at(window.ts)))
    with on_cores(task.cores):
        diagnosis, shown = diagnose_recording(window, quantifier=task.quantifier)
    faults: tuple[str, ...] = ()
    if task.picture is not None:
        from agent.cli.common.pictures import draw

        faults = draw(shown, diagnosis, task.picture)
    quality = data_quality(window, diagnosis)
    small = thumbnail(window, diagnosis) if task.small_picture else None
    found = printed_of(task, diagnosis, quality, small)
    answer = Answer(task, found, faults, remarks)
    return replace(answer, diagnosis=diagnosis, window=window, shown=shown) if task.shared else answer


@cache
def _last() -> LastSource:
    """Return what this process read last: loops of one file come one after the other."""
    from connectors.recording import LastSource

    return LastSource()


def answers(tasks: Sequence[Task], advance: Callable[[], None]) -> Iterator[Answer]:
    """Yield the answers in the order of the tasks, worked out on all cores; call ``advance`` at each."""
    for answer in _worked_out(tasks):
        advance()
        yield answer


def _worked_out(tasks: Sequence[Task]) -> Iterator[Answer]:
    from agent.runtime.capabilities import cores

    workers = min(len(tasks), cores())
    if workers == 1:
        announce_compilation(threading.Event())
        try:
            yield from (work_out(on_all(task) if len(tasks) == 1 else task) for task in tasks)
        finally:
            _last().close()  # this process goes on, and the file may change
        return
    from agent.runtime.loop.process_pool import CONTEXT, results_of

    announced = CONTEXT.Event()
    loops = Counter(task.path for task in tasks)
    order = longest_first([_bytes(task.path) // loops[task.path] for task in tasks])
    in_turn = [tasks[k] for k in order]
    in_turn[-1] = on_all(in_turn[-1])  # the others end while it runs
    found = results_of(work_out, in_turn, workers, announce_compilation, announced)
    done: dict[int, Answer] = {}
    place = 0
    for k, answer in zip(order, found, strict=True):
        task = tasks[k]
        done[k] = Answer(task, None, (f"{_place(task)}: {DIED}",)) if answer is None else answer
        while place in done:
            yield done.pop(place)
            place += 1


def on_all(task: Task) -> Task:
    """Return a task that takes all cores."""
    from agent.runtime.capabilities import cores

    return replace(task, cores=cores())


def longest_first(sizes: Sequence[int]) -> list[int]:
    """Return the places in the order of work: what is much larger first, so that no core waits for it alone.

    Recordings of about one size keep their order, for answers are printed in that order as they come. Loops
    of one file have one size: they stay together, and each process reads the file once.
    """
    return sorted(range(len(sizes)), key=lambda k: -sizes[k].bit_length())


def _place(task: Task) -> str:
    return str(task.path) if task.loop is None else f"{task.path}: {task.loop}"


def _bytes(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return 0


@contextmanager
def progress_of(total: int) -> Iterator[Callable[[], None]]:
    """Show on a terminal's stderr that something is done; many results on a terminal show it themselves."""
    if not sys.stderr.isatty() or (total > 1 and sys.stdout.isatty()):
        yield lambda: None
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        SpinnerColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    many = (BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    columns = (TextColumn("diagnosing"), *(many if total > 1 else (SpinnerColumn(), TimeElapsedColumn())))
    console = Console(stderr=True)
    with Progress(*columns, console=console, redirect_stdout=False, transient=total == 1) as progress:
        work = progress.add_task("", total=total)
        yield lambda: progress.advance(work) if total > 1 else progress.stop()
