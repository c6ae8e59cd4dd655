"""How far S of a window is from the true one: prints what `agent/analysis/wear/filter.py` holds.

Days of simulated valves that stick, whose S is constant: S of a day lies about the true one as its own
interval says, or it is short, or it is an outlier. The likeliest share of short days, and what they lack, are
found with the densities of the filter. The seeds are used for nothing else but `quiet_records`' rule.
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
from agent.analysis.wear.trend import SPREAD
from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.options import Options
from benchmarks.cases.weeks import WeeksJob, diagnosed_valve

SEEDS = range(64000, 64041)
DAYS, WINDOWS = 21.0, 4


def run(options: Options) -> None:
    """Print the two numbers."""
    seeds = SEEDS[: options.loops] if options.loops else SEEDS
    jobs = [WeeksJob(seed, DAYS, WINDOWS, sticks=True) for seed in seeds]
    with process_pool() as pool:
        answers = pool.map(diagnosed_valve, jobs)
        valves = list(track(answers, "valves", len(jobs), console=Console(stderr=True)))
    days = [(day, each.true_s[0]) for each in valves for day in each.memories[-1].s_days if not day.upper]
    short, lacks = likeliest(days)
    print(f"{len(days)} days of {len(valves)} valves\nSHORT = {short:.3f}\nLACKS = {lacks:.3f}")


def likeliest(days: Sequence[tuple[SDay, float]]) -> tuple[float, float]:
    """Return the share of short days and what they lack, logarithm of S, by maximum likelihood.

    Args:
        days: S of a day that shows it, with the true one, OP units.
    """
    misses = np.array([math.log(true / day.s) for day, true in days])
    own = np.array([math.sqrt(math.log1p((day.sd / day.s) ** 2)) for day, _ in days])
    outside = OUTLIER * density(misses, np.hypot(own, SPREAD))

    def loss(free: FloatArray) -> float:
        short, lacks = 1 / (1 + math.exp(-free[0])), math.exp(free[1])
        of_short = density(misses - lacks, np.hypot(own, lacks))
        found = (1 - OUTLIER) * ((1 - short) * density(misses, own) + short * of_short) + outside
        return -float(np.log(found).sum())

    best = minimize(loss, np.array([0.0, math.log(0.1)]), method="Nelder-Mead").x
    return 1 / (1 + math.exp(-best[0])), math.exp(best[1])


def density(miss: FloatArray, sd: FloatArray) -> FloatArray:
    """Return the normal density of misses with these standard deviations, (n,)."""
    return np.asarray(np.exp(-0.5 * (miss / sd) ** 2) / (sd * math.sqrt(2 * math.pi)))
