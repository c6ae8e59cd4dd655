"""How far S of a window is from the true one: prints what `agent/analysis/wear/filter.py` holds.

Days of simulated valves that stick: S of a day lies about the true one as its own interval says, or it is
short, or it is an outlier. Found are, with the densities of the filter, the likeliest share of the valves
whose days are short, and what these lack. It takes half an hour of CPU; ``--loops N`` takes N valves of each
group.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from rich.console import Console
from rich.progress import track
from scipy.optimize import minimize

from agent.analysis.memory.s_day import SDay
from agent.analysis.record.recording import FloatArray
from agent.analysis.wear.filter import OUTLIER
from agent.analysis.wear.stretches import SPREAD
from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.options import Options
from benchmarks.cases.weeks import DiagnosedValve, WeeksJob, diagnosed_valve

GROUPS = (
    [WeeksJob(seed, 21.0, 4, sticks=True) for seed in range(64000, 64041)],
    [WeeksJob(seed, 42.0, 6, sticks=True) for seed in range(65000, 65020)],
    [WeeksJob(seed, 28.0, 20, sticks=True, course="wear") for seed in range(65100, 65107)],
    [WeeksJob(seed, 28.0, 20, sticks=True, course="repair") for seed in range(65100, 65108)],
)


def run(options: Options) -> None:
    """Print the two numbers."""
    jobs = [job for group in GROUPS for job in group[: options.loops]]
    with process_pool() as pool:
        answers = pool.map(diagnosed_valve, jobs)
        valves = list(track(answers, "valves", len(jobs), console=Console(stderr=True)))
    days = [found for job, each in zip(jobs, valves, strict=True) if (found := days_of(job, each))]
    share, lacks = likeliest(days)
    print(f"{sum(len(each) for each in days)} days of {len(days)} valves")
    print(f"SHORT_VALVES = {share:.3f}\nLACKS = {lacks:.3f}")


def days_of(job: WeeksJob, valve: DiagnosedValve) -> list[tuple[SDay, float]]:
    """Return S of each day that shows it, before a repair, with the true one, OP units."""
    found = []
    for day, true, memory in zip(valve.days, valve.true_s, valve.memories, strict=True):
        newest = memory.s_days[-1] if memory.s_days else None
        repaired = job.course == "repair" and day > job.days / 2
        if newest and newest.time == memory.until and newest.above is None and not repaired:
            found.append((newest, true))
    return found


def likeliest(valves: Sequence[Sequence[tuple[SDay, float]]]) -> tuple[float, float]:
    """Return the likeliest share of valves whose days are short, and what these lack, logarithm of S.

    Args:
        valves: Days of each valve with their true S, OP units.
    """
    misses = [np.array([math.log(true / day.s) for day, true in each]) for each in valves]
    own = [np.array([math.sqrt(math.log1p((day.sd / day.s) ** 2)) for day, _ in each]) for each in valves]

    def loss(free: FloatArray) -> float:
        share, found = logistic(free[0]), 0.0
        for miss, sd in zip(misses, own, strict=True):
            right, short = (np.log(densities(miss, sd, each)).sum() for each in (0.0, math.exp(free[1])))
            found += float(np.logaddexp(math.log(1 - share) + right, math.log(share) + short))
        return -found

    best = minimize(loss, np.array([0.0, math.log(0.1)]), method="Nelder-Mead").x
    return logistic(best[0]), math.exp(best[1])


def densities(miss: FloatArray, sd: FloatArray, lacks: float) -> FloatArray:
    """Return the density of each miss of a valve whose days lack this, (n,)."""
    usual = density(miss - lacks, np.hypot(sd, lacks))
    return (1 - OUTLIER) * usual + OUTLIER * density(miss, np.hypot(sd, SPREAD))


def logistic(value: float) -> float:
    """Return the probability of log odds."""
    return 1 / (1 + math.exp(-value))


def density(miss: FloatArray, sd: FloatArray) -> FloatArray:
    """Return the normal density of misses with these standard deviations, (n,)."""
    return np.asarray(np.exp(-0.5 * (miss / sd) ** 2) / (sd * math.sqrt(2 * math.pi)))
