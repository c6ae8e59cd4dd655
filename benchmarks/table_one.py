"""The loops of the paper's Table I that are public with OP and PV: CPU time, and estimates of `free_run`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from agent.analysis.quantify import quantifier
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.record.window_of_recording import loop_window
from agent.units import FrictionBands
from benchmarks.cases.cpu_time import quantifier_seconds
from benchmarks.cases.options import Options
from benchmarks.cases.printed_valve import times_the_least
from benchmarks.cases.recordings_folder import recordings_folder
from benchmarks.tables.markdown import table
from connectors.recording import read_recording

PRINTED = {"CHEM10": (12.9, 15.4), "CHEM11": (14.0, 19.5), "CHEM12": (23.4, 54.3)}
"""CPU time in Table I of Lee, Ren and Huang (2008), first and second order, s, Pentium 3.2 GHz."""
VALVES = {
    "CHEM10": FrictionBands(1.70, 0.0),
    "CHEM11": FrictionBands(0.10, 0.04),
    "CHEM12": FrictionBands(0.78, 0.64),
}
"""f_S and f_D printed there, OP units."""
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
    print(amounts(windows))


def amounts(windows: Sequence[LoopWindow]) -> str:
    """Return the values of the paper beside the intervals of `free_run`, and how much worse they fit."""
    rows = []
    for window in windows:
        printed, found = VALVES[window.loop], quantifier("free_run").quantify(window).stiction
        if found is None:
            continue
        values = (printed.f_s, printed.f_d, printed.s, printed.j)
        cells = []
        for paper, each in zip(values, (found.f_s, found.f_d, found.s, found.j), strict=True):
            cells += [f"{paper:.2f}", f"{each.value:.2f} ({each.low:.2f} to {each.high:.2f})"]
        rows.append((window.loop, *cells, f"{times_the_least(window, printed):.2f}"))
    columns = ["loop"]
    for amount in ("f_S", "f_D", "S", "J"):
        columns += [f"{amount}: paper", "`free_run`"]
    return table(
        "### Estimates for the valves of Table I", (*columns, "error of the paper's, least = 1"), rows
    )


def window_of(path: Path) -> LoopWindow:
    return loop_window(read_recording(path))
