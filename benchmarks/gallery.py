"""Effects that `compare --auto` finds in real recordings: table and pictures of docs/workbench/gallery.md."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from rich.console import Console
from rich.progress import track

from agent.analysis.record.window_of_recording import loop_window
from agent.plots.axes import MEASURED, MODEL, VALVE, legend_above, tidy
from agent.plots.time_units import time_of
from agent.report.comparison_text import verdict_words
from agent.runtime.loop.process_pool import process_pool
from agent.workbench.comparison import Comparison
from agent.workbench.session import Workbench
from benchmarks.cases.options import Options
from benchmarks.cases.recordings_folder import ROOT, base_of, indexed, recordings_folder
from benchmarks.tables.markdown import table
from benchmarks.tables.page import put
from connectors.recording import read_recording

SHOWN = (
    "CHEM10",
    "CHEM12",
    "CHEM1",
    "PAP2",
    "2411_FIC20102_53",
    "2411_FIC90204_55",
    "CHEM11",
    "PAP4",
    "CHEM13",
    "2111_FIC46005_15",
    "2411_AIC90201_38",
    "2111_PIC10201_35",
    "RHT_FIC11502_69",
    "2411_LIC10201_56",
)
"""Loops of the index: all of the ISDB, and of the refinery some of each kind and label."""
PAGE = ROOT / "docs" / "workbench" / "gallery.md"
PICTURES = ROOT / "docs" / "pictures"
PERIODS = 12.0
"""Of OP that a picture shows, from the middle of the record."""
DPI = 75


@dataclass(frozen=True, slots=True)
class Shown:
    """One recording, and its result."""

    loop: str
    label: str
    base: str
    effects: tuple[str, ...]
    alike: tuple[str, ...]
    fit_percent: tuple[float, float]
    """Of the base and of the last model, like the next."""
    held_out: tuple[float, float]
    """RMSE, PV units."""
    words: str
    """The verdict on the last model."""

    def row(self) -> tuple[object, ...]:
        """Return the line of the table."""
        if not self.base:
            return (f"`{self.loop}`", self.label, "", "", "", "", self.words)
        found = ", ".join(f"`{each}`" for each in self.effects) or "nothing"
        beside = f" (or {', '.join(self.alike)})" if self.alike else ""
        first, last = self.held_out
        fell = f"{first:.3g} to {last:.3g}" if self.effects else f"{first:.3g}"
        fit = f"{self.fit_percent[0]:.0f} to {self.fit_percent[1]:.0f}"
        return (
            f"`{self.loop}`",
            self.label.replace("_", " "),
            self.base,
            found + beside,
            fell,
            fit if self.effects else f"{self.fit_percent[0]:.0f}",
            self.words,
        )


def run(_options: Options) -> None:
    """Write table and pictures into the docs, and print the table."""
    folder = recordings_folder()
    if folder is None:
        print("No recordings folder (SLIPJUMP_DATA): nothing was run.\n")
        return
    index = {row["loop"]: row for row in indexed(folder)}
    jobs = [(folder / index[name]["file"], index[name]["label"], base_of(index[name])) for name in SHOWN]
    with process_pool() as pool:
        found = pool.map(shown, *zip(*jobs, strict=True))
        rows: list[tuple[object, ...]] = []
        for each in track(found, "gallery", len(jobs), console=Console(stderr=True)):
            rows.append(each.row())
            put(report(rows), PAGE, "gallery")
    print(report(rows))


def report(rows: Sequence[Sequence[object]]) -> str:
    """Return the table."""
    columns = ("recording", "label", "base", "missing", "held-out RMSE", "fit %", "what the last model lacks")
    return table("### What was found", columns, rows)


def shown(file: Path, label: str, base: str) -> Shown:
    """Run the workbench on one recording, and draw the result."""
    window = loop_window(read_recording(file))
    bench = Workbench(window, base)
    steps = bench.auto()
    found = bench.comparison()
    if not steps:
        return Shown(file.stem, label, "", (), (), (0, 0), (0, 0), f"not testable: {found.reason}")
    if bench.step.effects:
        picture(bench, found).savefig(PICTURES / f"gallery_{file.stem}.png", dpi=DPI)
    first, last = steps[0], steps[-1]
    alike = {other for step in steps if step.verdict for other in step.verdict.indistinguishable}
    return Shown(
        loop=file.stem,
        label=label,
        base=bench.base.name,
        effects=last.effects,
        alike=tuple(sorted(alike)),
        fit_percent=(first.fit_percent, last.fit_percent),
        held_out=(first.held_out.rmse, last.held_out.rmse),
        words=verdict_words(found.verdict, found),
    )


def picture(bench: Workbench, found: Comparison) -> Figure:
    """Draw some periods of PV with the base and the last model."""
    record, steps = bench.record, found.steps
    count = min(len(record), int(PERIODS * record.period))
    part = slice((len(record) - count) // 2, (len(record) + count) // 2)
    time, unit = time_of(len(record), record.facts.ts)
    figure = Figure(figsize=(9.0, 2.8), layout="constrained")
    axes = figure.subplots()
    axes.plot(time[part], np.where(record.weight > 0, record.pv, np.nan)[part], color=MEASURED, label="PV")
    axes.plot(time[part], steps[0].fit.pv[part], color=VALVE, linewidth=1.0, label=bench.base.name)
    name = f"with {', '.join(bench.step.effects)}"
    axes.plot(time[part], steps[-1].fit.pv[part], color=MODEL, linewidth=1.0, label=name)
    axes.set_ylabel(f"{found.loop}, PV units")
    axes.set_xlabel(f"time ({unit})")
    tidy(axes)
    legend_above(axes, columns=3)
    return figure
