"""CPU time of the quantifiers on the loops of the paper's Table I that are public with OP and PV."""

from __future__ import annotations

from pathlib import Path

from agent.analysis.recording import LoopHints, LoopWindow
from agent.cli.recordings import loop_window
from benchmarks.cpu_time import quantifier_seconds
from benchmarks.markdown import table
from benchmarks.options import Options
from benchmarks.recordings_folder import recordings_folder
from connectors.recording import read_recording

PRINTED = {"CHEM10": (12.9, 15.4), "CHEM11": (14.0, 19.5), "CHEM12": (23.4, 54.3)}
"""CPU time in Table I of Lee, Ren and Huang (2008), first and second order, s, Pentium 3.2 GHz."""
MEANS = (19.8, 33.0)
"""Their mean over all six loops, s."""
METHODS = ("free_run", "lee2008")
ORDERS = (1, 2, None)


def run(_options: Options) -> None:
    """Print the table."""
    folder = recordings_folder()
    if folder is None:
        print("No recordings folder (SLIPJUMP_DATA): the speed on Table I is left out.\n")
        return
    windows = [window_of(folder / "isdb" / f"{loop}.csv") for loop in PRINTED]
    rows = []
    for window in windows:
        times = [
            quantifier_seconds(window.with_hints(LoopHints(order=order)), method)
            for method in METHODS
            for order in ORDERS
        ]
        rows.append((window.loop, len(window), *PRINTED[window.loop], *(f"{each:.2f}" for each in times)))
    words = [f"order {order}" if order else "free" for order in ORDERS]
    columns = (
        "loop",
        "samples",
        "paper, order 1",
        "order 2",
        *(f"`{method}`, {word}" for method in METHODS for word in words),
    )
    print(table("### CPU seconds for one loop of Table I", columns, rows))
    print(f"Mean of the six loops of the paper: {MEANS[0]:g} s and {MEANS[1]:g} s.\n")


def window_of(path: Path) -> LoopWindow:
    return loop_window(read_recording(path), LoopHints())
