"""Samples of one loop in, windows on a uniform grid out.

Time is source time throughout; the clock of this machine only says how old the data are.

What is a gap and what is not (``docs/architecture.md`` has the reasons):

* A sample of bad quality is a gap until the next good one.
* A role that is silent while others of its loop are reported has not changed: its last value holds.
* Silence of the whole loop is a gap where PV and OP are always reported together (Modbus, one JSON message).
  Where they are reported when they change (OPC UA), it is one only after ``hold`` seconds.
* What nobody heard because the connection was gone is a gap, however short.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.runtime.intake.cut import CutWindow, DueStretch
from agent.runtime.intake.rows import FINE
from agent.runtime.intake.slots import FOREVER, NEVER, SlotRing, Taken
from agent.runtime.intake.tag_clocks import TagClocks
from connectors.base import Quality, Sample

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray
    from agent.runtime.intake.rows import GridPlaces, ValueRows
    from agent.settings import LoopSettings

LATEST = 150
"""Samples a role may be behind the others before it counts as silent. A bus may send role after role, and an
OPC UA server keeps 100 values a node between two notifications by default."""
CLOCK_SET_BACK = 60
"""Samples in a row from the past after which the source's clock was set back, and time starts anew."""
AT_PACE, FEWEST_AT_PACE = 1.0, 5
"""It was set back as well if samples from the past tick on as the wall does, so long (s) and so many."""
LAST_TIME = 1e11
"""Source times beyond are no times, s UTC: the year 5138."""
MOST_MODES = 10
"""Modes that no table knows of which a loop remembers the words."""
NEARLY = 0.501
"""Sampling times before a point of the grid from which a value belongs to it, and a little for rounding."""
TOLD_TOGETHER = 1.5
"""Samples without any report that make a gap where all roles are reported together."""


@dataclass(slots=True)
class Counters:
    """What came in, since the start."""

    samples: int = 0
    bad: int = 0
    uncertain: int = 0
    duplicates: int = 0
    backward: int = 0
    clock_steps: int = 0
    missing: int = 0
    """Grid points without PV or OP in the newest window."""


class RollingWindow:
    """The newest stretch of one loop, in memory that never grows."""

    def __init__(self, settings: LoopSettings, stagger: float = 0.0) -> None:
        """Make it; its first window comes due ``stagger`` hops later than it could, 0 to 1."""
        self._settings = settings
        self._stagger = stagger
        self._capacity = math.ceil(settings.window.longest / settings.ts) + LATEST + 2
        self.counters = Counters()
        self.period: float | None = None
        """Period of the oscillation, s, where one is known: windows in periods follow it."""
        self.arrival: float | None = None
        """Monotonic time at which the newest sample arrived, s."""
        self.clocks = TagClocks(settings.ts)
        """Whether PV and OP have the same clock."""
        self._duplicates_told = 0
        self._unknown_modes: set[str] = set()
        self._rings: dict[str, SlotRing]
        self._origin: float | None
        """Time of slot 0: that of the first PV, so that the grid has its phase."""
        self._before_pv: dict[str, Sample]
        self._due_at: int | None
        """Last slot of the next window; None before PV and OP are both known."""
        self._backward_run: int
        self._backward_from: tuple[float, float]
        """Source time and arrival of the first of that run, s."""
        self._start_anew()

    @property
    def newest(self) -> float | None:
        """Newest source time of any role, s UTC; None before the first sample."""
        newest = max(ring.time for ring in self._rings.values())
        return newest if math.isfinite(newest) else None

    def push(self, sample: Sample, arrival: float) -> DueStretch | None:
        """Take a sample that arrived at ``arrival`` (monotonic, s); return what is due if anything is now."""
        role = sample.tag.role
        ring = self._rings.get(role)
        if ring is None or not abs(sample.time) <= LAST_TIME:  # nor NaN
            return None
        if sample.quality is Quality.BAD and ring.newest == NEVER:
            # Servers give "no value yet" the time of their own clock, which need not be the plant's.
            self.counters.bad += 1
            return None
        if self._origin is None:
            if role != "pv":
                self._before_pv[role] = sample
                return None
            self._origin = sample.time
            for earlier in self._before_pv.values():
                self.push(earlier, arrival)
        time = sample.time
        if sample.quality is Quality.BAD and time < ring.time and ring.known:
            time = ring.time + self._settings.ts  # by another clock: nothing is known from now on
        taken = ring.put(time, (time - self._origin) / self._settings.ts, self._value(sample))
        if taken is not Taken.NEW:
            return self._dropped(sample, taken, arrival)
        self._backward_run = 0
        self.arrival = arrival
        if sample.quality is not Quality.BAD:
            self.clocks.see(role, time, arrival)
        self.counters.samples += 1
        self.counters.bad += sample.quality is Quality.BAD
        self.counters.uncertain += sample.quality is Quality.UNCERTAIN
        if self._due_at is not None and ring.newest < self._due_at:
            return None  # at most the slot of this role is settled
        return self._due()

    @property
    def due_from(self) -> float:
        """Source time before which no window comes due, s UTC; -inf where any value may make one."""
        if self._due_at is None or self._origin is None:
            return -math.inf
        return self._origin + (self._due_at - NEARLY) * self._settings.ts

    def places_for(self, rows: ValueRows) -> GridPlaces | None:
        """Return where ``take`` puts rows; None where an earlier one makes a window due."""
        if self._origin is None or self._due_at is None or not abs(rows.times.source[-1]) <= LAST_TIME:
            return None
        places = rows.times.places(self._origin, self._settings.ts)
        rings = (self._rings.get(role) for role in rows.roles)
        takes = all(ring is None or ring.can_take(places) for ring in rings)
        return places if takes and (places.last < self._due_at or self._due_with(rows, places)) else None

    def take(self, rows: ValueRows, places: GridPlaces) -> DueStretch | None:
        """Do what ``push`` would do with each value of rows; return what is due if anything is now.

        ``places`` are from ``places_for``.
        """
        for role, values, short in zip(rows.roles, rows.values, rows.short, strict=True):
            ring = self._rings.get(role)
            if ring is None:
                continue
            if role == "mode":
                short[1:] = [self._mode(value) for value in values.tolist()]
            ring.take(places, short)
            self.clocks.take(role, rows.times)
            self.counters.samples += len(values)
        self._backward_run = 0
        self.arrival = float(rows.times.arrivals[-1])
        return None if self._due_at is not None and places.last < self._due_at else self._due()

    def cut(self, due: DueStretch) -> CutWindow | None:
        """Return the window of a stretch that is due, or as long a newer one where the rings have no more.

        None where the source's clock was set back meanwhile: nothing of it is held.
        """
        if self._origin != due.origin:
            return None
        newest = max(ring.newest for ring in self._rings.values())
        first = max(due.first, newest - self._capacity + 1)
        columns = {role: ring.column(first, due.n) for role, ring in self._rings.items()}
        silent = self._silent(first, due.n)
        for column in columns.values():
            column[silent] = np.nan
        self.counters.missing = int(np.sum(np.isnan(columns["pv"]) | np.isnan(columns["op"])))
        duplicates = self.counters.duplicates - self._duplicates_told
        self._duplicates_told = self.counters.duplicates
        settings = self._settings
        start = due.origin + first * settings.ts
        modes, apart = tuple(sorted(self._unknown_modes)), self.clocks.apart
        return CutWindow(settings.name, start, settings.ts, columns, settings.hints, duplicates, apart, modes)

    def interrupt(self) -> None:
        """The connection is gone: from here on nothing is known until it is reported again."""
        after = max(ring.newest for ring in self._rings.values()) + 1
        for ring in self._rings.values():
            ring.interrupt(after)

    def recent(self, since: float = -math.inf) -> tuple[float, dict[str, FloatArray]]:
        """Return what is held after ``since`` (s UTC): start of the grid (s UTC) and each role's (n,) column.

        A value holds until the next one, as in a window; silence is not marked. A column is empty where
        nothing is held.
        """
        ts, origin = self._settings.ts, self._origin or 0.0
        last = max(ring.newest for ring in self._rings.values())
        firsts = [ring.first for ring in self._rings.values() if ring.newest != NEVER]
        if not firsts:
            return origin, {role: np.empty(0) for role in self._rings}
        first = max(min(firsts), last - self._capacity + 1)
        if math.isfinite(since):
            first = max(first, math.floor((since - origin) / ts + 1e-6) + 1)
        n = max(last - first + 1, 0)
        columns = {role: ring.column(first, n).astype(np.float64) for role, ring in self._rings.items()}
        return origin + first * ts, columns

    def _start_anew(self) -> None:
        self._rings = {role: SlotRing(self._capacity) for role in self._settings.roles}
        self._origin = None
        self._before_pv = {}
        self._due_at = None
        self._backward_run = 0

    def _dropped(self, sample: Sample, taken: Taken, arrival: float) -> DueStretch | None:
        if taken is Taken.DUPLICATE:
            self.counters.duplicates += 1
            return None
        self.counters.backward += 1
        if sample.quality is Quality.BAD:
            return None  # it may have another clock than values have
        if self._backward_run == 0:
            self._backward_from = (sample.time, arrival)
        self._backward_run += 1
        if self._backward_run < CLOCK_SET_BACK and not self._ticks(sample, arrival):
            return None
        self.counters.clock_steps += 1
        self._start_anew()
        return self.push(sample, arrival)

    def _ticks(self, sample: Sample, arrival: float) -> bool:
        """Return whether the samples from the past tick on as the wall does: nobody sends history so."""
        ticked, passed = sample.time - self._backward_from[0], arrival - self._backward_from[1]
        enough = self._backward_run >= FEWEST_AT_PACE and passed >= AT_PACE
        return enough and abs(ticked - passed) <= 0.5 * passed

    def _value(self, sample: Sample) -> float:
        if sample.quality is Quality.BAD:
            return math.nan
        if sample.tag.role == "mode":
            return self._mode(sample.value)
        return float(sample.value) if not isinstance(sample.value, str) else math.nan

    def _mode(self, value: float | str) -> float:
        means = self._settings.mode_means(value)
        if means is None and len(self._unknown_modes) < MOST_MODES:
            self._unknown_modes.add(str(value))
        return float(means or False)

    def _due(self) -> DueStretch | None:
        rings = self._rings.values()
        told = [ring.newest for ring in rings if ring.newest != NEVER]
        settled = min(slot for slot in told if slot >= max(told) - LATEST)
        first = max(self._rings["pv"].first, self._rings["op"].first)
        if self._due_at is None and first != FOREVER:
            shortest = self._length(0)
            self._due_at = first + shortest - 1 + int(self._stagger * shortest * self._settings.window.hop)
        if self._due_at is None or settled < self._due_at:
            return None
        end = self._due_at if settled - self._due_at <= LATEST else settled
        n = min(self._length(end - first + 1), end - first + 1)
        self._due_at = end + math.ceil(n * self._settings.window.hop)
        return DueStretch(self._origin or 0.0, end - n + 1, n)

    def _due_with(self, rows: ValueRows, places: GridPlaces) -> bool:
        """Return whether the last row alone can make a window due, and only with its last value."""
        newest = (self._rings[role].newest for role in rows.roles if role in self._rings)
        return places.before_last < (self._due_at or 0) and places.last - min(newest) <= LATEST

    def _length(self, there: int) -> int:
        """Samples that a window should have where ``there`` have come in."""
        window, ts = self._settings.window, self._settings.ts
        wanted = there * ts if self.period is None else window.periods * self.period
        return math.floor(min(max(wanted, window.shortest), window.longest) / ts + 1e-9)

    def _silent(self, first: int, n: int) -> NDArray[np.bool_]:
        """True at the grid points that lie in a silence of the whole loop, shape (n,)."""
        settings = self._settings
        reports = {role: ring.reports() for role, ring in self._rings.items()}
        begin, end = first * FINE, round((first + n - 0.5) * FINE)
        pv, op = (each[(each >= begin) & (each < end)] for each in (reports["pv"], reports["op"]))
        longest = TOLD_TOGETHER if np.array_equal(pv, op) else settings.longest_silence / settings.ts
        told = np.unique(np.concatenate(list(reports.values())))
        slots = np.rint(told / FINE).astype(np.int64) - first
        silent = np.zeros(n, dtype=np.bool_)
        for k in np.flatnonzero(np.diff(told) > longest * FINE):
            silent[max(slots[k] + 1, 0) : max(slots[k + 1], 0)] = True
        return silent
