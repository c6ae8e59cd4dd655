"""The process and the noise that make a record most likely where the stem is known."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.innovations.whitened import behind_noise, fitted, likelihood_behind, log_likelihood
from agent.analysis.quantify.free_run.problem import structures
from agent.identify.free_run_error import free_run_errors
from agent.identify.objective import (
    FOPDT,
    INTEGRATOR,
    LOG_TAU,
    LOG_TAU2,
    SOPDT,
)
from agent.identify.search.linear import process_grid

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from agent.analysis.innovations.whitened import Fit
    from agent.analysis.record.recording import FloatArray, LoopHints
    from agent.identify.problem import Problem

SECONDS = {FOPDT: (0.0,), SOPDT: (-0.2, -1.0, -2.5), INTEGRATOR: (0.0,)}
"""Logs of the second time constant over the first that are tried. A second lag that the model without a
valve lacks would be explained by a stem that takes its time."""
EVALUATIONS, MORE = 40, 20
"""Of the simplex behind the first filter, and behind each other, which begins with what was found."""

TURNS = 2
"""Of process and noise at most: each is fitted to the other."""
WORTH = 0.02
"""Nats that a turn must gain."""
AGAIN, NEAR = 60, 0.5
"""Evaluations of its simplex, and their first steps, for it begins near the end."""


def best_process(whitened: Sequence[Problem], hints: LoopHints) -> Fit | None:
    """Return the most likely process behind ``problem.op``, with its noise; None where nothing follows.

    Processes are compared behind each filter as if the innovations were white, the best of each filter by
    their whole likelihood; the likeliest is then fitted to what is new in PV.
    """
    best: dict[int, Fit] = {}
    for structure in structures(hints):
        for second in SECONDS[structure]:
            candidate = _from_grid(structure, second, whitened[len(whitened) // 2])
            evaluations = EVALUATIONS
            for noise, problem in enumerate(whitened):
                candidate[LOG_TAU2] = candidate[LOG_TAU] + second
                fit = fitted(candidate, structure, problem, noise, evaluations)
                evaluations = MORE
                if math.isfinite(fit.score):
                    candidate = fit.candidate.copy()
                    best[noise] = max(fit, best.get(noise, fit), key=lambda one: one.score)
    likeliest = max(
        _behind_either(best.values(), len(whitened) - 1),
        key=lambda fit: log_likelihood(fit, whitened[fit.noise]),
        default=None,
    )
    return None if likeliest is None else refitted(likeliest, whitened[likeliest.noise])


def _behind_either(fits: Iterable[Fit], last: int) -> Iterator[Fit]:
    """Yield each fit behind its own filter and behind the last, which leaves the noise to the autoregression.

    The last is likelier but for a walk in a short record, whose autoregression is not well known.
    """
    for fit in fits:
        yield fit
        if fit.noise != last:
            yield replace(fit, noise=last)


def refitted(fit: Fit, problem: Problem) -> Fit:
    """Return a fit with process and autoregression fitted to each other, as far as that is likelier.

    Args:
        fit: A process whose stem is known.
        problem: The record behind the filter of the fit, with that stem in place of OP.
    """
    behind = behind_noise(fit, problem)
    likelihood = likelihood_behind(fit, problem, behind)
    for _ in range(TURNS):
        if behind is None:
            break
        found = fitted(fit.candidate, fit.structure, behind, fit.noise, AGAIN, NEAR)
        behind = behind_noise(found, problem) if math.isfinite(found.score) else None
        now = likelihood_behind(found, problem, behind)
        if now <= likelihood + WORTH:
            break
        fit, likelihood = found, now
    return fit


def _from_grid(structure: int, second: float, problem: Problem) -> FloatArray:
    """Return the best process of a grid, without a valve, (SIZE,)."""
    grid = process_grid(problem, second)
    return grid[int(np.argmin(free_run_errors(np.array(grid), structure, problem)))]
