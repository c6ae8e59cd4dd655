"""CPU time for one loop, on the loops of the paper's Table I that are public with OP and PV."""

from __future__ import annotations

import time
from pathlib import Path
from statistics import median

from agent.analysis.diagnose import diagnose
from agent.analysis.quantify import quantifier
from agent.analysis.recording import LoopHints, LoopWindow
from agent.cli.recordings import loop_window
from benchmarks.markdown import table
from benchmarks.recordings_folder import recordings_folder
from connectors.recording import read_recording

PRINTED = {"CHEM10": (12.9, 15.4), "CHEM11": (14.0, 19.5), "CHEM12": (23.4, 54.3)}
"""CPU time in Table I of Lee, Ren and Huang (2008), first and second order, s, Pentium 3.2 GHz."""
MEANS = (19.8, 33.0)
"""Their mean over all six loops, s."""
REPEATS = 3


def run(*, full: bool) -> None:
    """Print the table; ``full`` changes nothing here."""
    del full
    folder = recordings_folder()
    if folder is None:
        print("No recordings folder (SLIPJUMP_DATA): the speed on Table I is left out.\n")
        return
    windows = [window_of(folder / "isdb" / f"{loop}.csv") for loop in PRINTED]
    for method in ("free_run", "lee2008"):
        seconds(windows[0], method, None)  # compiled, or loaded from the cache
    rows = []
    for window in windows:
        times = [
            seconds(window, method, order) for method in ("lee2008", "free_run") for order in (1, 2, None)
        ]
        rows.append((window.loop, len(window), *PRINTED[window.loop], *(f"{each:.2f}" for each in times)))
    columns = (
        "loop",
        "samples",
        "paper, order 1",
        "order 2",
        *(
            f"`{method}`, {order}"
            for method in ("lee2008", "free_run")
            for order in ("order 1", "order 2", "free")
        ),
    )
    print(table("### CPU seconds for one loop", columns, rows))
    print(f"Mean of the six loops of the paper: {MEANS[0]:g} s and {MEANS[1]:g} s.\n")


def window_of(path: Path) -> LoopWindow:
    return loop_window(read_recording(path), LoopHints())


def seconds(window: LoopWindow, method: str, order: int | None) -> float:
    """Return the median CPU time of a whole diagnosis, s."""
    hinted = window.with_hints(LoopHints(order=order))
    times = []
    for _ in range(REPEATS):
        started = time.process_time()
        diagnose(hinted, quantifier=quantifier(method))
        times.append(time.process_time() - started)
    return median(times)
