"""What the trend of S of a simulated valve held, and when a repair, or an onset, was noticed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.analysis.wear.trend import trend_of

if TYPE_CHECKING:
    from benchmarks.cases.weeks import DiagnosedValve


def days_held(valve: DiagnosedValve) -> tuple[int, int]:
    """Return on how many days the interval of S, from the days up to it, has the true S, and of how many."""
    days = valve.memories[-1].s_days
    trend = trend_of(days)
    if trend is None:
        return 0, 0
    true = {memory.until: s for memory, s in zip(valve.memories, valve.true_s, strict=True)}
    held = [level.low <= true[level.time] <= level.high for level in trend.levels if level.time in true]
    return sum(held), len(held)


def repair_noticed(valve: DiagnosedValve, repaired: float) -> float | None:
    """Return the days from a repair, at the day ``repaired``, to the window with which the trend has one."""
    for day, memory in zip(valve.days, valve.memories, strict=True):
        trend = trend_of(memory.s_days)
        if day > repaired and trend is not None and trend.repaired is not None:
            return day - repaired
    return None


def found_after(valve: DiagnosedValve, begins: float, shown: float) -> float | None:
    """Return the days from an onset, at the day ``begins``, to the window with which P exceeds ``shown``."""
    for day, memory in zip(valve.days, valve.memories, strict=True):
        if day > begins and memory.probability() > shown:
            return day - begins
    return None
