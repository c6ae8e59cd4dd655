"""The rates of outcomes of windows, from simulated weeks: prints what `agent/analysis/memory/rates.py` holds.

How often all valves have an outcome is counted; how many of them stick then is what the log odds of a window
mean, which 346 loops calibrated (``evidence_weights``) and so few valves cannot. How alike the windows of a
valve are, the sum of each distribution, is the most likely one. The seeds are used for nothing else.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from rich.console import Console
from rich.progress import track
from scipy.optimize import minimize
from scipy.special import gammaln

from agent.analysis.memory.outcome import OUTCOMES, Outcome
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
LOG_ODDS: Mapping[Outcome, float] = {
    "against": -1.95,
    "hardly": -1.4,
    "weak": -0.5,
    "fair": 0.75,
    "strong": 2.5,
    "very_strong": 4.1,
    "stuck": 2.3,
}
"""Middle of each outcome's log odds, where about half of the loops stick as in ``evidence_weights``. Of a
valve that was stuck: ten to one, for none of 160 sound loops was called so (``no_response``)."""
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
    every = np.array([each.counts for each in valves])
    every = every[every.sum(axis=1) > 0]
    shares = (every / every.sum(axis=1, keepdims=True)).sum(axis=0) + PSEUDO
    odds = np.exp([LOG_ODDS[each] for each in OUTCOMES])
    for title, sticks in (("STICKS", True), ("SOUND", False)):
        part = shares * (odds if sticks else 1.0) / (1 + odds)
        counts = np.array([each.counts for each in valves if each.sticks == sticks])
        print(f"{title}: Mapping[Outcome, float] = {{")
        for name, value in zip(OUTCOMES, dirichlet(counts, part / part.sum()), strict=True):
            print(f'    "{name}": {value:.3f},')
        print("}")


def dirichlet(counts: FloatArray, mean: FloatArray) -> FloatArray:
    """Return the most likely parameters (k,), with this mean, of the rates of valves with ``counts``.

    Args:
        counts: Windows by outcome, (valves, k).
        mean: Adds up to one, (k,).
    """

    def cost(log_spread: FloatArray) -> float:
        alphas = mean * np.exp(log_spread[0])
        n = counts.sum(axis=1)
        own = gammaln(alphas.sum()) - gammaln(alphas.sum() + n)
        each = (gammaln(alphas + counts) - gammaln(alphas)).sum(axis=1)
        return -float((own + each).sum())

    low, high = np.log(SPREAD)
    found = minimize(cost, [np.log(4.0)], bounds=[(low, high)])
    return np.asarray(mean * np.exp(found.x[0]))
