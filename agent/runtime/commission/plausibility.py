"""Whether the value of a tag can be what the configuration says it is: unit, clock, mode, movement."""

from __future__ import annotations

import math
from dataclasses import dataclass

from agent.durations import duration_words
from agent.settings import LoopSettings
from connectors.base import Quality, Sample

BEYOND = 0.1
"""How far a value may be outside its range, in parts of the span: NAMUR NE 43 lets transmitters go 3 %."""
CLOCK = 5.0
"""s that a source's clock may be ahead of this machine's."""
OLD = 60.0
"""s; older values are reported, and so are values older than ten samples."""
STILL = 3
"""Samples without a change after which PV, which carries noise, is reported as constant."""
SEVERAL, SLOWER = 2, 1.5
"""Distances between values that say how often PV comes, and how many ``ts`` are more than one."""
_RANGES = {"pv": "pv_range", "sp": "pv_range", "op": "op_range"}


@dataclass(frozen=True, slots=True)
class Reading:
    """Samples received of a tag during a check."""

    sample: Sample
    """The newest one."""
    heard: float
    """When it arrived, s UTC."""
    first: Sample
    changed: bool = False
    """Whether any was of another value than the first."""
    later: int = 0
    """How many came whose source time was later than that of the one before."""
    begun: float = math.nan
    """When the first arrived, s UTC, where more have come."""

    @property
    def interval(self) -> float:
        """Mean distance of arrivals, s; NaN where too few say. The first may be kept, and old by its time."""
        return (self.heard - self.begun) / self.later if self.later >= SEVERAL else math.nan

    @property
    def age(self) -> float:
        """How old the newest was when it arrived, s; negative if the source's clock is ahead."""
        return self.heard - self.sample.time

    def followed_by(self, sample: Sample, heard: float) -> Reading:
        """Return the reading after one more sample."""
        changed = self.changed or not _same(sample.value, self.first.value)
        later = self.later + (sample.time > self.sample.time)
        return Reading(sample, heard, self.first, changed, later, self.begun if self.later else self.heard)


def problems(reading: Reading, role: str, loop: LoopSettings, *, any_clock: bool = False) -> tuple[str, ...]:
    """Return the faults to correct before the loop can be watched.

    Args:
        reading: What came.
        role: Of the tag.
        loop: As configured.
        any_clock: Whether the configuration takes times as they are (``clock_error: null``).
    """
    sample = reading.sample
    if sample.quality is Quality.BAD:
        return (sample.why or f"bad quality, code {sample.code:#x}",)
    found = []
    limits = getattr(loop, _RANGES[role]) if role in _RANGES else None
    if limits is not None and isinstance(sample.value, float | int):
        margin = BEYOND * (limits[1] - limits[0])
        if not limits[0] - margin <= sample.value <= limits[1] + margin:
            low, high = limits
            found.append(
                f"outside {_RANGES[role]} {low:g} to {high:g}: are address, type, byte order and unit right?"
            )
    if reading.changed and sample.time == reading.first.time:
        found.append("its value changes but its source time does not: its clock is stale")
    if reading.age < -CLOCK and not any_clock:
        found.append(f"its clock is {duration_words(-reading.age)} ahead of this machine's")
    return tuple(found)


def remarks(reading: Reading, role: str, loop: LoopSettings, watched: float) -> tuple[str, ...]:
    """Return what may be correct but should be looked at; ``watched``: length of the check, s."""
    sample = reading.sample
    if sample.quality is Quality.BAD:
        return ()
    found = []
    if sample.quality is Quality.UNCERTAIN:
        code = f"code {sample.code:#x}" if sample.code else "a kept value"
        found.append(sample.why or f"uncertain quality: {code}")
    if reading.age > max(OLD, 10 * loop.ts):
        why = (
            "its clock is behind, or it comes late"
            if reading.changed
            else "nothing new since, or its clock stands"
        )
        found.append(f"its source time is {duration_words(reading.age)} old: {why}")
    if role == "mode" and not loop.is_automatic(sample.value):
        found.append(_not_automatic(sample.value, loop))
    if role == "pv" and reading.interval > SLOWER * loop.ts:
        often = duration_words(reading.interval)
        found.append(f"a value comes every {often}, but ts is {duration_words(loop.ts)}: set ts to that")
    if role == "pv" and not reading.changed and watched >= STILL * loop.ts:
        found.append(f"constant: did not change in {duration_words(watched)}")
    return tuple(found)


def _not_automatic(mode: float | str, loop: LoopSettings) -> str:
    if loop.mode_means(mode) is False:
        return "not automatic: such stretches are not used"
    return f"not known as automatic or manual, such stretches are not used; add it to modes of {loop.name}"


def _same(one: float | str, other: float | str) -> bool:
    if isinstance(one, str) or isinstance(other, str):
        return one == other
    return one == other or (math.isnan(one) and math.isnan(other))
