"""Which loop is fitted next: the one whose answer is likeliest to change what a person does, and matters.

Value of information: a person looks at a valve whose probability exceeds a threshold. A window with a fit
moves the probability to one of several values (``weighing_windows``); its worth is by how much the mean loss
of the decision falls. The loss of a valve that sticks and is left alone is 1, that of a look at a sound one
``p / (1 - p)`` at the threshold ``p``, which makes the threshold the best one.

Source: H. Raiffa and R. Schlaifer, *Applied statistical decision theory*, 1961.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from agent.analysis.memory.outcome import OUTCOMES
from agent.analysis.memory.rates import SOUND, STICKS
from agent.analysis.memory.valve_memory import DAY, HALF_LIFE
from agent.analysis.memory.weighing_windows import BASE_RATE, probability_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from agent.analysis.memory.outcome import Outcome
    from agent.analysis.memory.valve_memory import ValveMemory

THRESHOLD = 0.5
"""Probability from which somebody looks at a valve: that of a suspicion."""
IMPORTANCE: Mapping[str, float] = {"low": 0.5, "medium": 1.0, "high": 2.0, "critical": 4.0}
"""Of a loop by the priority of its alarm: each step counts twice as much as the one below."""
PATIENCE = DAY
"""Waiting time after which a loop is worth twice as much, s: so that none waits for ever."""

LEAST = 1e-3
"""Worth of a fit that would change nothing now: what waits long enough has its turn."""


@dataclass(frozen=True, slots=True)
class WaitingFit:
    """A loop whose window waits for its fit."""

    loop: str
    memory: ValveMemory
    priority: str = "medium"
    """Of its alarm."""
    waits: float = 0.0
    """Since its last fit, s."""


def in_order(waiting: Sequence[WaitingFit], now: float, base_rate: float = BASE_RATE) -> tuple[str, ...]:
    """Return the loops, the one to fit first first.

    Args:
        waiting: In any order.
        now: s UTC.
        base_rate: Part of the plant's valves that stick.
    """
    worth = {each.loop: value_of_fit(each, now, base_rate) for each in waiting}
    return tuple(sorted(worth, key=lambda loop: (-worth[loop], loop)))


def value_of_fit(waiting: WaitingFit, now: float, base_rate: float = BASE_RATE) -> float:
    """Return the worth of a fit now: expected fall of the loss, by importance and waiting time."""
    gain = information(_as_of(waiting.memory, now), base_rate)
    return IMPORTANCE.get(waiting.priority, 1.0) * (gain + LEAST) * (1.0 + waiting.waits / PATIENCE)


def information(memory: ValveMemory, base_rate: float = BASE_RATE) -> float:
    """Return by how much one more window with a fit lowers the mean loss of the decision, 0 to 1."""
    now = memory.probability(base_rate)
    after = 0.0
    for k, outcome in enumerate(OUTCOMES):
        counts = tuple(each + (j == k) for j, each in enumerate(memory.counts))
        chance = now * _rate(outcome, memory, STICKS) + (1 - now) * _rate(outcome, memory, SOUND)
        after += chance * _loss(probability_of(counts, base_rate))
    return max(0.0, _loss(now) - after)


def _loss(probability: float) -> float:
    """Return the mean loss of the better of both decisions."""
    return min(probability, (1 - probability) * THRESHOLD / (1 - THRESHOLD))


def _rate(outcome: Outcome, memory: ValveMemory, alphas: Mapping[Outcome, float]) -> float:
    """Return the probability of an outcome of the next window, after those that were seen."""
    seen = memory.counts[OUTCOMES.index(outcome)]
    return (alphas[outcome] + seen) / (sum(alphas.values()) + sum(memory.counts))


def _as_of(memory: ValveMemory, now: float) -> ValveMemory:
    """Return the memory with what is forgotten by now."""
    keep = 0.5 ** (max(now - memory.until, 0.0) / HALF_LIFE) if memory.until else 1.0
    if not math.isfinite(keep):
        return memory
    return replace(memory, former=tuple(keep * each for each in memory.counts), today=(0.0,) * len(OUTCOMES))
