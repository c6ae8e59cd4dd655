"""The diagnosis and every method on simulated loops: how often each is right, and whether the confidence is.

None of the seeds was used to set weights or thresholds.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import pairwise

from rich.console import Console
from rich.progress import track

from agent.analysis.diagnose import DEFAULT_QUANTIFIER
from agent.analysis.stiction import DETECTORS
from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.diagnosed_loop import DiagnosedLoop, diagnosed_loop
from benchmarks.cases.options import Options
from benchmarks.cases.random_loop import KINDS, MOVED, STEADY, AnyKind
from benchmarks.simulated import get_ready
from benchmarks.tables.markdown import table, words
from benchmarks.tables.quantiles import number, percent, quantile

FIRST_SEED = 4000
LOOPS, LOOPS_FULL = 20, 100
"""Of each kind."""
METHODS = (DEFAULT_QUANTIFIER, *(each.name for each in DETECTORS))
NEED_STEM = ("kano_a", "kano_b", "yamashita", "damarla")
"""Methods that look at the stem where it is measured."""
SURENESS = (0.0, 0.8, 0.9, 0.95, 0.985, 1.0)
"""Limits of the confidence, for the table of its calibration."""


def run(options: Options) -> None:
    """Print the tables."""
    count = options.loops or (LOOPS_FULL if options.full else LOOPS)
    jobs = [(kind, FIRST_SEED + i) for i in range(count) for kind in KINDS]
    console = Console(stderr=True)
    for part in tables(list(track(in_processes(jobs), "simulated loops", len(jobs), console=console))):
        print(part)


def in_processes(jobs: Sequence[tuple[AnyKind, int]]) -> list[DiagnosedLoop]:
    with process_pool(None, get_ready) as pool:
        return list(pool.map(diagnosed_loop, jobs))


def tables(cases: Sequence[DiagnosedLoop]) -> list[str]:
    return [targets(cases), by_kind(cases), confusion(cases), reliability(cases), by_method(cases)]


def targets(cases: Sequence[DiagnosedLoop]) -> str:
    """Return the requirements (issue 4) beside the measurements."""
    steady = [each for each in cases if each.kind in STEADY and each.little_noise]
    sound = [each for each in cases if not each.sticks]
    steady_sound = [each for each in sound if each.kind in STEADY]
    rows = [
        ("right by cause, noise <= 15 %, kinds of `random_plants`", len(steady), ">= 95", rate(steady)),
        ("sound loops called sticking, the same kinds", len(steady_sound), "<= 2", accused(steady_sound)),
        ("sound loops called sticking, set points that step as well", len(sound), "<= 2", accused(sound)),
        ("CPU time of a diagnosis, s, median", len(cases), "<= 1.5", cpu(cases)),
    ]
    return table("### What must hold of the diagnosis, %", ("what", "loops", "target", "measured"), rows)


def rate(cases: Sequence[DiagnosedLoop]) -> str:
    return number(100 * sum(each.right for each in cases) / max(len(cases), 1), 1)


def accused(cases: Sequence[DiagnosedLoop]) -> str:
    return number(100 * sum(each.verdict == "stiction" for each in cases) / max(len(cases), 1), 1)


def cpu(cases: Sequence[DiagnosedLoop]) -> str:
    return number(quantile([each.cpu_seconds for each in cases], 0.5))


def by_kind(cases: Sequence[DiagnosedLoop]) -> str:
    rows = []
    for kind in KINDS:
        ones = [each for each in cases if each.kind == kind]
        quiet = [each for each in ones if each.little_noise]
        said = [percent(each.verdict == word for each in ones) for word in ("stiction", "undecided")]
        both = percent({"stiction", "external_disturbance"} <= set(each.causes) for each in ones)
        stem = percent(each.with_stem == "stiction" for each in ones)
        right = percent(each.right for each in ones), percent(each.right for each in quiet)
        rows.append((f"`{kind}`", len(ones), *said, *right, both, stem))
    columns = (
        "kind",
        "loops",
        "stiction",
        "undecided",
        "right by cause",
        "noise <= 15 %",
        "stiction and a disturbance",
        "stiction where the stem is measured",
    )
    return table("### The diagnosis on simulated loops, %", columns, rows)


def confusion(cases: Sequence[DiagnosedLoop]) -> str:
    causes = ("stiction", "tight_tuning", "external_disturbance", "no_oscillation", "undecided")
    rows = []
    for kind in KINDS:
        said = Counter(each.causes[0] for each in cases if each.kind == kind)
        rows.append((f"`{kind}`", *(said[cause] or "" for cause in causes)))
    return table("### Causes named, loops", ("kind", *map(words, causes)), rows)


def reliability(cases: Sequence[DiagnosedLoop]) -> str:
    """Return how often verdicts of a confidence are right."""
    firm = [each for each in cases if each.verdict in ("stiction", "no_stiction")]
    rows = []
    for low, high in pairwise(SURENESS):
        ones = [each for each in firm if low < each.confidence <= high]
        if ones:
            said = 100 * sum(each.confidence for each in ones) / len(ones)
            true = 100 * sum((each.verdict == "stiction") == each.sticks for each in ones) / len(ones)
            rows.append((f"{low:g} to {high:g}", len(ones), number(said, 1), number(true, 1)))
    columns = ("confidence", "verdicts", "mean confidence, %", "right, %")
    return table("### Is the confidence true?", columns, rows)


def by_method(cases: Sequence[DiagnosedLoop]) -> str:
    rows = [
        (f"`{method}`", *method_row(cases, [each.methods.get(method, "") for each in cases]))
        for method in METHODS
    ]
    for method in NEED_STEM:
        said = [each.methods_with_stem.get(method, "") for each in cases]
        rows.append((f"`{method}`, stem measured", *method_row(cases, said)))
    rows.append(("diagnosis", *method_row(cases, [each.verdict for each in cases])))
    rows.append(("diagnosis, stem measured", *method_row(cases, [each.with_stem for each in cases])))
    columns = (
        "method",
        "limit cycles found",
        "limit cycles cleared",
        "sticking, set point or load moves too: found",
        "sound, steady: accused",
        "sound, set point steps: accused",
    )
    return table("### Every method on them, loops", columns, rows)


def method_row(cases: Sequence[DiagnosedLoop], said: Sequence[str]) -> list[str]:
    def count(verdict: str, kinds: Sequence[AnyKind], *, sticks: bool) -> str:
        ones = [
            word
            for case, word in zip(cases, said, strict=True)
            if case.kind in kinds and case.sticks == sticks
        ]
        decided = sum(word in ("stiction", "no_stiction", "undecided") for word in ones)
        return f"{sum(word == verdict for word in ones)} of {decided}"

    return [
        count("stiction", STEADY, sticks=True),
        count("no_stiction", STEADY, sticks=True),
        count("stiction", MOVED, sticks=True),
        count("stiction", STEADY, sticks=False),
        count("stiction", MOVED, sticks=False),
    ]
