"""The log odds that a valve sticks, from how often its windows had which outcome.

What windows of a valve have in common must not add up to certainty: a process that the models lack is there
every day. So there is a random effect a valve, in two parts. Each valve has rates of outcomes of its own,
drawn from a Dirichlet distribution, one for valves that stick and one for sound ones; its windows then follow
the Dirichlet-multinomial (Polya) distribution. A part of the sound valves, ``MIMICS``, has its rates from the
distribution of those that stick, and a part of those that stick, ``HIDDEN``, from that of the sound ones. So
however many windows a valve has, the odds rise by no more than 1 / ``MIMICS`` and fall by no more than
1 / ``HIDDEN``: these caps are measured on simulated valves.

Source: J. E. Mosimann, "On the compound multinomial distribution", Biometrika 49, 1962.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from agent.analysis.memory.outcome import OUTCOMES, logit
from agent.analysis.memory.rates import HIDDEN, MIMICS, SOUND, STICKS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agent.analysis.memory.outcome import Outcome

BASE_RATE = 0.2
"""Part of the valves of a plant that stick, where nobody states another: one in five. Surveys of plants find
20 to 30 % of loops that oscillate for their valves (Bialkowski 1993; Desborough and Miller 2002)."""
Counts = tuple[float, ...]
"""How many windows had each of ``OUTCOMES``; a window may count in part."""


def log_bayes_factor(counts: Counts) -> float:
    """Return the log of how much likelier the windows are if the valve sticks, nats."""
    sticks, sound = _log_likelihood(counts, STICKS), _log_likelihood(counts, SOUND)
    likeliest = max(sticks, sound)
    as_sticking, as_sound = math.exp(sticks - likeliest), math.exp(sound - likeliest)
    if_sticks = (1 - HIDDEN) * as_sticking + HIDDEN * as_sound
    if_sound = MIMICS * as_sticking + (1 - MIMICS) * as_sound
    return math.log(if_sticks / if_sound)


def probability_of(counts: Counts, base_rate: float = BASE_RATE) -> float:
    """Return the probability that the valve sticks."""
    log_odds = logit(base_rate) + log_bayes_factor(counts)
    return 1 / (1 + math.exp(-log_odds))


def _log_likelihood(counts: Counts, alphas: Mapping[Outcome, float]) -> float:
    total, count = sum(alphas.values()), sum(counts)
    found = math.lgamma(total) - math.lgamma(total + count)
    for outcome, n in zip(OUTCOMES, counts, strict=True):
        found += math.lgamma(alphas[outcome] + n) - math.lgamma(alphas[outcome])
    return found
