"""The log odds that a valve sticks, from how often its windows had which outcome.

Outcomes are steps of the log odds of a window, in order. What windows of a valve have in common must not add
up to certainty: a process that the models lack is there every day. So there is a random effect a valve: a
middle of its own about which the log odds of its windows scatter, as far as they do in this valve. A window
lies in each step as often as a normal distribution says (ordered probit), but for ``STRAY``, which may lie
anywhere. In valves that stick the middle is higher than in sound ones by a rise, never lower: so windows that
look sound are never evidence for stiction, however many and however much.

A part of the sound valves, ``MIMICS``, has its middle where those that stick have theirs, and a part of those
that stick, ``HIDDEN``, has no rise. So however many windows a valve has, the odds rise by no more than
1 / ``MIMICS`` and fall by no more than 1 / ``HIDDEN``: these caps are measured on simulated valves. How often
PV did not respond and slipped then (``stuck``) has no place in this order: it counts beside it, with a rate
of its own a valve (Polya).

Source: D. Hedeker and R. D. Gibbons, "A random-effects ordinal regression model for multilevel analysis",
Biometrics 50, 1994; for ``stuck`` J. E. Mosimann, "On the compound multinomial distribution", Biometrika 49,
1962.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import betaln, ndtr

from agent.analysis.memory.outcome import EDGES, OUTCOMES, logit
from agent.analysis.memory.rates import HIDDEN, MIMICS, MOST_RISE, SCATTERS, SOUND, STUCK
from agent.analysis.wear.stretches import JUMPS_A_DAY

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.memory.rates import Middles
    from agent.analysis.record.recording import FloatArray

BASE_RATE = 0.2
"""Part of the valves of a plant that stick, where nobody states another: one in five. Surveys of plants find
20 to 30 % of loops that oscillate for their valves (Bialkowski 1993; Desborough and Miller 2002)."""
Counts = tuple[float, ...]
"""How many windows had each of ``OUTCOMES``; a window may count in part."""
STRAY = 0.02
"""Part of the windows that may have any outcome: else one window excludes a middle that lies far off."""
STEP = 0.25
MIDDLES = np.arange(-6.0, 9.0 + STEP, STEP)
"""Log odds over which the middle of a valve is summed. Beyond, all windows have the first or last outcome, so
what is farther counts at the end."""
TINY = 1e-300
"""Keeps the logarithm of a share that is 0 finite."""
ORDERED = len(OUTCOMES) - 1
"""Outcomes that are steps of the log odds; the last one, ``stuck``, is none."""


def log_rates() -> FloatArray:
    """Return the log of how often windows have each ordered outcome, (middles, scatters, ``ORDERED``)."""
    edges = np.array([-math.inf, *(edge for edge, _ in EDGES), math.inf])
    scatters = np.array(list(SCATTERS))[None, :, None]
    below = ndtr((edges - MIDDLES[:, None, None]) / scatters)
    return np.asarray(np.log((1 - STRAY) * np.diff(below, axis=2) + STRAY / ORDERED))


def log_priors(sound: Middles, most: float, shares: FloatArray) -> FloatArray:
    """Return the log of how probable each middle and scatter is in valves that stick, and in sound ones.

    Args:
        sound: Middles of sound valves.
        most: By how much they are higher at most where the valve sticks; each rise up to it is as probable.
        shares: Of the scatters, (scatters,).

    Returns:
        (2, middles, scatters).
    """
    low = np.exp(-0.5 * ((MIDDLES - sound.mean) / sound.sd) ** 2)
    low /= low.sum()
    rises = np.clip(most / STEP + 0.5 - np.arange(math.ceil(most / STEP) + 1), 0.0, 1.0)
    farther = np.convolve(low, rises / rises.sum())
    high = farther[: len(MIDDLES)]
    high[-1] += farther[len(MIDDLES) :].sum()
    both = np.stack((high, low))
    return np.asarray(np.log(both + TINY)[:, :, None] + np.log(shares))


RATES = log_rates()
PRIORS = log_priors(SOUND, MOST_RISE, np.array(list(SCATTERS.values())))


def log_likelihoods(counts: Counts) -> tuple[float, float]:
    """Return the log likelihood of the windows of a valve that sticks, and of a sound one, nats."""
    stuck, others = counts[-1], sum(counts[:ORDERED])
    found = (RATES @ np.array(counts[:ORDERED]) + PRIORS).reshape(len(PRIORS), -1)
    top = found.max(axis=1)
    yes, no = np.transpose(STUCK)
    logs = top + np.log(np.exp(found - top[:, None]).sum(axis=1))
    as_sticking, as_sound = (logs + betaln(yes + stuck, no + others) - betaln(yes, no)).tolist()
    return _mixed(as_sticking, as_sound, HIDDEN), _mixed(as_sound, as_sticking, MIMICS)


def probability_of(counts: Counts, base_rate: float = BASE_RATE, since: Sequence[Counts] = ()) -> float:
    """Return the probability that the valve sticks.

    A valve may become another: damaged, repaired, or in another service. What was before says nothing then,
    and it sticks as likely as any (product partition, as for S against time: ``wear/stretches.py``).

    Args:
        counts: Of all windows.
        base_rate: Part of the plant's valves that stick.
        since: Of the windows since each day on which it may have become another.
    """
    found = [log_likelihoods(counts)]
    for after in since:
        before = log_likelihoods(tuple(max(a - b, 0.0) for a, b in zip(counts, after, strict=True)))
        became = math.log(JUMPS_A_DAY) + _mixed(before[1], before[0], base_rate)
        if_sticks, if_sound = log_likelihoods(after)
        found.append((became + if_sticks, became + if_sound))
    if_sticks, if_sound = np.logaddexp.reduce(found).tolist()
    return posterior(if_sticks, if_sound, base_rate)


def posterior(if_sticks: float, if_sound: float, base_rate: float) -> float:
    """Return the probability that the valve sticks, from the log likelihoods of its windows."""
    return 1 / (1 + math.exp(if_sound - if_sticks - logit(base_rate)))


def _mixed(own: float, other: float, part: float) -> float:
    """Return the log likelihood where a part of the valves looks like those of the other kind."""
    return float(np.logaddexp(math.log1p(-part) + own, math.log(part) + other))
