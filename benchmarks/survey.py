"""A survey of simulated loops with one worker and with two, in one run: and how linear it is.

With ``--full`` two workers see all recordings, and both are compared on a part of them.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from agent.analysis.record.recording import LoopHints
from agent.cli.surveying.survey import local_processes
from agent.runtime.survey.ledger import Ledger
from agent.runtime.survey.survey import survey
from benchmarks.cases.options import Options
from benchmarks.looked_once import SAMPLES, window_of
from benchmarks.tables.markdown import table
from connectors.recording import ReadOptions
from connectors.sources.archive import parts_of

RECORDINGS = 8
FULL_RECORDINGS, FULL_COMPARED = 1000, 120
"""All of them, and those on which one worker is compared with two."""
SEED = 8600
KINDS = ("stiction", "tuning", "sinusoid", "none_noise")
WORKERS = (1, 2)


class _Silent:
    def begins(self, work: str, total: int, done: int) -> None: ...

    def advances(self) -> None: ...

    def fault(self, line: str) -> None:
        print(line)


def run(options: Options) -> None:
    """Print wall time for one and two workers."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        count = FULL_COMPARED if options.full else RECORDINGS
        archive = _archive(folder / "compared", count)
        seconds = {workers: _seconds(archive, folder / f"out{workers}", workers) for workers in WORKERS}
        rows = [_row(count, workers, wall) for workers, wall in seconds.items()]
        if options.full:
            wall = _seconds(_archive(folder / "all", FULL_RECORDINGS), folder / "out", WORKERS[-1])
            rows.append(_row(FULL_RECORDINGS, WORKERS[-1], wall))
    one, two = (seconds[workers] for workers in WORKERS)
    heads = ("recordings", "workers", "wall time, s", "s a recording", "min for 1000")
    print(table(f"### Survey of recordings of {SAMPLES} samples", heads, rows))
    print(f"Two workers take {two / one:.2f} of the time of one (linear: 0.50; the issue allows 0.575).")


def _row(count: int, workers: int, wall: float) -> tuple[str, ...]:
    return (
        str(count),
        str(workers),
        f"{wall:.1f}",
        f"{wall / count:.2f}",
        f"{1000 * wall / count / 60:.1f}",
    )


def _archive(folder: Path, count: int) -> Path:
    folder.mkdir()
    for k in range(count):
        _write(folder / f"L{k:04}.csv", SEED + k, KINDS[k % len(KINDS)])
    return folder


def _write(path: Path, seed: int, kind: str) -> None:
    window = window_of(seed, kind)
    lines = (
        f"{k * window.ts:g},{op:.6g},{pv:.6g}"
        for k, (op, pv) in enumerate(zip(window.op, window.pv, strict=True))
    )
    path.write_text("\n".join(("time,OP,PV", *lines)) + "\n")


def _seconds(archive: Path, folder: Path, workers: int) -> float:
    folder.mkdir()
    ledger = Ledger(folder / "survey.sqlite", (str(archive),))
    started = time.perf_counter()
    try:
        parts = parts_of([str(archive)])
        survey(parts, ReadOptions(), LoopHints(), local_processes(workers), ledger, _Silent())
    finally:
        ledger.close()
    return time.perf_counter() - started
