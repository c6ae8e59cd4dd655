"""Real valves ranked by P(sticks), all recordings of a valve as its history; nothing is tuned on them."""

from __future__ import annotations

from collections import defaultdict

from agent.analysis.diagnose import diagnose
from agent.analysis.diagnosis import Diagnosis
from agent.analysis.memory.sticks import LIKELY
from agent.analysis.one_valve import judged_together
from agent.analysis.record.recording import LoopWindow
from agent.analysis.record.window_of_recording import loop_window
from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.options import Options
from benchmarks.cases.recordings_folder import indexed, recordings_folder
from benchmarks.real_recordings import NOT_SCORED
from benchmarks.tables.markdown import table
from benchmarks.tables.ranking import area
from connectors.recording import read_recording


def run(_options: Options) -> None:
    """Print the ranking and the area under its curve."""
    folder = recordings_folder()
    if folder is None:
        print("No recordings folder (SLIPJUMP_DATA): the ranking of real valves is left out.\n")
        return
    labels: dict[str, str] = {}
    windows: dict[str, list[LoopWindow]] = defaultdict(list)
    for row in indexed(folder):
        if row["label"] not in {"stiction", "no_stiction"}:
            continue
        window = loop_window(read_recording(folder / row["file"]))
        if window.loop in NOT_SCORED:
            continue
        valve = row["group"] or window.loop
        labels[valve] = row["label"]
        windows[valve].append(window)
    with process_pool() as pool:
        alone = dict(zip(windows, pool.map(all_of, windows.values()), strict=True))
    ranked = sorted(
        ((p_of(windows[valve], alone[valve]), valve) for valve in windows), key=lambda each: -each[0]
    )
    rows = [(valve, labels[valve], len(windows[valve]), f"{p:.2f}") for p, valve in ranked]
    print(table("### Real valves by P(sticks)", ("valve", "label", "recordings", "P"), rows))
    positive = [p for p, valve in ranked if labels[valve] == "stiction"]
    negative = [p for p, valve in ranked if labels[valve] != "stiction"]
    found = sum(p > LIKELY for p in positive)
    print(f"Area under the curve: {area(positive, negative):.3f}; P > {LIKELY}: {found} of {len(positive)}\n")


def all_of(windows: list[LoopWindow]) -> list[Diagnosis]:
    return [diagnose(each) for each in windows]


def p_of(windows: list[LoopWindow], alone: list[Diagnosis]) -> float:
    sticks = judged_together(windows, alone)[0].sticks
    return 0.0 if sticks is None else sticks.probability
