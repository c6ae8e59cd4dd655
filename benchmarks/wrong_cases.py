"""Where the diagnosis and the labels differ: table and pictures of docs/wrong_cases.md."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from rich.console import Console
from rich.progress import track

from agent.analysis.diagnose import diagnose
from agent.analysis.diagnosis import Diagnosis
from agent.analysis.one_valve import judged_together
from agent.analysis.oscillation.acf_zero_crossings import autocorrelation
from agent.analysis.record.recording import LoopWindow
from agent.analysis.record.window_of_recording import loop_window
from agent.cli.diagnosing.one_valve import valves
from agent.plots.axes import MEASURED, MODEL, SET_POINT, VALVE, legend_above, tidy
from agent.plots.time_units import time_of
from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.options import Options
from benchmarks.cases.recordings_folder import ROOT, indexed, recordings_folder
from benchmarks.oscillation import Flagged, flagged
from benchmarks.real_recordings import NOT_SCORED, is_right
from benchmarks.tables.markdown import table, words
from benchmarks.tables.page import put
from connectors.recording import read_recording

PAGE = ROOT / "docs" / "wrong_cases.md"
PICTURES = ROOT / "docs" / "pictures"
DPI = 70
MOST_POINTS = 1500
"""Of a curve in a picture."""


@dataclass(frozen=True, slots=True)
class Wrong:
    """A recording whose label differs from the verdict."""

    loop: str
    label: str
    window: LoopWindow
    said: Diagnosis

    def row(self) -> tuple[object, ...]:
        """Return the line of the table."""
        found = self.said.quantification
        share = evidence = turns = nats = ""
        if found is not None and found.evidence is not None:
            evidence = f"{found.evidence:.2f}"
            turns = "" if found.turns is None else str(found.turns)
            nats = "" if found.log_likelihood_ratio is None else f"{found.log_likelihood_ratio:.0f}"
            if found.stiction is not None:
                share = f"{100 * found.stiction.s.value / self.window.op_span:.0f} %"
        verdict = words(self.said.verdict)
        return self.loop, words(self.label), verdict, evidence, nats, turns, share


def run(_options: Options) -> None:
    """Write table and pictures into the docs, and print the table."""
    folder = recordings_folder()
    if folder is None:
        print("No recordings folder (SLIPJUMP_DATA): nothing was run.\n")
        return
    rows = [row for row in indexed(folder) if row["group"] not in NOT_SCORED]
    files = [folder / row["file"] for row in rows]
    with process_pool() as pool:
        answers = pool.map(judged, files)
        alone = list(track(answers, "wrong cases", len(files), console=Console(stderr=True)))
    wrong = [
        Wrong(file.stem, row["label"], window, said)
        for file, row, (window, said) in zip(files, rows, by_valve(files, alone), strict=True)
        if not is_right(row["label"], said.verdict)
    ]
    for each in wrong:
        picture(each).savefig(PICTURES / f"wrong_{each.loop}.png", dpi=DPI)
    for record in flagged(folder):
        if not record.agrees:
            picture_of_flag(record).savefig(PICTURES / f"flag_{record.loop}.png", dpi=DPI)
    found = report([each.row() for each in wrong])
    put(found, PAGE, "wrong_cases")
    print(found)


def judged(file: Path) -> tuple[LoopWindow, Diagnosis]:
    """Diagnose a recording alone."""
    window = loop_window(read_recording(file))
    return window, diagnose(window)


def by_valve(
    files: Sequence[Path], alone: Sequence[tuple[LoopWindow, Diagnosis]]
) -> list[tuple[LoopWindow, Diagnosis]]:
    """Return the diagnoses in view of the other recordings of each valve, as the command does."""
    valve, joined = valves(files, each=False, one_valve=False), list(alone)
    for one in set(valve):
        places = [k for k, of in enumerate(valve) if of == one]
        windows, said = zip(*(alone[k] for k in places), strict=True)
        for k, window, diagnosis in zip(places, windows, judged_together(windows, said), strict=True):
            joined[k] = window, diagnosis
    return joined


def report(rows: Sequence[Sequence[object]]) -> str:
    """Return the table."""
    columns = ("recording", "label", "said", "evidence", "nats", "turns of the valve", "S over OP span")
    return table("### Recordings whose label differs", columns, rows)


def picture(wrong: Wrong) -> Figure:
    """Draw PV and OP, with the PV and the valve of the model that was chosen."""
    window, found = wrong.window, wrong.said.quantification
    time, unit = time_of(len(window), window.ts)
    part = slice(None, None, math.ceil(len(window) / MOST_POINTS))
    figure = Figure(figsize=(10.0, 3.0), layout="constrained")
    pv, op = figure.subplots(1, 2)
    if window.sp is not None:
        pv.plot(time[part], window.sp[part], color=SET_POINT, linewidth=0.9, label="SP")
    pv.plot(time[part], window.pv[part], color=MEASURED, linewidth=0.8, label="PV")
    op.plot(time[part], window.op[part], color=MEASURED, linewidth=0.8, label="OP")
    if found is not None and found.model_pv is not None and found.model_mv is not None:
        pv.plot(time[part], found.model_pv[part], color=MODEL, linewidth=0.8, label="PV of the model")
        op.plot(time[part], found.model_mv[part], color=VALVE, linewidth=0.9, label="valve of the model")
    pv.set_ylabel("PV units")
    op.set_ylabel("OP units")
    for axes in (pv, op):
        axes.set_xlabel(f"time ({unit})")
        tidy(axes)
        legend_above(axes)
    return figure


def picture_of_flag(record: Flagged) -> Figure:
    """Draw OP and its autocorrelation."""
    op = record.window.op
    time, unit = time_of(len(op), record.window.ts)
    part = slice(None, None, math.ceil(len(op) / MOST_POINTS))
    figure = Figure(figsize=(10.0, 2.6), layout="constrained")
    over_time, lags = figure.subplots(1, 2, width_ratios=(2, 1))
    over_time.plot(time[part], op[part], color=MEASURED, linewidth=0.7)
    over_time.set_xlabel(f"time ({unit})")
    over_time.set_ylabel("OP units")
    found = autocorrelation(op - np.mean(op))
    if found is not None:
        lags.plot(time[: len(found.r)], found.r, color=MEASURED, linewidth=0.8)
    lags.axhline(0, color=SET_POINT, linewidth=0.6)
    lags.set_xlabel(f"lag of the autocorrelation ({unit})")
    for axes in (over_time, lags):
        tidy(axes)
    return figure
