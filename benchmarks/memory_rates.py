"""The rates of outcomes of windows, from simulated weeks: prints what `agent/analysis/memory/rates.py` holds.

Half of the valves move seldom, as in a plant. How many of those with an outcome stick is counted, together
with what the log odds of a window mean on the 346 loops of ``evidence_weights``: those move in each window,
and few valves of the weeks have the rarer outcomes. How alike the windows of a valve are, the sum of each
distribution, is the mean of its posterior. A sound valve that looks like one that sticks in all its windows
is one of ``MIMICS``, by its likelihood, and does not count for the mean rates of the others (expectation,
maximisation); for how alike windows are it counts, or a few sound valves would make many windows certain. A
sticking valve that looks like a sound one in all its windows is one of ``HIDDEN``, likewise.
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

STICKING, SOUND = range(92001, 92021), range(92021, 92041)
"""Seeds of the valves."""
WINDOWS, ONE_IN = 28, 2
DAYS = 7.0
PSEUDO = 0.2
"""Valves of each kind with each outcome that are added to those seen: what none of twenty valves had may be
had by the next."""
NONE_OF: Mapping[Outcome, int] = {"stuck": 160}
"""Sound valves none of which has an outcome, where other measurements had more of them (``no_response``)."""
PRIOR = 2.0
"""Valves that the meaning of the log odds, on the loops of ``evidence_weights``, counts for, each outcome."""
SOUND_BEFORE, MIMICS_BEFORE = 70, 2
"""Sound valves of ``benchmarks.one_valve``, half with something that the models lack, and of weeks before,
and those of them whose recordings all look like friction."""
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


def run(_options: Options) -> None:
    """Print the tables."""
    seeds = [(seed, True) for seed in STICKING] + [(seed, False) for seed in SOUND]
    jobs = [WeeksJob(seed, DAYS, WINDOWS, sticks, one_in=ONE_IN) for seed, sticks in seeds]
    with process_pool() as pool:
        answers = pool.map(diagnosed_valve, jobs)
        valves = list(track(answers, "valves", len(jobs), console=Console(stderr=True)))
    print_rates(valves)


def print_rates(valves: Sequence[DiagnosedValve]) -> None:
    with_windows = [each for each in valves if sum(each.counts) > 0]
    counts = np.array([each.counts for each in with_windows])
    sticks, sound, mimics, hidden = rates(counts, np.array([each.sticks for each in with_windows]))
    for title, alphas in (("STICKS", sticks), ("SOUND", sound)):
        print(f"{title}: Mapping[Outcome, float] = {{")
        for name, value in zip(OUTCOMES, alphas, strict=True):
            print(f'    "{name}": {value:.3f},')
        print("}")
    print(f"MIMICS = {mimics:.3f}\nHIDDEN = {hidden:.3f}")


def rates(counts: FloatArray, sticks: NDArray[np.bool_]) -> tuple[FloatArray, FloatArray, float, float]:
    """Return the parameters (k,) for valves that stick and for sound ones, and the parts that look otherwise.

    Args:
        counts: Windows by outcome, one at least, (valves, k).
        sticks: Whether a valve sticks, (valves,).
    """
    shown, own = np.ones(int(sticks.sum())), np.ones(int((~sticks).sum()))
    for _ in range(ROUNDS):
        means = mean_rates(counts, sticks, shown, own)
        ones = dirichlet(counts[sticks], means[0], shown)
        others = dirichlet(counts[~sticks], means[1], np.ones(len(own)))
        mimics = (MIMICS_BEFORE + JEFFREYS + (1 - own).sum()) / (SOUND_BEFORE + 2 * JEFFREYS + len(own))
        hidden = (JEFFREYS + (1 - shown).sum()) / (2 * JEFFREYS + len(shown))
        own = _of_their_kind(counts[~sticks], others, ones, mimics)
        shown = _of_their_kind(counts[sticks], ones, others, hidden)
    return ones, others, float(mimics), float(hidden)


def _of_their_kind(counts: FloatArray, own: FloatArray, others: FloatArray, part: float) -> FloatArray:
    """Return how likely each valve has the rates of its kind, (valves,), where a part has the others'."""
    otherwise = np.exp(np.clip(log_likelihoods(counts, others) - log_likelihoods(counts, own), -700, 700))
    return np.asarray((1 - part) / (1 - part + part * otherwise))


def mean_rates(
    counts: FloatArray, sticks: NDArray[np.bool_], shown: FloatArray, own: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the mean rates (k,) of valves that stick, which count by ``shown`` each, and of sound ones."""
    shares = counts / counts.sum(axis=1, keepdims=True)
    with_it = (shown[:, None] * shares[sticks]).sum(axis=0)
    without = (own[:, None] * shares[~sticks]).sum(axis=0)
    meant = 1 / (1 + np.exp([-LOG_ODDS[each] for each in OUTCOMES]))
    part = (with_it + PRIOR * meant) / (with_it + without + PRIOR)
    seen = with_it + without
    fewer = np.array([min(1.0, len(own) / NONE_OF.get(each, 1)) for each in OUTCOMES])
    ones, others = part * seen + PSEUDO, (1 - part) * seen + PSEUDO * fewer
    return ones / ones.sum(), others / others.sum()


def dirichlet(counts: FloatArray, mean: FloatArray, by: FloatArray) -> FloatArray:
    """Return the parameters (k,), with this mean, of the rates of valves with ``counts``.

    How alike the windows of a valve are, rho = 1 / (1 + A) with A the sum of the parameters, is the mean of
    its posterior, with each rho as probable as another before.

    Args:
        counts: Windows by outcome, (valves, k).
        mean: Adds up to one, (k,).
        by: How much each valve counts, (valves,).
    """
    found = np.array([by @ log_likelihoods(counts, mean * (1 / rho - 1)) for rho in ALIKE])
    weight = np.exp(found - found.max())
    alike = float(weight @ ALIKE / weight.sum())
    return np.asarray(mean * (1 / alike - 1))


def log_likelihoods(counts: FloatArray, alphas: FloatArray) -> FloatArray:
    """Return that of each valve's counts, less a constant of the counts, (valves,)."""
    n = counts.sum(axis=1)
    own = gammaln(alphas.sum()) - gammaln(alphas.sum() + n)
    return np.asarray(own + (gammaln(alphas + counts) - gammaln(alphas)).sum(axis=1))
