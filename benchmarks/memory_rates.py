"""The rates of outcomes of windows, from simulated weeks: prints what `agent/analysis/memory/rates.py` holds.

Half of the valves move seldom, as in a plant. How many of those with an outcome stick is counted, together
with what the log odds of a window mean on the 346 loops of ``evidence_weights``: those move in each window,
and few valves of the weeks have the rarer outcomes. How alike the windows of a valve are, the sum of each
distribution, is the mean of its posterior. A sound valve that looks like one that sticks in all its windows
is one of ``MIMICS``, by its likelihood, and does not count for the mean rates of the others (expectation,
maximisation); for how alike windows are it counts, or a few sound valves would make many windows certain.
The seeds are used for nothing else.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console
from rich.progress import track
from scipy.special import gammaln

from agent.analysis.memory.outcome import OUTCOMES, Outcome
from agent.analysis.record.recording import FloatArray
from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.options import Options
from benchmarks.cases.weeks import DiagnosedValve, WeeksJob, diagnosed_valve

if TYPE_CHECKING:
    from numpy.typing import NDArray

SEEDS = range(0, 40, 2)
MORE_SEEDS = range(0, 200, 2)
"""Even ones; odd seeds are for ``simulated_weeks``."""
WINDOWS = 6
DAYS = 42.0
PSEUDO = 0.2
"""Valves of each kind with each outcome that are added to those seen: what none of twenty valves had may be
had by the next."""
NONE_OF: Mapping[Outcome, int] = {"stuck": 160}
"""Sound valves none of which has an outcome, where other measurements had more of them (``no_response``)."""
PRIOR = 2.0
"""Valves that the meaning of the log odds, on the loops of ``evidence_weights``, counts for, each outcome."""
SOUND_BEFORE, MIMICS_BEFORE = 50, 1
"""Sound valves of ``benchmarks.one_valve``, half with something that the models lack, and those of them whose
recordings all look like friction."""
JEFFREYS = 0.5
ROUNDS = 20
"""Of expectation and maximisation."""
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
ALIKE = np.linspace(0.0, 1.0, 201)[1:-1]
"""Correlations of two windows of a valve that are tried. The likeliest one alone is at its bound wherever no
valve of so few has mixed outcomes, and then one contrary window would count for many."""


def run(options: Options) -> None:
    """Print the two tables."""
    seeds = MORE_SEEDS if options.full else SEEDS
    jobs = [WeeksJob(seed, DAYS, WINDOWS, sticks) for seed in seeds for sticks in (True, False)]
    with process_pool() as pool:
        answers = pool.map(diagnosed_valve, jobs)
        valves = list(track(answers, "valves", len(jobs), console=Console(stderr=True)))
    print_rates(valves)


def print_rates(valves: Sequence[DiagnosedValve]) -> None:
    with_windows = [each for each in valves if sum(each.counts) > 0]
    counts = np.array([each.counts for each in with_windows])
    sticks, sound, mimics = rates(counts, np.array([each.sticks for each in with_windows]))
    for title, alphas in (("STICKS", sticks), ("SOUND", sound)):
        print(f"{title}: Mapping[Outcome, float] = {{")
        for name, value in zip(OUTCOMES, alphas, strict=True):
            print(f'    "{name}": {value:.3f},')
        print("}")
    print(f"MIMICS = {mimics:.3f}")


def rates(counts: FloatArray, sticks: NDArray[np.bool_]) -> tuple[FloatArray, FloatArray, float]:
    """Return the parameters (k,) for valves that stick and for sound ones, and the part of mimics.

    Args:
        counts: Windows by outcome, one at least, (valves, k).
        sticks: Whether a valve sticks, (valves,).
    """
    own = np.ones(int((~sticks).sum()))
    for _ in range(ROUNDS):
        means = mean_rates(counts, sticks, own)
        ones = dirichlet(counts[sticks], means[0])
        others = dirichlet(counts[~sticks], means[1])
        mimics = float(MIMICS_BEFORE + JEFFREYS + (1 - own).sum()) / (SOUND_BEFORE + 2 * JEFFREYS + len(own))
        like = [np.exp(log_likelihoods(counts[~sticks], each)) for each in (others, ones)]
        own = (1 - mimics) * like[0] / ((1 - mimics) * like[0] + mimics * like[1])
    return ones, others, mimics


def mean_rates(
    counts: FloatArray, sticks: NDArray[np.bool_], own: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the mean rates (k,) of valves that stick and of sound ones, which count by ``own`` each."""
    shares = counts / counts.sum(axis=1, keepdims=True)
    with_it, without = shares[sticks].sum(axis=0), (own[:, None] * shares[~sticks]).sum(axis=0)
    meant = 1 / (1 + np.exp([-LOG_ODDS[each] for each in OUTCOMES]))
    part = (with_it + PRIOR * meant) / (with_it + without + PRIOR)
    seen = with_it + without
    fewer = np.array([min(1.0, len(own) / NONE_OF.get(each, 1)) for each in OUTCOMES])
    ones, others = part * seen + PSEUDO, (1 - part) * seen + PSEUDO * fewer
    return ones / ones.sum(), others / others.sum()


def dirichlet(counts: FloatArray, mean: FloatArray) -> FloatArray:
    """Return the parameters (k,), with this mean, of the rates of valves with ``counts``.

    How alike the windows of a valve are, rho = 1 / (1 + A) with A the sum of the parameters, is the mean of
    its posterior, with each rho as probable as another before.

    Args:
        counts: Windows by outcome, (valves, k).
        mean: Adds up to one, (k,).
    """
    found = np.array([log_likelihoods(counts, mean * (1 / rho - 1)).sum() for rho in ALIKE])
    weight = np.exp(found - found.max())
    alike = float(weight @ ALIKE / weight.sum())
    return np.asarray(mean * (1 / alike - 1))


def log_likelihoods(counts: FloatArray, alphas: FloatArray) -> FloatArray:
    """Return that of each valve's counts, less a constant of the counts, (valves,)."""
    n = counts.sum(axis=1)
    own = gammaln(alphas.sum()) - gammaln(alphas.sum() + n)
    return np.asarray(own + (gammaln(alphas + counts) - gammaln(alphas)).sum(axis=1))
