"""Does the workbench give the same answer where the last digits of PV are others?

Another processor, library or number of cores rounds otherwise, and what a search makes of that is chaotic
where it ends before it has settled. So each record is compared as it is and with white noise of a billionth
of PV's span, which no instrument has digits for.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import groupby, product

import numpy as np
from rich.console import Console
from rich.progress import track

from agent.analysis.record.recording import LoopWindow
from agent.analysis.record.window_of_recording import loop_window
from agent.runtime.loop.process_pool import process_pool
from agent.workbench.session import Workbench
from benchmarks.cases.hidden_case import drawn
from benchmarks.cases.options import Options
from benchmarks.cases.recordings_folder import base_of, indexed, recordings_folder
from benchmarks.gallery import SHOWN
from benchmarks.hidden_effects import Job, jobs_of
from benchmarks.tables.markdown import table
from connectors.recording import read_recording

FIRST_SEED = 91860
LOOPS, LOOPS_FULL = 1, 4
"""Of each truth."""
DIGITS = 1e-9
"""Deviation of what is added, part of PV's span."""
TIMES = 3
"""That a record is compared beside once as it is."""

Record = Job | str
"""A simulated loop, or the name of a real recording."""


@dataclass(frozen=True, slots=True)
class Answer:
    """Of one record with some last digits."""

    record: Record
    effects: tuple[str, ...]
    """That ``auto`` added."""
    verdict: tuple[str, str | None]
    """Kind and effect of the last one."""
    rmse: float
    """Held out, of the last model, PV units."""


def run(options: Options) -> None:
    """Print the table, and a line of each record with more than one answer."""
    count = options.loops or (LOOPS_FULL if options.full else LOOPS)
    records: list[Record] = [*jobs_of(count, FIRST_SEED), *(SHOWN if recordings_folder() else ())]
    jobs = list(product(records, range(TIMES + 1)))
    with process_pool() as pool:
        found = list(track(pool.map(answer, jobs), "digits", len(jobs), console=Console(stderr=True)))
    groups = [[*each] for _, each in groupby(found, key=lambda each: each.record)]
    rows = []
    for title, real in (("simulated", False), ("real", True)):
        some = [each for each in groups if isinstance(each[0].record, str) is real]
        same = sum(len({one.effects for one in each}) == 1 for each in some)
        whole = sum(len({(one.effects, one.verdict) for one in each}) == 1 for each in some)
        apart = [max(one.rmse for one in each) / min(one.rmse for one in each) for each in some]
        rows.append((title, len(some), same, whole, float(np.quantile(apart, 0.9)) if apart else np.nan))
    columns = ("records", "number", "same effects", "and verdict", "held-out error, most over least, p90")
    print(table("### The same record with other last digits", columns, rows))
    for line in _lines(groups):
        print(line)


def answer(job: tuple[Record, int]) -> Answer:
    """Compare a record, its last digits changed where the number is not 0."""
    record, number = job
    window, base = window_of(record)
    if number:
        span = float(np.ptp(window.pv[np.isfinite(window.pv)]))
        digits = DIGITS * span * np.random.default_rng(number).standard_normal(len(window.pv))
        window = replace(window, pv=window.pv + digits)
    bench = Workbench(window, base)
    if not bench.auto():
        return Answer(record, (), ("not_testable", None), 1.0)
    verdict = bench.comparison().verdict
    return Answer(record, bench.step.effects, (verdict.kind, verdict.effect), bench.step.held_out.rmse)


def window_of(record: Record) -> tuple[LoopWindow, str]:
    """Return the record, and the base with which the workbench begins."""
    if not isinstance(record, str):
        return drawn(*record)[1], "fopdt"
    folder = recordings_folder()
    if folder is None:
        raise FileNotFoundError("SLIPJUMP_DATA names no folder")
    (row,) = (row for row in indexed(folder) if row["loop"] == record)
    return loop_window(read_recording(folder / row["file"])), base_of(row)


def _lines(groups: list[list[Answer]]) -> Iterator[str]:
    """Yield what differs."""
    for each in groups:
        if len({(one.effects, one.verdict) for one in each}) > 1:
            words = [f"{_named(one.effects)} ({one.verdict[0]}, {one.rmse:.4g})" for one in each]
            record = each[0].record
            yield f"{record if isinstance(record, str) else ' '.join(map(str, record))}: {'; '.join(words)}"


def _named(effects: tuple[str, ...]) -> str:
    return " ".join(effects) or "nothing"
