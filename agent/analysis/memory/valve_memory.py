"""The memory of one valve: a small value that each window updates.

It holds how often windows had which outcome (``weighing_windows``), what they say of process and noise, and S
day by day. Old windows are forgotten with a half-life, those before a repair at once (``since_repair``).
Windows that overlap count by what is new in them, and the windows of one day as one at most: they share
loads, campaign and weather, and how far is not known.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import TYPE_CHECKING

from agent.analysis.memory.known import ProcessSeen, known_from, process_seen
from agent.analysis.memory.outcome import OUTCOMES, outcome_of, part_of
from agent.analysis.memory.s_day import SDay, falls, known_s_of, s_seen, with_s
from agent.analysis.memory.weighing_windows import BASE_RATE, Counts, probability_of
from agent.analysis.record.known_process import KnownValve
from agent.analysis.response.candidates import UNSURE_GAIN
from agent.analysis.wear.trend import repaired_of

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.memory.outcome import Outcome
    from agent.analysis.record.recording import LoopHints

VERSION = 4
"""Of the state as it is stored."""
DAY = 86400.0
"""s"""
HALF_LIFE = 60 * DAY
"""Time after which a window counts for half, s: valves wear over months."""
PROCESSES = 24
"""Windows whose process is kept, the newest."""
BECAME = 14
"""Days with a window on each of which the valve may have become another, the newest: a change that is older
has more windows since than most memories have before."""
WATCHED = 14
"""Days that are searched for a repair, the newest that showed or divided S; half as many after it, they may
take it back. A search is in the agent's event loop, and its time grows with the square of them: 4 to 9 ms."""
NOTHING: Counts = (0.0,) * len(OUTCOMES)


@dataclass(frozen=True, slots=True)
class ValveMemory:
    """What is remembered of a valve. Empty before its first window."""

    until: float = 0.0
    """End of the newest window, s UTC."""
    former: Counts = NOTHING
    """Windows by outcome, of all days but the newest, as far as they are not forgotten."""
    days: tuple[Counts, ...] = ()
    """Of each of the newest days among them that had a window, the newest last."""
    today: Counts = NOTHING
    """Of the newest day, each window by what was new in it."""
    processes: tuple[ProcessSeen, ...] = ()
    """The newest last."""
    s_days: tuple[SDay, ...] = ()
    """S of each day that showed or divided it, the newest last."""
    before: Counts = NOTHING
    """Windows by outcome before the last repair: they count no more, unless later days take it back."""
    repaired: float | None = None
    """Time of the window with which it was noticed, s UTC; None: there was none."""
    version: int = VERSION

    @property
    def newest(self) -> Counts:
        """Windows by outcome of the newest day, which counts as one window at most."""
        share = 1.0 / max(1.0, sum(self.today))
        return tuple(share * each for each in self.today)

    @property
    def counts(self) -> Counts:
        """Windows by outcome, a day one at most."""
        return _sum(self.former, self.newest)

    @property
    def windows(self) -> float:
        """How many windows count."""
        return sum(self.counts)

    @property
    def since(self) -> tuple[Counts, ...]:
        """Windows by outcome since the begin of each of the newest days, the newest first."""
        return tuple(accumulate((self.newest, *reversed(self.days)), _sum))

    def with_today(self, outcome: Outcome) -> ValveMemory:
        """Return the memory as if one window with this outcome were all of its newest day."""
        return replace(self, today=_added(NOTHING, outcome, 1.0))

    def probability(self, base_rate: float = BASE_RATE) -> float:
        """Return the probability that the valve sticks, where ``base_rate`` of the plant's valves do."""
        return probability_of(self.counts, base_rate, self.since)


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
    today = (
        memory.today if outcome is None else _added(memory.today, outcome, new * part_of(diagnosis, outcome))
    )
    seen, s = process_seen(diagnosis, end), s_seen(diagnosis, end)
    found = replace(
        memory,
        until=end,
        today=today,
        processes=memory.processes if seen is None else (*memory.processes, seen)[-PROCESSES:],
        s_days=memory.s_days if s is None else with_s(memory.s_days, s, new),
    )
    return found if s is None else _since_repair(found, s)


def hints_from(memory: ValveMemory, hints: LoopHints) -> LoopHints:
    """Return the hints of the next window: with process and valve, where the windows so far show them.

    A gain that is as unsure as that of an unknown process is enough beside a known S.
    """
    s, process = known_s_of(memory.s_days), known_from(memory.processes, UNSURE_GAIN)
    valve = KnownValve(s, process) if s is not None and process is not None else None
    return replace(hints, known=known_from(memory.processes), known_valve=valve)


def _on_day_of(memory: ValveMemory, time: float) -> ValveMemory:
    """Return the memory as it is at a time: the former days closed, and partly forgotten."""
    if math.floor(time / DAY) <= math.floor(memory.until / DAY) or not memory.until:
        return memory
    keep = 0.5 ** ((time - memory.until) / HALF_LIFE)
    days = (*memory.days, memory.newest)[-BECAME:] if sum(memory.today) else memory.days
    former, before, *newest = (
        tuple(keep * each for each in some) for some in (memory.counts, memory.before, *days)
    )
    return replace(memory, former=former, days=tuple(newest), before=before, today=NOTHING)


def _since_repair(memory: ValveMemory, seen: SDay) -> ValveMemory:
    """Return the memory after its newest window, which may show a repair, or take one back.

    What a valve showed before a repair says nothing of it now.

    Args:
        memory: With the window.
        seen: What it shows of S.
    """
    days, noticed = memory.s_days[-WATCHED:], memory.repaired
    recent = noticed is not None and sum(each.time > noticed for each in days) <= WATCHED // 2
    if not recent and not falls(days, seen):
        return memory
    repaired = repaired_of(days)
    if repaired is not None and (noticed is None or repaired > noticed):
        return replace(memory, former=NOTHING, days=(), before=memory.former, repaired=memory.until)
    if recent and repaired is None:
        former = _sum(memory.former, memory.before)
        return replace(memory, former=former, before=NOTHING, repaired=None)
    return memory


def _sum(one: Counts, other: Counts) -> Counts:
    return tuple(a + b for a, b in zip(one, other, strict=True))


def _added(counts: Counts, outcome: Outcome, weight: float) -> Counts:
    place = OUTCOMES.index(outcome)
    return tuple(each + weight * (k == place) for k, each in enumerate(counts))
