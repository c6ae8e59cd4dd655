"""The memory of one valve: a small value that each window updates.

It holds how often windows had which outcome (``weighing_windows``), what they say of process and noise, and S
day by day. Old windows are forgotten with a half-life. Windows that overlap count by what is new in them, and
the windows of one day as one at most: they share loads, campaign and weather, and how far is not known.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from agent.analysis.memory.known import ProcessSeen, known_from, process_seen
from agent.analysis.memory.outcome import OUTCOMES, outcome_of
from agent.analysis.memory.s_day import SDay, known_s_of, s_seen, with_s
from agent.analysis.memory.weighing_windows import BASE_RATE, Counts, probability_of
from agent.analysis.record.known_process import KnownValve
from agent.analysis.response.candidates import UNSURE_GAIN

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.memory.outcome import Outcome
    from agent.analysis.record.recording import LoopHints

VERSION = 3
"""Of the state as it is stored."""
DAY = 86400.0
"""s"""
HALF_LIFE = 60 * DAY
"""Time after which a window counts for half, s: valves wear over months."""
PROCESSES = 24
"""Windows whose process is kept, the newest."""
NOTHING: Counts = (0.0,) * len(OUTCOMES)


@dataclass(frozen=True, slots=True)
class ValveMemory:
    """What is remembered of a valve. Empty before its first window."""

    until: float = 0.0
    """End of the newest window, s UTC."""
    former: Counts = NOTHING
    """Windows by outcome, of all days but the newest, as far as they are not forgotten."""
    today: Counts = NOTHING
    """Of the newest day, each window by what was new in it."""
    processes: tuple[ProcessSeen, ...] = ()
    """The newest last."""
    s_days: tuple[SDay, ...] = ()
    """S of each day that showed or divided it, the newest last."""
    version: int = VERSION

    @property
    def counts(self) -> Counts:
        """Windows by outcome, a day one at most."""
        share = 1.0 / max(1.0, sum(self.today))
        return tuple(old + share * new for old, new in zip(self.former, self.today, strict=True))

    @property
    def windows(self) -> float:
        """How many windows count."""
        return sum(self.counts)

    def probability(self, base_rate: float = BASE_RATE) -> float:
        """Return the probability that the valve sticks, where ``base_rate`` of the plant's valves do."""
        return probability_of(self.counts, base_rate)


def remember(memory: ValveMemory, diagnosis: Diagnosis, start: float, end: float) -> ValveMemory:
    """Return the memory with one more window; as it is where the window holds nothing new.

    Args:
        memory: Of the valve.
        diagnosis: Of the window alone.
        start: Of the window, s UTC.
        end: Its end, s UTC.
    """
    new = min(1.0, (end - max(start, memory.until)) / max(end - start, 1e-9))
    if new <= 0:
        return memory
    memory = _on_day_of(memory, end)
    outcome = outcome_of(diagnosis)
    today = memory.today if outcome is None else _added(memory.today, outcome, new)
    seen, s = process_seen(diagnosis, end), s_seen(diagnosis, end)
    return replace(
        memory,
        until=end,
        today=today,
        processes=memory.processes if seen is None else (*memory.processes, seen)[-PROCESSES:],
        s_days=memory.s_days if s is None else with_s(memory.s_days, s, new),
    )


def hints_from(memory: ValveMemory, hints: LoopHints) -> LoopHints:
    """Return the hints of the next window: with process and valve, where the windows so far show them.

    A gain that is as unsure as that of an unknown process is enough beside a known S.
    """
    s, process = known_s_of(memory.s_days), known_from(memory.processes, UNSURE_GAIN)
    valve = KnownValve(s, process) if s is not None and process is not None else None
    return replace(hints, known=known_from(memory.processes), known_valve=valve)


def _on_day_of(memory: ValveMemory, time: float) -> ValveMemory:
    """Return the memory as it is at a time: the former days closed, and partly forgotten."""
    days = math.floor(time / DAY) - math.floor(memory.until / DAY)
    if days <= 0 or not memory.until:
        return memory
    keep = 0.5 ** ((time - memory.until) / HALF_LIFE)
    return replace(memory, former=tuple(keep * each for each in memory.counts), today=NOTHING)


def _added(counts: Counts, outcome: Outcome, weight: float) -> Counts:
    place = OUTCOMES.index(outcome)
    return tuple(each + weight * (k == place) for k, each in enumerate(counts))
