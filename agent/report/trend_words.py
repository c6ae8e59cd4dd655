"""The trend of S of a valve, in words and as JSON: all keys always there, null for unknown."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agent.analysis.wear.trend import Reached, Trend

WEEK = 7.0
"""days"""


def trend_lines(loop: str, trend: Trend, reached: Reached | None) -> Iterator[str]:
    """Yield what a person needs to know of the trend."""
    now = trend.levels[-1]
    yield f"{loop}: S = {now.s:.3g} OP units, 90 % interval {now.low:.3g} to {now.high:.3g}"
    slope, low, high = (WEEK * each for each in (trend.slope, trend.slope_low, trend.slope_high))
    yield f"  slope {slope:+.2g} OP units a week, 90 % interval {low:+.2g} to {high:+.2g}"
    for jump in trend.jumps:
        what = "repair" if jump.repair else "jump"
        yield f"  {what} on {day_words(jump.time)}: S from {jump.before:.3g} to {jump.after:.3g}"
    if trend.worse_since is not None:
        yield f"  worse since {day_words(trend.worse_since)}"
    if reached is not None:
        yield f"  {_reached_words(reached)}"


def trend_json(loop: str, trend: Trend, reached: Reached | None) -> dict[str, object]:
    """Return the same as JSON; times are s UTC."""
    return {
        "loop": loop,
        "levels": [
            {"time": each.time, "s": each.s, "low": each.low, "high": each.high} for each in trend.levels
        ],
        "slope": {
            "value": trend.slope,
            "low": trend.slope_low,
            "high": trend.slope_high,
            "unit": "OP units a day",
        },
        "jumps": [
            {"time": each.time, "before": each.before, "after": each.after, "repair": each.repair}
            for each in trend.jumps
        ],
        "repaired": trend.repaired,
        "worse_since": trend.worse_since,
        "limit": None
        if reached is None
        else {"s": reached.limit, "time": reached.time, "low": reached.low, "high": reached.high},
    }


def day_words(time: float) -> str:
    """Return the day of a time (s UTC)."""
    return f"{datetime.fromtimestamp(time, UTC):%Y-%m-%d}"


def _reached_words(reached: Reached) -> str:
    if reached.time is None:
        earliest = "" if reached.low is None else f", at the earliest on {day_words(reached.low)}"
        return f"does not reach {reached.limit:.3g} within ten years{earliest}"
    latest = "never" if reached.high is None else day_words(reached.high)
    low = day_words(reached.time if reached.low is None else reached.low)
    return f"reaches {reached.limit:.3g} on {day_words(reached.time)} (between {low} and {latest})"
