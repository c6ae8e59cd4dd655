"""`slipjump diagnose` on every real recording, against the labels published with the data.

Against the label `stiction` only `stiction` is right, against `no_stiction` every other verdict is; a valve
with several recordings goes by majority. Alone is with `--each`; together is as the command does by itself:
recordings whose names have the same tag are of one valve.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.cases.options import Options
from benchmarks.cases.recordings_folder import indexed, recordings_folder
from benchmarks.tables.markdown import table, words

RUNS = {
    "`free_run`, alone": ("free_run", "--each"),
    "`free_run`, together": ("free_run",),
    "`lee2008`": ("lee2008",),
}
"""Quantifier and further words of the command by what the tables call it."""
NOT_SCORED = {"PAP4"}
"""It has a dead zone and tight tuning but is labelled no stiction: shown only."""


@dataclass(frozen=True, slots=True)
class Judged:
    """One recording with its label and the result of one quantifier."""

    loop: str
    label: str
    valve: str
    verdict: str
    evidence: float | None
    linear_percent: float | None
    methods: dict[str, str]
    """Verdict of each method."""

    @property
    def right(self) -> bool:
        return is_right(self.label, self.verdict)


def is_right(label: str, verdict: str) -> bool:
    return (verdict == "stiction") == (label == "stiction")


def run(_options: Options) -> None:
    """Print the tables."""
    folder = recordings_folder()
    if folder is None:
        print("No recordings folder (SLIPJUMP_DATA): the real recordings are left out.\n")
        return
    index = indexed(folder)
    judged = {name: diagnosed(folder, index, *chosen) for name, chosen in RUNS.items()}
    print(summary(judged))
    print(valves(judged))
    print(recordings(judged))
    print(methods(next(iter(judged.values()))))


def diagnosed(folder: Path, index: Sequence[dict[str, str]], quantifier: str, *options: str) -> list[Judged]:
    """Run the command as a user would."""
    command = [
        str(Path(sys.executable).with_name("slipjump")),
        "diagnose",
        "--json",
        "--quantifier",
        quantifier,
        *options,
    ]
    paths = [str(folder / row["file"]) for row in index]
    done = subprocess.run([*command, *paths], capture_output=True, text=True, check=True)  # noqa: S603 - our own command
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    return [
        Judged(
            row["loop"],
            row["label"],
            row["group"],
            answer["verdict"],
            answer["methods"].get(quantifier, {}).get("index"),
            answer["fit"]["linear_percent"],
            {name: said["verdict"] for name, said in answer["methods"].items()},
        )
        for row, answer in zip(index, answers, strict=True)
    ]


def by_valve(judged: Sequence[Judged]) -> dict[str, list[Judged]]:
    valves = defaultdict(list)
    for each in judged:
        valves[each.valve].append(each)
    return valves


def majority_sticks(recordings: Sequence[Judged]) -> bool:
    """Whether more than half of a valve's recordings are called stiction."""
    return sum(each.verdict == "stiction" for each in recordings) > len(recordings) / 2


def valve_right(recordings: Sequence[Judged]) -> bool:
    return majority_sticks(recordings) == (recordings[0].label == "stiction")


def summary(judged: dict[str, list[Judged]]) -> str:
    rows = []
    for name, answers in judged.items():
        scored = [each for each in answers if each.valve not in NOT_SCORED]
        for label in ("stiction", "no_stiction"):
            ones = [each for each in scored if each.label == label]
            groups = by_valve(ones).values()
            firm = sum(each.verdict == label for each in ones)
            rows.append(
                (
                    name,
                    words(label),
                    f"{sum(each.right for each in ones)} of {len(ones)}",
                    f"{firm} of {len(ones)}",
                    f"{sum(valve_right(group) for group in groups)} of {len(groups)}",
                )
            )
    columns = ("quantifier", "label", "recordings right", "said firmly", "valves right")
    return table("### Real recordings", columns, rows)


def valves(judged: dict[str, list[Judged]]) -> str:
    """Return a row for each valve: how many of its recordings were called stiction."""
    groups = [by_valve(answers) for answers in judged.values()]
    rows = []
    for valve, first in groups[0].items():
        cells = []
        for group in groups:
            ones = group[valve]
            called = sum(each.verdict == "stiction" for each in ones)
            mark = "" if valve in NOT_SCORED or valve_right(ones) else ", **wrong**"
            cells.append(f"{called} of {len(ones)}{mark}")
        rows.append((valve, words(first[0].label), *cells))
    columns = ("valve", "label", *(f"{name}: calls stiction" for name in judged))
    return table("### By valve", columns, rows)


def recordings(judged: dict[str, list[Judged]]) -> str:
    rows = []
    for answers in zip(*judged.values(), strict=True):
        cells = []
        for each in answers:
            wrong = not each.right and each.valve not in NOT_SCORED
            evidence = "" if each.evidence is None else f" {each.evidence:.2f}"
            cells.append(f"{'**' if wrong else ''}{words(each.verdict)}{'**' if wrong else ''}{evidence}")
        percent = answers[0].linear_percent
        rows.append(
            (answers[0].loop, words(answers[0].label), "" if percent is None else f"{percent:.0f}", *cells)
        )
    columns = ("recording", "label", "linear fit, %", *(f"{name}, evidence" for name in judged))
    return table("### By recording", columns, rows)


def methods(judged: Sequence[Judged]) -> str:
    """Return a row for each method and the diagnosis: sticking valves found, sound valves called sticking."""
    scored = [each for each in judged if each.valve not in NOT_SCORED]
    names = dict.fromkeys(name for each in judged for name in each.methods)
    rows = [(f"`{name}`", *found(scored, [each.methods.get(name, "") for each in scored])) for name in names]
    rows.append(("diagnosis", *found(scored, [each.verdict for each in scored])))
    columns = ("method", "sticking: found", "cleared", "sound: accused", "cleared")
    return table("### Every method on the recordings, of those where it applies", columns, rows)


def found(judged: Sequence[Judged], said: Sequence[str]) -> list[str]:
    cells = []
    for label in ("stiction", "no_stiction"):
        words = [word for each, word in zip(judged, said, strict=True) if each.label == label]
        decided = sum(word in ("stiction", "no_stiction", "undecided") for word in words)
        cells += [f"{words.count('stiction')} of {decided}", str(words.count("no_stiction"))]
    return cells
