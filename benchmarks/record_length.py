"""How the time for one loop grows with its record, on simulated sticking loops."""

from __future__ import annotations

from statistics import median

from rich.console import Console
from rich.progress import track

from agent.analysis.diagnose import DEFAULT_QUANTIFIER
from agent.analysis.quantify.processes.output_error import FIRST_ORDER
from agent.analysis.record.recording import LoopWindow
from benchmarks.cases.cpu_time import diagnosis_seconds, quantifier_seconds
from benchmarks.cases.options import Options
from benchmarks.lee2008_map import numpy_seconds, sticking_loop
from benchmarks.table_one import MEANS
from benchmarks.tables.markdown import table
from tests.reference.lee2008_numpy import map_by_candidate

LENGTHS = (500, 1000, 1500, 2000, 5000, 10_000, 20_000)
SEEDS = range(1000, 1005)
SEEDS_FULL = range(1000, 1020)
ALLOWED = {1500: 1.0, 5000: 3.0}
"""Median CPU time of the default quantifier that must hold, s (issue 3)."""
ALLOWED_IN_ALL = {1500: 1.5}
"""Likewise of a diagnosis by it and all detectors (issue 4)."""
EVERY = 50
"""NumPy's time is taken from one valve in so many."""


def run(options: Options) -> None:
    """Print a row for each length."""
    seeds = SEEDS_FULL if options.full else SEEDS
    loops = [sticking_loop(seed, LENGTHS[-1]) for seed in seeds]
    rows = []
    for samples in track(LENGTHS, "record lengths", console=Console(stderr=True)):
        cut = [(op[:samples], pv[:samples]) for op, pv in loops]
        windows = [LoopWindow(f"{samples}", 0.0, 1.0, op, pv) for op, pv in cut]
        ours = [quantifier_seconds(window, DEFAULT_QUANTIFIER, repeats=1) for window in windows]
        whole = median(diagnosis_seconds(window, DEFAULT_QUANTIFIER, repeats=1) for window in windows)
        lee2008 = [quantifier_seconds(window, "lee2008", repeats=1) for window in windows]
        numpy = median(
            numpy_seconds(map_by_candidate, op, pv, FIRST_ORDER, every=EVERY) for op, pv in cut[:3]
        )
        typical = median(ours)
        rows.append(
            (
                samples,
                f"{typical:.2f}",
                f"{max(ours):.2f}",
                allowed(ALLOWED.get(samples), typical),
                f"{whole:.2f}",
                allowed(ALLOWED_IN_ALL.get(samples), whole),
                f"{median(lee2008):.2f}",
                f"{numpy:.1f}",
                f"{numpy / typical:.1f}",
                *(f"{mean / typical:.0f}" for mean in MEANS),
            )
        )
    columns = (
        "samples",
        f"`{DEFAULT_QUANTIFIER}`, median",
        "longest",
        "at most",
        "whole diagnosis, median",
        "at most",
        "`lee2008`, median",
        "NumPy's map, order 1",
        "times ours",
        f"paper's {MEANS[0]:g} s, times ours",
        f"{MEANS[1]:g} s",
    )
    print(table(f"### CPU seconds by length of record, {len(seeds)} loops", columns, rows))


def allowed(most: float | None, typical: float) -> str:
    if most is None:
        return ""
    return f"{most:g}, {'holds' if typical <= most else '**does not hold**'}"
