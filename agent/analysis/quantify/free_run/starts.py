"""Where a search starts: valves of a coarse grid after a short climb, and the best of each bin of S and J.

Of one family of processes at a time, or of all at once: a second pole smears what a valve does, so that a
wrong valve with two poles may come before the right one with one, and would crowd it out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.climb import climb
from agent.analysis.quantify.free_run.coarse_grid import (
    S_BINS,
    Family,
    Grid,
    coarse_candidates,
    log_tau2,
    processes,
)
from agent.identify.bank import bank
from agent.identify.fitted import Fitted, by_error
from agent.identify.objective import (
    DELAY,
    FOPDT,
    INTEGRATOR,
    J_RATIO,
    LEAST_LOG_TAU,
    LOG_REST,
    LOG_TAU,
    LOG_TAU2,
    RIGID,
    SOPDT,
    S,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import FloatArray
    from agent.identify.problem import Problem

STEMS = np.array([(0.01, 0.01, 1e-8), (0.15, 0.1, 0.003), (0.3, 0.15, 0.01)])
"""Damping, supply and rest that a search starts from: He's valve, which stays as it is, and two that take
their time."""
OTHER_STEMS = np.array([(0.07, 0.2, 0.003), (0.6, 0.2, 0.01), (0.3, 0.3, 0.003)])
"""Lightly and heavily damped, and one that is late, for where those have not led to the valve."""
TAUS = 12
RATIOS = np.array([0.0, 0.15, 0.3, 0.5, 0.75, 1.0])
"""Second time constants of the bank, over the first."""
PERIODS = 15.0
"""Periods that the bank looks at."""
CLIMB = 6
FAST = -1.0
"""Log of a second time constant (samples) that changes little, for a search to start from."""
SLIPS_DIFFER = 0.45
"""J/S below which a valve mostly slides, above which it mostly jumps."""


def climbed(
    problem: Problem, family: Family, grid: Grid, rng: np.random.Generator, stems: FloatArray = STEMS
) -> list[Fitted]:
    """Return the candidates of a grid after a short climb in the bank, with processes.

    Their errors are less the shares of PV that they explain there.

    Where the family leaves it open a second pole is in the search: without one where it is needed no
    candidate reaches the basin.
    """
    candidates, shares = coarse_candidates(problem, stems, family, grid)
    allowed = family.of(RATIOS)
    taus, ratios = processes(problem, TAUS, allowed, integrates=family.integrates)
    near = bank(problem, taus, ratios, PERIODS)
    log_taus = np.minimum(np.log(np.minimum(taus, 1e9)), problem.max_log_tau)
    log_taus2 = np.array([log_tau2(a, r, problem) for a, r in zip(log_taus, ratios, strict=True)])
    shape = (len(taus) // len(allowed), len(allowed))
    climbs = []
    for i in np.argsort(-shares):
        apart = np.abs(log_taus - candidates[i, LOG_TAU])
        apart += 0.5 * np.abs(np.maximum(log_taus2, -1) - max(candidates[i, LOG_TAU2], -1))
        candidate, share, place = climb(
            candidates[i], near, shape, int(np.argmin(apart)), problem.op_span, 1.0, CLIMB, rng
        )
        candidate[LOG_TAU] = log_taus[place]
        candidate[LOG_TAU2] = max(min(max(log_taus2[place], FAST), log_taus[place]), LEAST_LOG_TAU)
        candidate[DELAY] = problem.fixed_delay or min(max(candidate[DELAY], 1.0), problem.max_delay)
        integrates = bool(np.isinf(taus[place])) and ratios[place] == 0
        structure = INTEGRATOR if integrates else FOPDT if family.second is False else SOPDT
        climbs.append(Fitted(-float(share), structure, candidate))
    return climbs


def best_by_bin(fits: Sequence[Fitted], problem: Problem, top: int = 1) -> list[Fitted]:
    """Return the ``top`` best of each bin of S, each half of J/S and each kind of stem, best first."""
    bins: dict[tuple[int, bool, float], list[Fitted]] = {}
    for fitted in by_error(fits):
        x = fitted.candidate
        key = (int(x[S] / problem.op_span * S_BINS), bool(x[J_RATIO] > SLIPS_DIFFER), min(x[LOG_REST], RIGID))
        if len(bins.setdefault(key, [])) < top:
            bins[key].append(fitted)
    return by_error([fitted for one_bin in bins.values() for fitted in one_bin])
