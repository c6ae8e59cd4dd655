"""P(sticks) where every record of a valve is fitted, quiet ones too, as ``diagnose`` does with recordings.

Four windows of each valve of the weeks, half of the valves stick. Compared are each record as one outcome,
and each as far as it would have shown a valve that sticks. The seeds are used for nothing else. By default
there are ten valves of each kind, which takes some minutes of CPU; ``--loops N`` makes it N, ``--full`` 63.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from rich.console import Console
from rich.progress import track

from agent.analysis.diagnose import diagnose
from agent.analysis.diagnosis import Diagnosis
from agent.analysis.evidence.weighing import SURE
from agent.analysis.memory.sticks import LIKELY, sticks_of
from agent.analysis.memory.weighing_windows import BASE_RATE
from agent.analysis.one_valve import judged_together
from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.options import Options
from benchmarks.cases.random_loop import window_kept
from benchmarks.tables.calibration import calibration_error, error_by_chance
from benchmarks.tables.markdown import table
from benchmarks.tables.ranking import area
from simulators.draws.valve_weeks import valve_weeks

SEEDS = range(65200, 65263)
USUAL = 10
"""Seeds without ``--full``."""
DAYS, RECORDS = 21.0, 4
ERRORS = ("calibration error", "by chance alone")
"""Columns of the table."""


@dataclass(frozen=True, slots=True)
class RatedValve:
    """The probabilities of a valve."""

    sticks: bool
    quiet: int
    """Records with a fit in which nothing happened."""
    together: float | None
    """By all as one record; None where there is but one."""
    each: float
    """P(sticks), each record as one outcome, whole."""
    now: float
    """P(sticks) as it is."""


def run(options: Options) -> None:
    """Print the table."""
    seeds = SEEDS[: options.loops or (len(SEEDS) if options.full else USUAL)]
    jobs = list(product(seeds, (True, False)))
    with process_pool() as pool:
        answers = pool.map(rated_valve, jobs)
        valves = list(track(answers, "valves", len(jobs), console=Console(stderr=True)))
    some = [("all", valves), ("with quiet records", [each for each in valves if each.quiet])]
    rows = []
    for title, ones in some:
        sticks = [each.sticks for each in ones]
        rows.append((title, len(ones), "each counts whole", *scores(sticks, [one.each for one in ones])))
        rows.append(
            (title, len(ones), "as far as they would show", *scores(sticks, [one.now for one in ones]))
        )
    columns = (
        "valves",
        "number",
        "records",
        "log loss",
        "area",
        "sticks, P > 0.5",
        "sound, P > 0.5",
        *ERRORS,
    )
    print(table("### P(sticks) where every record is fitted", columns, rows))
    sure = [each for each in valves if each.together is not None and each.together >= SURE]
    for name, found in (("whole", [one.each for one in sure]), ("now", [one.now for one in sure])):
        below = sum(p < LIKELY for p in found)
        print(f"All as one say stiction and P < {LIKELY}, {name}: {below} of {len(sure)}\n")


def rated_valve(job: tuple[int, bool]) -> RatedValve:
    seed, sticks = job
    valve = valve_weeks(seed, DAYS, RECORDS, sticks=sticks)
    windows = [window_kept(valve.name, each.scenario, each.historian) for each in valve.windows]
    alone = [diagnose(each) for each in windows]
    judged = judged_together(windows, alone)
    now, counted = judged[0].sticks, sticks_of([_whole(each) for each in alone])
    return RatedValve(
        sticks,
        sum(each.quiet and each.weighed is not None for each in alone),
        next((each.others.together for each in judged if each.others is not None), None),
        counted.probability,
        counted.probability if now is None else now.probability,
    )


def _whole(diagnosis: Diagnosis) -> Diagnosis:
    """Return a diagnosis that counts whole, whatever its window would have shown."""
    found = diagnosis.quantification
    return diagnosis if found is None else replace(diagnosis, quantification=replace(found, would_show=None))


def scores(sticks: Sequence[bool], p: Sequence[float]) -> tuple[str, ...]:
    """Return log loss at the base rate, area under the curve, who is above one half, calibration errors."""
    ones = [each for each, so in zip(p, sticks, strict=True) if so]
    others = [each for each, so in zip(p, sticks, strict=True) if not so]
    loss = -BASE_RATE * float(np.mean([math.log(each) for each in ones]))
    loss -= (1 - BASE_RATE) * float(np.mean([math.log(1 - each) for each in others]))
    found = [f"{sum(each > LIKELY for each in some)} of {len(some)}" for some in (ones, others)]
    errors = f"{calibration_error(p, sticks):.3f}", f"{error_by_chance(p, sticks):.3f}"
    return f"{loss:.3f}", f"{area(ones, others):.2f}", *found, *errors
