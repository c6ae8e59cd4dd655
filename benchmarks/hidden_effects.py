"""Random simulated loops that hide a physical effect: is it found, is it named, how far does the error fall?

The valves obey physics that the workbench does not know. The seeds are not those from which thresholds were
set (0 to 39), nor those of tests (100 to 199). A saved run continues from its file.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import asdict
from itertools import pairwise
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track

from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.hidden_case import RECORD_KINDS, HiddenCase, RecordKind, judge
from benchmarks.cases.options import Options
from benchmarks.tables.markdown import table
from benchmarks.tables.quantiles import number, percent, quantile
from benchmarks.tables.targets import Target, share
from simulators.draws.hidden_effects import NOTHING, TRUTHS, HiddenTruth

FIRST_SEED = 64100
LOOPS, LOOPS_FULL = 8, 30
"""Of each truth."""
CLEAR = 30.0
"""Share of the base's residual variance from which an effect must be found, %."""
AT_THE_FLOOR = 1.15
"""Held-out error over the floor."""
SHARES = (0, 5, 10, 20, 30, 50, 70, 100)
"""Limits of the strata, %."""
HONEST = {"none_of_the_known", "suggested"}

Job = tuple[HiddenTruth, int, RecordKind]


def run(options: Options, name: str = "hidden_effects", first: int = FIRST_SEED, bursts: float = 0.0) -> None:
    """Print the tables; with ``options.save`` continue from the saved cases beside that file.

    Args:
        options: Of the command line.
        name: In the name of that file.
        first: Seed of the first loop of each truth.
        bursts: As in ``judge``.
    """
    count = options.loops or (LOOPS_FULL if options.full else LOOPS)
    jobs = jobs_of(count, first)
    file = None if options.save is None else options.save.with_suffix(f".{name}.jsonl")
    done = {(case.truth, case.seed, case.record): case for case in read(file)} if file else {}
    left = [job for job in jobs if job not in done]
    console = Console(stderr=True)
    for case in track(judged(left, bursts), "hidden effects", len(left), console=console, disable=not left):
        done[case.truth, case.seed, case.record] = case
        if file is not None:
            append(file, case)
    all_cases = [done[job] for job in jobs]
    cases = [case for case in all_cases if case.testable]
    skipped = len(all_cases) - len(cases)
    print(f"{len(all_cases)} loops; {skipped} are not testable and were skipped.\n")
    for part in (targets(cases), by_share(cases), by_truth(cases)):
        print(part)


def jobs_of(count: int, first: int = FIRST_SEED) -> list[Job]:
    """Return loops of each truth, seed by seed, in records of each kind in equal parts."""
    kinds = len(RECORD_KINDS)
    return [
        (truth, first + i, RECORD_KINDS[(i + at) % kinds])
        for i in range(count)
        for at, truth in enumerate(TRUTHS)
    ]


def judged(jobs: Sequence[Job], bursts: float) -> Iterator[HiddenCase]:
    """Judge the loops in a process for each core."""
    with process_pool() as pool:
        for future in as_completed([pool.submit(judge, *job, bursts) for job in jobs]):
            yield future.result()


def read(file: Path) -> list[HiddenCase]:
    """Return the cases of a file, one a line; none where it does not exist."""
    if not file.exists():
        return []
    return [HiddenCase(**json.loads(line)) for line in file.read_text(encoding="utf-8").splitlines()]


def append(file: Path, case: HiddenCase) -> None:
    with file.open("a", encoding="utf-8") as lines:
        lines.write(json.dumps(asdict(case)) + "\n")


def targets(cases: Sequence[HiddenCase]) -> str:
    """Return the requirements (issue 5) beside the measurements."""
    nothing = [case for case in cases if case.truth in NOTHING]
    hidden = [case for case in cases if case.truth not in NOTHING]
    single = [case for case in hidden if len(case.true_effects) == 1]
    clear = [case for case in single if case.share_percent >= CLEAR]
    two = [case for case in hidden if len(case.true_effects) == 2]
    without = [case for case in clear if case.without_kind]
    inside = [at < case.covered for case in hidden for at in range(case.parameters)]
    at_floor = [case.rmse_last <= AT_THE_FLOOR * case.floor for case in cases]
    rows: list[Target] = [
        share("nothing hidden, an effect named, %", [bool(case.named) for case in nothing], 0, 5),
        share("a wrong family named, %", [case.wrong for case in cases], 0, 5),
        share(f"family right, share >= {CLEAR:g} %, %", [case.family_right for case in clear], 95, 100),
        share("effect named or in the set, of these, %", [case.exact for case in clear], 90, 100),
        share("both of two effects found, %", [case.family_right for case in two], 85, 100),
        share("a decoy named, %", [case.decoys > 0 for case in cases], 0, 1),
        share(
            "honest where the family is not in the library, %",
            [case.without_kind in HONEST for case in without],
            90,
            100,
        ),
        share(f"held-out error <= {AT_THE_FLOOR:g} floor, %", at_floor, 90, 100),
        share(
            "interval holds the floor, %",
            [case.floor_low <= case.floor <= case.floor_high for case in cases],
            85,
            100,
        ),
        share("parameters within their 90 % intervals, %", inside, 85, 95),
    ]
    columns = ("what", "cases", "target", "measured", "holds")
    return table("### What must hold of the workbench", columns, [row.row() for row in rows])


def by_share(cases: Sequence[HiddenCase]) -> str:
    """Return how often one effect is found against how much it carries."""
    single = [case for case in cases if len(case.true_effects) == 1]
    rows = []
    for low, high in pairwise(SHARES):
        ones = [case for case in single if low <= case.share_percent < high]
        right = percent(case.family_right for case in ones)
        exact = percent(case.exact for case in ones)
        rows.append((f"{low} to {high}", len(ones), right, exact, percent(case.wrong for case in ones)))
    title = "### Single effects by the share of the base's residual variance that they carry"
    return table(title, ("share, %", "loops", "family right, %", "exact, %", "wrong family, %"), rows)


def by_truth(cases: Sequence[HiddenCase]) -> str:
    """Return a row for each truth."""
    rows = []
    for truth in TRUTHS:
        ones = [case for case in cases if case.truth == truth]
        if not ones:
            continue
        over = [case.rmse_last / case.floor for case in ones]
        rows.append(
            (
                f"`{truth}`",
                len(ones),
                number(quantile([case.share_percent for case in ones], 0.5), 0),
                percent(case.family_right for case in ones) if truth not in NOTHING else "",
                percent(case.exact for case in ones) if truth not in NOTHING else "",
                percent(case.wrong for case in ones),
                number(quantile(over, 0.5)),
                number(float(np.mean([case.cpu_seconds for case in ones])), 0),
            )
        )
    columns = (
        "hidden",
        "loops",
        "share, median %",
        "family right, %",
        "exact, %",
        "wrong family, %",
        "error over floor, median",
        "CPU s",
    )
    return table("### By what is hidden", columns, rows)
