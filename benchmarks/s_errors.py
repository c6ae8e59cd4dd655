"""How far S of a day is from the true one: prints what `agent/analysis/wear/filter.py` holds.

Days of simulated valves that stick: S of a day lies about the true one as its own interval says, a part of
which all days of the valve have in common; or it is astray and less sure. Found are, with the densities of
the filter, the likeliest shares and standard deviations. It takes ten minutes of CPU; ``--loops N`` takes the
first N valves.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from rich.console import Console
from rich.progress import track
from scipy.optimize import minimize
from scipy.special import logsumexp

from agent.analysis.memory.s_day import SDay
from agent.analysis.record.recording import FloatArray
from agent.analysis.wear.filter import OUTLIER
from agent.analysis.wear.stretches import SPREAD
from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.options import Options
from benchmarks.cases.weeks import DiagnosedValve, WeeksJob, diagnosed_valve
from simulators.draws.valve_weeks import Course

SEEDS = range(82000, 82040)
WINDOWS: Mapping[Course, int] = {"constant": 8, "wear": 10, "repair": 20}
COURSES: tuple[Course, ...] = ("repair", "constant", "repair", "wear")
"""Of valves in turn: half of them are repaired on day 14, and count until then."""
BIASES = np.linspace(-3.0, 3.0, 25)
"""What the days of a valve have in common, standard deviations that are summed over."""


class Errors(NamedTuple):
    """As the numbers of these names in ``agent.analysis.wear.filter``."""

    short: float
    common: float
    wide: float
    """Share of the valves whose windows scatter far."""
    near: float
    far: float
    """How far windows of the others scatter, and those of these."""
    astray: float
    astray_sd: float


def run(options: Options) -> None:
    """Print the numbers."""
    courses = [(seed, COURSES[seed % len(COURSES)]) for seed in SEEDS]
    jobs = [WeeksJob(seed, 28.0, WINDOWS[course], True, course) for seed, course in courses[: options.loops]]
    with process_pool() as pool:
        answers = pool.map(diagnosed_valve, jobs)
        valves = list(track(answers, "valves", len(jobs), console=Console(stderr=True)))
    days = [found for job, each in zip(jobs, valves, strict=True) if (found := days_of(job, each))]
    errors = likeliest(days)
    print(f"{sum(len(each) for each in days)} days of {len(days)} valves")
    print(f"SHORT, COMMON = {errors.short:.2f}, {errors.common:.2f}")
    near, far = f"({1 - errors.wide:.2f}, {errors.near:.2f})", f"({errors.wide:.2f}, {errors.far:.2f})"
    print(f"SCATTERS = ({near}, {far})")
    print(f"ASTRAY, ASTRAY_SD = {errors.astray:.2f}, {errors.astray_sd:.3f}")


def days_of(job: WeeksJob, valve: DiagnosedValve) -> list[tuple[SDay, float]]:
    """Return S of each day that shows it, before a repair, with the true one, OP units."""
    found = []
    for day, true, memory in zip(valve.days, valve.true_s, valve.memories, strict=True):
        newest = memory.s_days[-1] if memory.s_days else None
        repaired = job.course == "repair" and day > job.days / 2
        if newest and newest.time == memory.until and newest.above is None and not repaired:
            found.append((newest, true))
    return found


def likeliest(valves: Sequence[Sequence[tuple[SDay, float]]]) -> Errors:
    """Return the likeliest shares and standard deviations.

    Args:
        valves: Days of each valve with their true S, OP units.
    """
    days = [each for valve in valves for each in valve]
    begins = np.cumsum([0, *(len(each) for each in valves[:-1])])
    miss = np.array([math.log(true / day.s) for day, true in days])
    own = np.array([math.sqrt(math.log1p((day.sd / day.s) ** 2)) for day, _ in days])
    sums = [np.add.reduceat(1 / own**power, begins) for power in (1, 2)]
    usual = np.repeat(sums[0] / sums[1], [len(each) for each in valves])
    weights = np.exp(-0.5 * BIASES**2)
    weights /= weights.sum()

    def loss(free: FloatArray) -> float:
        each = _errors(free)
        beside = miss - (each.short + each.common * BIASES)[:, None] * usual
        kinds = [
            np.log(share)
            + np.add.reduceat(np.log(densities(beside, scatter * own, own, each)), begins, axis=1)
            for share, scatter in ((1 - each.wide, each.near), (each.wide, each.far))
        ]
        return -float(logsumexp(np.logaddexp(*kinds), axis=0, b=weights[:, None]).sum())

    start = np.array([0.3, -0.5, 0.0, -1.5, -0.2, -2.0, -1.7])
    return _errors(minimize(loss, start, method="Nelder-Mead", options={"maxiter": 3000}).x)


def _errors(free: FloatArray) -> Errors:
    short, common, wide, near, far, astray, astray_sd = free.tolist()
    return Errors(
        short,
        math.exp(common),
        logistic(wide),
        math.exp(near),
        math.exp(far),
        logistic(astray),
        math.exp(astray_sd),
    )


def densities(miss: FloatArray, scatter: FloatArray, sd: FloatArray, errors: Errors) -> FloatArray:
    """Return the density of each miss (b, n) beside what the days of its valve have in common, (b, n).

    Args:
        miss: Logarithm of the true S over that of the day, (b, n).
        scatter: Standard deviation of what each day has for itself, (n,).
        sd: Of log S by the day's own interval, (n,).
        errors: Shares and standard deviations.
    """
    usual = density(miss, scatter)
    astray = density(miss, np.hypot(scatter, errors.astray_sd))
    far = density(miss, np.hypot(sd, SPREAD))
    return (1 - errors.astray - OUTLIER) * usual + errors.astray * astray + OUTLIER * far


def logistic(value: float) -> float:
    """Return the probability of log odds."""
    return 1 / (1 + math.exp(-value))


def density(miss: FloatArray, sd: FloatArray) -> FloatArray:
    """Return the normal density of misses with these standard deviations."""
    return np.asarray(np.exp(-0.5 * (miss / sd) ** 2) / (sd * math.sqrt(2 * math.pi)))
