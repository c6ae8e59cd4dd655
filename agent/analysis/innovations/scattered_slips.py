"""A valve whose friction scatters from slip to slip, on a whitened record.

Slips of a real valve do not all come at one force. A model with one S and J misses their instants, and each
that it misses costs nats: with a scatter of 15 % it loses nine tenths of them. Here the instants follow the
record (``slip_filter``), the process is fitted behind the stem that they give, and so on in turns.
"""

from __future__ import annotations

import math
from itertools import product
from operator import attrgetter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.analysis.innovations.process_search import best_process
from agent.analysis.innovations.slip_filter import HOLDS, Friction, ObservedPv, likeliest_history
from agent.analysis.innovations.stem import StickingStem
from agent.analysis.innovations.whitened import LEAST_SHARE, Fit
from agent.identify.free_run_error import response_to
from agent.identify.noise.student import FREEDOM, student_scale
from agent.identify.objective import (
    Process,
    fit_gain,
    process_of,
)
from agent.identify.residuals import residuals
from agent.identify.search.grid import STEMS
from agent.identify.white_view import behind_autoregression, noise_of
from agent.physics.valves.damped_stem import stem_motion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import FloatArray, LoopHints
    from agent.identify.problem import Problem

SCATTER = 0.25
"""Of friction at first: wide, so that a wrong S finds its slips."""
USUAL, KNOWN_AS = 0.1, 2.0
"""Scatter that is expected, and the number of slips that this is worth beside those of the record."""
S_SHARES = (0.7, 1.0, 1.4)
"""Of the S that is known, at first."""
J_RATIOS = (0.0, 0.4, 0.9)
"""J/S that are tried beside that of the valve that is known."""
SLIDES = 0.1
"""J/S below which a stem that has broken away slides until OP turns; above, it rests after each slip."""
RESTS = 15
"""Positions of the stem before the record."""
ROUNDS = 4
"""Of stem and process at most: each is fitted to the other."""
WORTH = 1.0
"""Nats that a round must gain for another."""
NUMBERS = 1
"""That are fitted in addition, the scatter; each costs half the logarithm of the samples (Schwarz)."""


class ScatteredSlips(NamedTuple):
    """A stem whose friction scatters."""

    stem: StickingStem
    """With the medians of S and J."""
    scatter: float
    """Standard deviation of the logarithm of S from slip to slip."""


class _Moves(NamedTuple):
    """How a stem may have moved."""

    likelihood: float
    """Log likelihood of PV over all stems with this friction, nats, less a constant."""
    friction: Friction
    position: FloatArray
    """OP units, (n,)."""
    factors: FloatArray
    """Of the friction, over its median, of each slip."""


def with_scattered_slips(
    begin: StickingStem, whitened: Sequence[Problem], hints: LoopHints
) -> ScatteredSlips | None:
    """Return the valve with scattered slips that makes a record most likely; None where none slips.

    Args:
        begin: A stem whose friction does not scatter, S > 0.
        whitened: The record behind each filter. Without blocks of one sample the answer is None: the instants
            of slips count.
        hints: Prior knowledge about the loop.
    """
    if whitened[0].block > 1:
        return None
    price = NUMBERS / 2 * math.log(float(whitened[0].weight.sum()))
    s, j = begin.bands
    j_ratio, scatter = min(max(j / s, 0.0), 1.0), SCATTER
    sizes: Sequence[float] = S_SHARES
    stem, best = begin, None
    for _ in range(ROUNDS):
        observed = _seen(stem, whitened[0].op)
        if observed is None:
            break
        seen, process, white = observed
        tried = product(sizes, sorted({j_ratio, *J_RATIOS}))
        found = (_moves(seen, process, share * s, ratio, scatter) for share, ratio in tried)
        moves = max(found, key=attrgetter("likelihood"))
        behind = [each._replace(op=moves.position) for each in whitened]
        fit = best_process(behind, hints)
        if fit is None or not moves.factors.size:
            break
        # All stems together are less likely than the one that is chosen: so much its freedom costs.
        freedom = moves.likelihood - _log_likelihood(moves.position, stem.fit, seen, white)
        s, j_ratio, scatter = _refined(moves)
        stem = StickingStem(fit, behind, (s, j_ratio * s), freedom - price)
        if best is not None and stem.likelihood < best.stem.likelihood + WORTH:
            break
        best, sizes = ScatteredSlips(stem, scatter), (1.0,)
    return best


def _seen(stem: StickingStem, op: FloatArray) -> tuple[ObservedPv, Process, Problem] | None:
    """Return what stems of OP (n,) are weighed by: innovations and process of a fit behind another stem.

    And the record behind the autoregression that they are of.
    """
    candidate, structure = stem.fit.candidate, stem.fit.structure
    filtered = stem.behind[stem.fit.noise]
    noise = noise_of(candidate, structure, filtered, longest=False)
    if noise is None:
        return None
    behind = behind_autoregression(filtered, noise)
    response = response_to(behind.op, candidate, structure, behind)
    _, gain, _ = fit_gain(response, candidate, structure, behind)
    left = residuals(candidate, structure, behind)
    known = behind.weight > 0
    least = LEAST_SHARE * float(behind.pv @ behind.pv) / max(int(known.sum()), 1)
    squares = FREEDOM * student_scale(left[known], least)
    process = process_of(candidate, structure, behind.block, behind.keep, len(left))
    target = left + gain * response
    lags = noise.coefficients
    seen = ObservedPv(op[: len(left)], target, behind.weight, squares, (FREEDOM + 1) / 2, gain, lags)
    return seen, process, behind


def _moves(seen: ObservedPv, process: Process, s: float, j_ratio: float, scatter: float) -> _Moves:
    """Return a stem with this friction that the record makes probable."""
    friction = Friction(s * (1 + j_ratio) / 2, s * (1 - j_ratio) / 2, scatter)
    damping, supply, rest = STEMS[0]
    motion = stem_motion(damping, supply, 0.0 if j_ratio < SLIDES else rest)
    rests = seen.op[0] + HOLDS * friction.f_s * np.linspace(-1, 1, RESTS)
    position, factors, likelihood = likeliest_history(seen, process, friction, motion, rests)
    return _Moves(likelihood, friction, position, factors[factors > 0])


def _log_likelihood(position: FloatArray, fit: Fit, seen: ObservedPv, white: Problem) -> float:
    """Return that of PV behind one stem (n,), as the filter counts it, nats."""
    new = response_to(position, fit.candidate, fit.structure, white)
    left = (seen.target - seen.gain * new)[seen.weight > 0]
    return -seen.power * float(np.sum(np.log1p(left * left / seen.squares)))


def _refined(moves: _Moves) -> tuple[float, float, float]:
    """Return S (OP units), J/S and scatter that the slips of a stem show."""
    logs = np.log(moves.factors)
    apart = float(np.sum((logs - logs.mean()) ** 2))
    f_s, f_d = moves.friction.f_s, moves.friction.f_d
    s = (f_s + f_d) * math.exp(float(logs.mean()))
    return s, (f_s - f_d) / (f_s + f_d), math.sqrt((apart + KNOWN_AS * USUAL**2) / (logs.size + KNOWN_AS))
