"""Do the detectors see the oscillations that experts flagged in 46 OP records, and how fast are they?

The flags are those published with the records (Guan et al.); nothing in the detectors was set on them.
"""

from __future__ import annotations

import csv
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from agent.analysis.oscillation import DETECTORS, detect_oscillation
from agent.analysis.record.recording import LoopWindow
from agent.analysis.results import Oscillation
from benchmarks.cases.options import Options
from benchmarks.cases.recordings_folder import recordings_folder
from benchmarks.tables.markdown import table


@dataclass(frozen=True, slots=True)
class Flagged:
    """One record, its flag and what the detectors found."""

    loop: str
    kind: str
    flag: bool
    window: LoopWindow
    seen: Oscillation
    milliseconds: float
    """CPU time of ``detect_oscillation``."""

    @property
    def agrees(self) -> bool:
        return self.seen.detected == self.flag


def run(_options: Options) -> None:
    """Print the tables."""
    folder = recordings_folder()
    if folder is None:
        print("No recordings folder (SLIPJUMP_DATA): the flagged records are left out.\n")
        return
    records = flagged(folder)
    print(agreement(records))
    print(disputed(records))


def flagged(folder: Path) -> list[Flagged]:
    with (folder / "oscillation.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return [judged(folder, row) for row in rows]


def judged(folder: Path, row: dict[str, str]) -> Flagged:
    """Look at one record: OP stands for PV too, because PV was not published."""
    op = np.loadtxt(folder / row["file"], skiprows=1)
    window = LoopWindow(row["loop"], 0.0, float(row["Ts"]), op, op)
    started = time.process_time()
    seen = detect_oscillation(window)
    spent = 1000 * (time.process_time() - started)
    return Flagged(row["loop"], row["kind"], row["oscillating"] == "1", window, seen, spent)


def agreement(records: list[Flagged]) -> str:
    """Return a row for each detector, and for all together."""
    rows = [
        (f"`{detector.name}`", *counts(records, [detector.detect(each.window).detected for each in records]))
        for detector in DETECTORS
    ]
    rows.append(("`detect_oscillation`", *counts(records, [each.seen.detected for each in records])))
    slowest = max(records, key=lambda each: each.milliseconds)
    title = (
        f"### Agreement with the flags; at most {slowest.milliseconds:.0f} ms ({len(slowest.window)} samples)"
    )
    return table(title, ("detector", "flagged, seen", "not flagged, not seen", "agree"), rows)


def counts(records: list[Flagged], seen: list[bool]) -> tuple[str, str, str]:
    flags = [each.flag for each in records]
    hits = sum(one and other for one, other in zip(seen, flags, strict=True))
    quiet = sum(not one and not other for one, other in zip(seen, flags, strict=True))
    return (
        f"{hits} of {sum(flags)}",
        f"{quiet} of {len(flags) - sum(flags)}",
        f"{hits + quiet} of {len(flags)}",
    )


def disputed(records: list[Flagged]) -> str:
    """Return a row for each record whose flag differs."""
    rows = []
    for each in records:
        if each.agrees:
            continue
        period, regularity, share = each.seen.period, each.seen.regularity, each.seen.share
        length = each.window.ts * len(each.window)
        rows.append(
            (
                each.loop,
                each.kind,
                "oscillating" if each.flag else "not",
                "" if period is None else f"{period:.4g}",
                "" if period is None else f"{length / period:.3g}",
                "" if regularity is None else f"{regularity:.2f}",
                "" if share is None else f"{share:.0%}",
                ", ".join(detector.name for detector in DETECTORS if detector.detect(each.window).detected),
            )
        )
    columns = ("loop", "kind", "flag", "period, s", "periods", "regularity", "share of power", "seen by")
    return table("### Disputed records", columns, rows)
