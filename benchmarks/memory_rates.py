"""The rates of outcomes of windows, from simulated weeks: prints what `agent/analysis/memory/rates.py` holds.

The most likely Dirichlet distributions, with the weak prior that each outcome was seen once in fifty more
valves. The seeds are used for nothing else.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from rich.console import Console
from rich.progress import track
from scipy.optimize import minimize
from scipy.special import gammaln

from agent.analysis.memory.outcome import OUTCOMES
from agent.analysis.record.recording import FloatArray
from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.options import Options
from benchmarks.cases.weeks import DiagnosedValve, WeeksJob, diagnosed_valve

SEEDS = range(0, 40, 2)
MORE_SEEDS = range(0, 200, 2)
"""Even ones; odd seeds are for ``simulated_weeks``."""
WINDOWS = 6
DAYS = 42.0
PSEUDO = 0.2
"""Valves with each outcome that are added to those seen."""
SPREAD = (0.5, 200.0)
"""Range in which the sum of a distribution's parameters is searched."""


def run(options: Options) -> None:
    """Print the two tables."""
    seeds = MORE_SEEDS if options.full else SEEDS
    jobs = [WeeksJob(seed, DAYS, WINDOWS, sticks) for seed in seeds for sticks in (True, False)]
    with process_pool() as pool:
        answers = pool.map(diagnosed_valve, jobs)
        valves = list(track(answers, "valves", len(jobs), console=Console(stderr=True)))
    print_rates(valves)


def print_rates(valves: Sequence[DiagnosedValve]) -> None:
    for title, sticks in (("STICKS", True), ("SOUND", False)):
        counts = np.array([each.counts for each in valves if each.sticks == sticks])
        print(f"{title}: Mapping[Outcome, float] = {{")
        for name, value in zip(OUTCOMES, dirichlet(counts), strict=True):
            print(f'    "{name}": {value:.3f},')
        print("}")


def dirichlet(counts: FloatArray) -> FloatArray:
    """Return the most likely parameters (k,) of the rates of valves with ``counts`` (valves, k).

    Their mean is that of the valves' own shares with ``PSEUDO`` valves of each outcome; their sum, which says
    how alike valves are, is searched.
    """
    totals = counts.sum(axis=1, keepdims=True)
    shares = (counts[totals[:, 0] > 0] / totals[totals[:, 0] > 0]).sum(axis=0) + PSEUDO
    mean = shares / shares.sum()

    def cost(log_spread: FloatArray) -> float:
        alphas = mean * np.exp(log_spread[0])
        n = counts.sum(axis=1)
        own = gammaln(alphas.sum()) - gammaln(alphas.sum() + n)
        each = (gammaln(alphas + counts) - gammaln(alphas)).sum(axis=1)
        return -float((own + each).sum())

    low, high = np.log(SPREAD)
    found = minimize(cost, [np.log(4.0)], bounds=[(low, high)])
    return np.asarray(mean * np.exp(found.x[0]))
