"""Which loop is fitted next: the one whose answer is likeliest to change what a person does, and matters.

Value of information: a person looks at a valve whose probability exceeds a threshold. A window with a fit
moves the probability to one of several values (``weighing_windows``); its worth is by how much the mean loss
of the decision falls. The loss of a valve that sticks and is left alone is 1, that of a look at a sound one
``p / (1 - p)`` at the threshold ``p``, which makes the threshold the best one.

Source: H. Raiffa and R. Schlaifer, *Applied statistical decision theory*, 1961.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

from agent.analysis.memory.outcome import OUTCOMES
from agent.analysis.memory.valve_memory import DAY, HALF_LIFE, ValveMemory
from agent.analysis.memory.weighing_windows import BASE_RATE, log_likelihoods, posterior

if TYPE_CHECKING:
    from collections.abc import Mapping

THRESHOLD = 0.5
"""Probability from which somebody looks at a valve: that of a suspicion."""
IMPORTANCE: Mapping[str, float] = {"low": 0.5, "medium": 1.0, "high": 2.0, "critical": 4.0}
"""Of a loop by the priority of its alarm: each step counts twice as much as the one below."""
PATIENCE = DAY
"""Time since its last fit after which a loop is worth twice as much, s: so that none waits for ever."""
LEAST = 1e-3
"""Worth of a fit that would change nothing now: what waits long enough has its turn."""


def worth_of_fit(
    memory: ValveMemory, priority: str, waits: float, now: float, base_rate: float = BASE_RATE
) -> float:
    """Return the worth of a fit now over that of a valve of medium priority of which nothing is known.

    The expected fall of the loss, by importance and by the time since the last fit.

    Args:
        memory: Of the valve.
        priority: Of its alarm.
        waits: Since its last fit, s.
        now: s UTC.
        base_rate: Part of the plant's valves that stick.
    """
    gain = information(_as_of(memory, now), base_rate) + LEAST
    usual = _of_unknown_valve(base_rate) + LEAST
    return IMPORTANCE.get(priority, 1.0) * gain / usual * (1.0 + waits / PATIENCE)


def information(memory: ValveMemory, base_rate: float = BASE_RATE) -> float:
    """Return by how much one more window with a fit lowers the mean loss of the decision, 0 to 1.

    That the valve may have become another (``probability_of``) is left out: it takes thirty times as long.
    """
    sticks, sound = log_likelihoods(memory.counts)
    now = posterior(sticks, sound, base_rate)
    after = 0.0
    for k in range(len(OUTCOMES)):
        counts = tuple(each + (j == k) for j, each in enumerate(memory.counts))
        if_sticks, if_sound = log_likelihoods(counts)
        chance = now * math.exp(if_sticks - sticks) + (1 - now) * math.exp(if_sound - sound)
        after += chance * _loss(posterior(if_sticks, if_sound, base_rate))
    return max(0.0, _loss(now) - after)


@lru_cache
def _of_unknown_valve(base_rate: float) -> float:
    return information(ValveMemory(), base_rate)


def _loss(probability: float) -> float:
    """Return the mean loss of the better of both decisions."""
    return min(probability, (1 - probability) * THRESHOLD / (1 - THRESHOLD))


def _as_of(memory: ValveMemory, now: float) -> ValveMemory:
    """Return the memory with what is forgotten by now."""
    keep = 0.5 ** (max(now - memory.until, 0.0) / HALF_LIFE) if memory.until else 1.0
    if not math.isfinite(keep):
        return memory
    return replace(memory, former=tuple(keep * each for each in memory.counts), today=(0.0,) * len(OUTCOMES))
