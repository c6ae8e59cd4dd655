"""How the log odds of windows lie in a valve: prints what `agent/analysis/memory/rates.py` holds.

Two populations that count alike: valves in simulated weeks, half of which move seldom, with the outcomes of
14 windows in a week or 42 in six; and loops of ``evidence_weights``' kinds, which move in each window, one
window each.
The middles of sound valves have the likeliest normal distribution; in valves that stick they are higher, up
to the likeliest most. How far windows scatter about the middle of their valve is alike in both. A sound valve
that looks like one that sticks is one of ``MIMICS``, and a sticking one that looks sound one of ``HIDDEN``,
by its likelihood: neither counts for the middles of its kind (expectation, maximisation). The seeds are used
for nothing else.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from rich.console import Console
from rich.progress import track
from scipy.optimize import minimize
from scipy.special import logsumexp

from agent.analysis.diagnose import diagnose
from agent.analysis.memory.outcome import OUTCOMES, outcome_of, part_of
from agent.analysis.memory.rates import Middles
from agent.analysis.memory.weighing_windows import ORDERED, RATES, log_priors
from agent.analysis.record.recording import FloatArray
from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.options import Options
from benchmarks.cases.random_loop import KINDS, AnyKind, random_loop
from benchmarks.cases.weeks import WeeksJob, diagnosed_valve
from benchmarks.evidence_weights import HARD

if TYPE_CHECKING:
    from numpy.typing import NDArray

IN_A_WEEK = [WeeksJob(seed, 7.0, 28, seed < 92021, one_in=2) for seed in range(92001, 92041)]
IN_SIX_WEEKS = [WeeksJob(seed, 42.0, 42, seed % 3 == 0) for seed in range(92141, 92201)]
"""Valves: their seeds, days, windows, and whether they stick."""
LOOPS, HARD_LOOPS = range(3200, 3214), range(3240, 3265)
"""Seeds of the loops of each kind, and of the kinds that are hard to distinguish."""
SOUND_BEFORE, MIMICS_BEFORE = 70, 2
"""Sound valves of ``benchmarks.one_valve``, half with something that the models lack, and of weeks before,
and those of them whose recordings all look like friction."""
JEFFREYS = 0.5
ROUNDS = 8
"""Of expectation and maximisation."""
PENALTY = 0.05
"""On the squares of the logs of the shares of scatters: one that no valve has keeps a share."""
FIRST = (-2.0, -1.0, 10.0)
"""Mean and log of the standard deviation of sound middles, and the most rise, where the search begins."""


class Outcomes(NamedTuple):
    """Valves with their windows."""

    counts: FloatArray
    """Windows by outcome, (valves, k)."""
    sticks: NDArray[np.bool_]
    """(valves,)"""


class Rates(NamedTuple):
    """What `rates.py` holds."""

    sound: Middles
    most_rise: float
    scatters: FloatArray
    mimics: float
    hidden: float


def run(_options: Options) -> None:
    """Print the table."""
    weeks = [*IN_A_WEEK, *IN_SIX_WEEKS]
    loops = [(kind, seed) for seed in LOOPS for kind in KINDS]
    loops += [(kind, seed) for seed in HARD_LOOPS for kind in HARD]
    console = Console(stderr=True)
    with process_pool() as pool:
        valves = list(track(pool.map(diagnosed_valve, weeks), "valves", len(weeks), console=console))
        single = list(track(pool.map(one_window, loops), "loops", len(loops), console=console))
    found = rates(
        outcomes([(each.counts, each.sticks) for each in valves]),
        outcomes([each for each in single if each is not None]),
    )
    print_rates(found)


def one_window(job: tuple[AnyKind, int]) -> tuple[tuple[float, ...], bool] | None:
    """Return the outcome of a loop's window as counts, and whether its valve sticks; None without a fit."""
    loop = random_loop(*job)
    diagnosis = diagnose(loop.window)
    outcome = outcome_of(diagnosis)
    if outcome is None:
        return None
    part = part_of(diagnosis, outcome)
    return tuple(part * (each == outcome) for each in OUTCOMES), loop.sticks


def outcomes(valves: Sequence[tuple[Sequence[float], bool]]) -> Outcomes:
    """Return the valves that have windows in one of the ordered outcomes."""
    with_windows = [each for each in valves if sum(each[0][:ORDERED]) > 0]
    return Outcomes(
        np.array([counts for counts, _ in with_windows]), np.array([sticks for _, sticks in with_windows])
    )


def print_rates(found: Rates) -> None:
    print(f"SOUND = Middles(mean={found.sound.mean:.2f}, sd={found.sound.sd:.2f})")
    print(f"MOST_RISE = {found.most_rise:.2f}")
    print("SCATTERS:", ", ".join(f"{share:.3f}" for share in found.scatters))
    print(f"MIMICS = {found.mimics:.3f}\nHIDDEN = {found.hidden:.3f}")


def rates(weeks: Outcomes, loops: Outcomes) -> Rates:
    """Return the likeliest rates for valves in weeks and loops with one window, which count alike."""
    share = len(weeks.counts) / len(loops.counts)
    counts = np.concatenate((weeks.counts, loops.counts))[:, :ORDERED]
    sticks = np.concatenate((weeks.sticks, loops.sticks))
    in_weeks = np.arange(len(sticks)) < len(weeks.sticks)
    by = np.where(in_weeks, 1.0, share)
    rows = np.einsum("vk,tsk->vts", counts, RATES)
    as_known, hidden, mimics = np.ones(len(sticks)), JEFFREYS, MIMICS_BEFORE / SOUND_BEFORE
    place = np.concatenate((FIRST, np.zeros(RATES.shape[1] - 1)))
    for _ in range(ROUNDS):
        place = _likeliest(place, rows, sticks, by * as_known)
        both = np.array([_log_likelihoods(rows, prior) for prior in _priors(place)])
        own, other = np.where(sticks, both[0], both[1]), np.where(sticks, both[1], both[0])
        part = np.where(sticks, hidden, mimics)
        as_known = (1 - part) / (1 - part + part * np.exp(np.clip(other - own, -700, 700)))
        strange = (1 - as_known) * in_weeks
        hidden = (JEFFREYS + strange[sticks].sum()) / (2 * JEFFREYS + (sticks & in_weeks).sum())
        mimics = (MIMICS_BEFORE + JEFFREYS + strange[~sticks].sum()) / (
            SOUND_BEFORE + 2 * JEFFREYS + (~sticks & in_weeks).sum()
        )
    return Rates(_sound(place), float(place[2]), _shares(place), float(mimics), float(hidden))


def _likeliest(place: FloatArray, rows: FloatArray, sticks: NDArray[np.bool_], by: FloatArray) -> FloatArray:
    def cost(place: FloatArray) -> float:
        ones, others = (_log_likelihoods(rows, prior) for prior in _priors(place))
        rest = PENALTY * float(place[len(FIRST) :] @ place[len(FIRST) :])
        return rest - float(by @ np.where(sticks, ones, others))

    options = {"maxiter": 3000, "xatol": 1e-3, "fatol": 1e-3}
    return np.asarray(minimize(cost, place, method="Nelder-Mead", options=options).x)


def _log_likelihoods(rows: FloatArray, prior: FloatArray) -> FloatArray:
    return np.asarray(logsumexp(rows + prior, axis=(1, 2)))


def _priors(place: FloatArray) -> FloatArray:
    """Return the log prior of middle and scatter for valves that stick and for sound ones."""
    return log_priors(_sound(place), place[2], _shares(place))


def _sound(place: FloatArray) -> Middles:
    return Middles(place[0], float(np.exp(place[1])))


def _shares(place: FloatArray) -> FloatArray:
    weights = np.exp(np.append(place[len(FIRST) :], 0.0))
    return np.asarray(weights / weights.sum())
